"""The semantic map against rooms whose geometry is known: rays are cast by tests/worlds/rays.py, not by a renderer."""

from __future__ import annotations

import time
from functools import lru_cache

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from hazard_ms.sensing.camera import AGENT
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.view import View
from tests.worlds.rays import Block, cast, intrinsic, looking

ROOM = (6.0, 5.0, 2.6)
EYE = (1.0, 1.5, 1.1)
TABLE = Block((3.0, 1.0, 0.0), (4.0, 3.0, 0.75), 0)
BOTTLE = Block((3.05, 2.0, 0.75), (3.15, 2.1, 1.0), 1)
BALL = Block((2.0, 0.5, 0.0), (2.1, 0.6, 0.1), 2)
LOOSE = np.array([False, True, True])


@lru_cache
def picture(
    blocks: tuple[Block, ...], turn: float
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.int64]]:
    pose = looking(EYE, (EYE[0] + np.cos(turn), EYE[1] + np.sin(turn), 0.8))
    return pose, *cast(pose, 256, blocks, ROOM)


def view(blocks: tuple[Block, ...], turn: float = 0.0, level: NDArray[np.float32] | None = None) -> View:
    """From `EYE`, a little downwards, `turn` anticlockwise from +x [rad]."""
    pose, depth, labels = picture(blocks, turn)
    return View(depth, intrinsic(256), pose, labels, level)


def fresh(hazards: int = 1) -> SemanticMap:
    return SemanticMap(EYE[:2], LOOSE, hazards=hazards)


def around(seen: SemanticMap, blocks: tuple[Block, ...], first_frame: int = 0) -> None:
    for k in range(12):
        seen.update(view(blocks, k * np.pi / 6), first_frame + k, EYE[:2])


def test_heights_are_those_of_the_room() -> None:
    """Floor 0, table 0.75 m, walls up to the cut at 2.5 m; nothing beyond the walls."""
    seen = fresh()
    around(seen, (TABLE, BOTTLE, BALL))
    y, x = np.nonzero(seen.explored)
    places = seen.origin + seen.cell * (np.stack([x, y], -1) + 0.5)
    assert (places > -0.1).all() and (places < np.array(ROOM[:2]) + 0.1).all()
    inner = (places > 0.15).all(1) & (places < np.array(ROOM[:2]) - 0.15).all(1)
    on_table = (places > np.array(TABLE.low[:2]) + 0.1).all(1) & (places < np.array(TABLE.high[:2]) - 0.1).all(1)
    near_bottle = np.abs(places - (3.1, 2.05)).max(1) < 0.15
    near_ball = np.abs(places - (2.05, 0.55)).max(1) < 0.15
    off_table = (places < np.array(TABLE.low[:2]) - 0.1).any(1) | (places > np.array(TABLE.high[:2]) + 0.1).any(1)
    height = seen.height[y, x]
    assert on_table.sum() > 50
    assert height[on_table & ~near_bottle] == pytest.approx(0.75, abs=0.01)
    assert np.abs(height[inner & off_table & ~near_ball]).max() < 0.01
    assert 2.3 < height[~inner].max() < 2.5


def test_floor_near_the_agent_is_explored_without_gaps() -> None:
    seen = fresh()
    around(seen, ())
    y, x = np.mgrid[0:256, 0:256]
    far = np.hypot(seen.origin[0] + (x + 0.5) * 0.1 - 3.0, seen.origin[1] + (y + 0.5) * 0.1 - 2.0)
    assert seen.explored[far < 0.8].all()


