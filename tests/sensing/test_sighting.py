"""The memory of one thing: which of two views counts, and how much of the past is kept."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.sensing.sighting import REMEMBERED, Sighting, merged, sightings
from hazard_ms.sensing.view import View


def seen(x: float, pixels: int, frame: int, level: float = 20.0) -> Sighting:
    place = np.array([x, 0.0, 0.5], np.float32)
    return Sighting(place, 0.2, 0.6, frame, pixels, (level,), history=((frame, (level,)),))


def test_a_glimpse_does_not_replace_a_good_view_but_its_frame_and_levels_count() -> None:
    after = merged(seen(1.0, 1000, 1), seen(1.15, 10, 2, level=90.0))
    assert float(after.position[0]) == pytest.approx(1.0) and after.pixels == 1000
    assert after.frame == 2 and after.levels == (90.0,)


def test_a_view_that_is_about_as_good_replaces_an_older_one() -> None:
    after = merged(seen(1.0, 1000, 1), seen(1.15, 600, 2))
    assert float(after.position[0]) == pytest.approx(1.15) and after.pixels == 600


def test_what_has_moved_is_where_it_was_seen_last_however_badly() -> None:
    after = merged(seen(1.0, 1000, 1), seen(1.5, 10, 2))
    assert float(after.position[0]) == pytest.approx(1.5) and after.pixels == 10


def test_the_newest_levels_are_kept_and_no_more_than_a_fixed_number() -> None:
    memory = None
    for frame in range(2 * REMEMBERED):
        memory = merged(memory, seen(1.0, 100, frame, level=float(frame)))
    assert memory is not None and len(memory.history) == REMEMBERED
    assert memory.history[-1] == (2 * REMEMBERED - 1, (2.0 * REMEMBERED - 1,))
    assert [frame for frame, _ in memory.history] == list(range(REMEMBERED, 2 * REMEMBERED))


@pytest.mark.parametrize(
    ("ahead", "right", "up"), [(1.0, 0.0, 0.0), (3.0, 0.0, -0.5), (1.5, 2.0, 0.0), (2.0, -2.5, 1.5)]
)
def test_the_size_of_a_thing_is_that_of_its_picture_at_one_metre_wherever_it_is_seen(
    ahead: float, right: float, up: float
) -> None:
    """A ball of 4 cm through a camera with a focal length of 1,000 pixels: 1,000^2 pi 0.04^2 pixels at 1 m, ahead.

    Its picture is drawn here ray by ray. From 1 m a ball looks larger than its middle plane, by 0.04^2.
    """
    focal, radius = 1000.0, 0.04
    row, column = np.mgrid[0:2401:1, 0:3001:1]
    rays = np.stack([(column + 0.5 - 1500.5) / focal, -(row + 0.5 - 1200.5) / focal, -np.ones(row.shape)], -1)
    ball = np.array([right, up, -ahead])
    along = rays @ ball / (rays**2).sum(-1)
    depth = np.where(np.linalg.norm(rays * along[..., None] - ball, axis=-1) < radius, along, 0.0).astype(np.float32)
    turn = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])  # the camera looks along +y of the world
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn.T, (4.0, -2.0, 1.1)
    intrinsic = np.array([[focal, 0.0, 1500.5], [0.0, focal, 1200.5], [0.0, 0.0, 1.0]])
    labels = np.where(depth > 0.0, 0, -1)
    view = View(depth, intrinsic.astype(np.float32), pose.astype(np.float32), labels)
    found = sightings(view, 0, 1, frozenset(), None)[0]
    assert found.size == pytest.approx(focal**2 * np.pi * radius**2, rel=0.02)
