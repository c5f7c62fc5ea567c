"""Floor far from the camera, where neighbouring pixels see points that lie farther apart than the map's cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.far_floor import FLOOR, WIDEST_GAP, floor_between
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.view import View
from tests.worlds.rays import Block, cast, intrinsic, looking

STREET = (24.0, 10.0, 8.0)
EYE = (2.0, 5.0, 1.1)
LOW = Block((9.0, 4.0, 0.0), (9.5, 6.0, 0.4), 0)


def view(*blocks: Block) -> View:
    """Along +x, a little downwards."""
    pose = looking(EYE, (3.0, 5.0, 0.9))
    depth, labels = cast(pose, 512, blocks, STREET)
    return View(depth, intrinsic(512), pose, labels)


def explored(*blocks: Block) -> tuple[NDArray[np.bool_], NDArray[np.float64], NDArray[np.float64]]:
    """Whether each cell was explored in one look, and x and y of the cells [m]."""
    seen = SemanticMap(EYE[:2], np.zeros(1, bool))
    seen.update(view(*blocks), 0, EYE[:2])
    y, x = np.mgrid[0:256, 0:256]
    return seen.explored, seen.origin[0] + (x + 0.5) * 0.1, seen.origin[1] + (y + 0.5) * 0.1


def test_no_stripes_of_unseen_floor_stay_between_seen_ones() -> None:
    """Within 20 degrees of the middle of the view, from 2 m on to where rows of pixels are 0.4 m apart."""
    seen, x, y = explored()
    away = np.hypot(x - EYE[0], y - EYE[1])
    wedge = (np.abs(np.arctan2(y - EYE[1], x - EYE[0])) < np.deg2rad(20)) & (away > 2.0) & (away < 8.0)
    assert wedge.sum() > 1500
    assert seen[wedge].all()


def test_where_pixels_are_far_apart_what_lies_between_them_is_not_taken_for_seen() -> None:
    """From 10.6 m on, rows of pixels are 0.7 m apart, more than a thing on the floor may be long."""
    seen, x, y = explored()
    away = np.hypot(x - EYE[0], y - EYE[1])
    wedge = (np.abs(np.arctan2(y - EYE[1], x - EYE[0])) < np.deg2rad(20)) & (away > 10.6) & (away < 12.5)
    assert wedge.sum() > 500
    assert seen[wedge].mean() < 0.2


def test_floor_behind_a_thing_stays_unseen() -> None:
    """A box 0.4 m high, 7 m ahead, hides the floor for 7.5 * 0.4 / (1.1 - 0.4) m = 4.3 m behind it."""
    seen, x, y = explored(LOW)
    hidden = (np.abs(y - 5.0) < 0.8) & (x > 9.7) & (x < 13.5)
    assert hidden.sum() > 500
    assert not seen[hidden].any()


def test_points_are_as_near_to_each_other_as_cells_and_on_the_floor() -> None:
    """The floor's points are also those of no thing: none is on the box, and none in its shadow."""
    made = floor_between(view(LOW), 4, 0.1)
    assert not ((made > (9.05, 4.05)) & (made < (9.45, 5.95))).all(1).any()
    ahead = np.sort(made[(np.abs(made[:, 1] - 2.0) < 0.1) & (made[:, 0] > 7.0) & (made[:, 0] < 9.0)][:, 0])
    assert len(ahead) and np.diff(ahead).max() <= 0.1
    assert FLOOR < 0.4 and WIDEST_GAP > 0.1