def test_objects_are_where_they_are() -> None:
    seen = fresh()
    around(seen, (TABLE, BOTTLE, BALL))
    bottle, ball = seen.objects[1], seen.objects[2]
    assert bottle.position == pytest.approx([3.1, 2.05, 0.875], abs=0.1)
    assert bottle.top == pytest.approx(1.0, abs=0.02)
    assert ball.position == pytest.approx([2.05, 0.55, 0.05], abs=0.07)
    assert ball.radius < 0.12
    y, x = seen.cell_of(bottle.position)
    assert seen.object_id[y, x] == 1
    assert seen.object_id[seen.cell_of((3.55, 2.55))] == 0
    assert seen.centre_of(*seen.cell_of((3.55, 2.55))) == pytest.approx((3.55, 2.55))


def test_what_moved_leaves_no_trace() -> None:
    """A ball rolls from one place to another: the old place is floor again, and the object is at the new one."""
    seen = fresh()
    around(seen, (BALL,))
    old = seen.cell_of((2.05, 0.55))
    assert seen.object_id[old] == 2 and seen.height[old] > 0.05
    around(seen, (Block((2.0, 3.0, 0.0), (2.1, 3.1, 0.1), 2),), 100)
    assert seen.object_id[old] == -1 and seen.height[old] == pytest.approx(0.0, abs=0.01)
    assert seen.objects[2].position[:2] == pytest.approx([2.05, 3.05], abs=0.07)


def test_furniture_that_floated_off_leaves_no_trace() -> None:
    """It stands at first; then it is loose, and the old place is free once it is seen elsewhere."""
    loose = LOOSE.copy()
    seen = SemanticMap(EYE[:2], loose)
    around(seen, (TABLE,))
    old, new = (3.5, 2.0), (3.5, 4.0)
    assert seen.height[seen.cell_of(old)] > 0.7 and seen.height[seen.cell_of(new)] < 0.1
    loose[0] = True
    around(seen, (Block((3.0, 3.3, 0.0), (4.0, 4.7, 0.75), 0),), 60)
    assert seen.height[seen.cell_of(old)] < 0.1 and seen.height[seen.cell_of(new)] > 0.7


def test_furniture_seen_from_elsewhere_keeps_its_height() -> None:
    """Only what can be moved is wiped: floor seen below a table's edge does not erase the table."""
    seen = fresh()
    around(seen, (TABLE,))
    around(seen, (Block((9.0, 9.0, 0.0), (9.1, 9.1, 0.1), 0),), 100)
    assert seen.height[seen.cell_of((3.5, 2.0))] == pytest.approx(0.75, abs=0.01)


def test_forgotten_and_ignored_things_are_gone() -> None:
    seen = fresh()
    around(seen, (BALL,))
    seen.forget(2)
    assert 2 not in seen.objects and not (seen.object_id == 2).any()
    seen.update(view((BALL,), -0.5), 50, EYE[:2], ignore={2})
    assert 2 not in seen.objects and not (seen.object_id == 2).any()
    seen.update(view((BALL,), -0.5), 51, EYE[:2])
    assert 2 in seen.objects


def test_the_robot_does_not_map_itself() -> None:
    arm = Block((1.3, 1.3, 0.5), (1.5, 1.7, 0.9), AGENT)
    seen = fresh()
    seen.update(view((arm,)), 0, EYE[:2])
    assert seen.height[seen.cell_of((1.4, 1.5))] < 0.1
    unlabelled = view((arm,))
    seen.update(View(unlabelled.depth, unlabelled.intrinsic, unlabelled.cam2world), 1, EYE[:2])
    assert seen.height[seen.cell_of((1.35, 1.5))] < 0.1 and not seen.objects


def test_mark_free_clears_the_footprint_and_nothing_else() -> None:
    seen = fresh()
    around(seen, (TABLE,))
    before = seen.height.copy()
    y, x = seen.cell_of((3.25, 2.0))
    assert before[y, x] > 0.7
    seen.mark_free(seen.centre_of(y, x), 0.12)
    footprint = np.zeros_like(seen.explored)
    footprint[y - 1 : y + 2, x] = footprint[y, x - 1 : x + 2] = True
    assert not seen.height[footprint].any() and (seen.height[~footprint] == before[~footprint]).all()
    assert seen.object_id[y, x] == -1 and seen.explored[footprint].all()


