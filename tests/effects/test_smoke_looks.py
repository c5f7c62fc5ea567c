"""The layer of smoke of a realistic fire dims the scene behind it, over labels that stay those of the scene."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.hazards.presets import fire
from tests.worlds.looking import INSIDE, Place


@pytest.mark.render
@pytest.mark.parametrize("mode", ["full", "fast"])
def test_smoke_dims_by_its_density_and_only_from_inside(mode: str) -> None:
    place = Place(fire("realistic"), INSIDE, mode)  # eyes are at 1.4 m
    seen = []
    for height, density in ((2.6, 0.0), (2.0, 3.0), (1.0, 1.0), (1.0, 3.0)):
        place.state.smoke_height[:], place.state.smoke_density[:] = height, density
        seen.append(place.picture(10))
    clear, above, thin, thick = (s["rgb"].astype(float) for s in seen)
    np.testing.assert_array_equal(above, clear)
    solid = seen[0]["segmentation"][..., 0] > 0
    assert thick[solid].mean() < thin[solid].mean() - 5 < clear[solid].mean() - 10
    for name in {"segmentation", "depth", "position", "normal"} & set(seen[0]):
        np.testing.assert_array_equal(seen[3][name], seen[0][name], err_msg=name)
