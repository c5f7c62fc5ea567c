"""Where the camera of the third person stands that follows the robot."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.simulation.drawing.viewpoint import ABOVE, BEHIND, corner_view, following_view
from tests.sketch.test_ways import divided


@pytest.mark.parametrize("place", [(1.0, 2.0), (-3.0, 7.5)])
def test_a_camera_follows_the_robot_from_the_side_that_overlooks_the_scene(place: tuple[float, float]) -> None:
    whole = corner_view(divided(doorway=True))
    pose = following_view(whole, place).to_transformation_matrix()
    overlooks = whole.to_transformation_matrix()[:2, 0]
    eye, axis, up = pose[:3, 3], pose[:3, 0], pose[:3, 2]
    away = np.asarray(place) - eye[:2]
    assert np.hypot(*away) == pytest.approx(BEHIND) and eye[2] == pytest.approx(ABOVE)
    assert away / BEHIND == pytest.approx(overlooks / np.hypot(*overlooks), abs=1e-5)
    hits = eye + axis * (0.6 - eye[2]) / axis[2]  # where the middle of the picture is
    assert hits == pytest.approx([*place, 0.6], abs=1e-4)
    assert up[2] > 0.5