def test_hazard_levels_go_to_cells_and_objects() -> None:
    """Of the first hazard, the left half of the image is at 20, the right at 220; of the second it is 1 everywhere.

    So are the floor on either side, and the thing on the right.
    """
    level = np.full((2, 16, 16), 20.0, np.float32)
    level[0, :, 8:], level[1] = 220.0, 1.0
    ball = Block((2.5, 0.7, 0.0), (2.7, 0.9, 0.2), 2)
    seen = fresh(hazards=2)
    seen.update(view((ball,), 0.0, level), 5, EYE[:2], damaged=np.array([False, False, True]))
    level[0] += 10.0
    seen.update(view((ball,), 0.0, level), 9, EYE[:2])
    left, right, behind = (seen.cell_of(place) for place in ((2.05, 2.55), (2.05, 0.65), (0.3, 1.5)))
    assert seen.levels[(0, *left)] == pytest.approx(30.0) and seen.levels[(0, *right)] == pytest.approx(230.0)
    assert seen.levels[(1, *left)] == seen.levels[(1, *right)] == pytest.approx(1.0)
    assert np.isnan(seen.levels[:, behind[0], behind[1]]).all() and (seen.hazard[left] == seen.levels[0][left])
    assert seen.told_at[left] == seen.told_at[right] == 9 and seen.told_at[behind] == -1
    sighting = seen.objects[2]
    assert sighting.levels == (pytest.approx(230.0), pytest.approx(1.0)) and sighting.hazard == sighting.levels[0]
    first, second = sighting.history
    assert first == (5, (pytest.approx(220.0), pytest.approx(1.0))) and second == (9, sighting.levels)
    assert not sighting.damaged and sighting.frame == 9 and seen.in_view == (2,)


def test_a_thing_without_a_hazard_image_has_no_level() -> None:
    seen = fresh()
    seen.update(view((BALL,), -0.7), 0, EYE[:2])
    assert seen.objects[2].levels == () and np.isnan(seen.objects[2].hazard)


def test_damage_is_known_only_of_what_is_in_view() -> None:
    seen = fresh()
    all_damaged = np.array([True, True, True])
    seen.update(view((BALL,), -0.7), 0, EYE[:2], damaged=all_damaged)
    assert seen.seen_damaged == {2}


def test_view_of_batched_tensors_is_that_of_the_environment() -> None:
    made = view((BALL,), -0.5, np.arange(512, dtype=np.float32).reshape(2, 16, 16))
    millimetres = torch.tensor(np.stack([made.depth * 0, made.depth]) * 1000).to(torch.int16)[..., None]
    both = [torch.tensor(np.stack([part, part])) for part in (made.intrinsic, made.cam2world, made.labels, made.level)]
    taken = View.of(millimetres, *both, env=1)
    assert np.abs(taken.depth - made.depth).max() < 2e-3
    assert (taken.labels == made.labels).all() and (taken.level == made.level).all()


def test_bad_maps_and_orders_are_refused() -> None:
    with pytest.raises(ValueError, match="0.0 m"):
        SemanticMap((0.0, 0.0), LOOSE, cell=0.0)
    seen = fresh()
    seen.update(view(()), 7, EYE[:2])
    with pytest.raises(ValueError, match="7, the frame of the last view, got 3"):
        seen.update(view(()), 3, EYE[:2])


def test_an_update_is_cheap() -> None:
    """About 4 ms of processor time in 2024; ten times that here means that something is no longer vectorised."""
    seen, image = fresh(), view((TABLE, BOTTLE, BALL))
    seen.update(image, 0, EYE[:2])
    took = []
    for k in range(5):
        start = time.thread_time()
        seen.update(image, k, EYE[:2])
        took.append(time.thread_time() - start)
    assert min(took) < 0.04
