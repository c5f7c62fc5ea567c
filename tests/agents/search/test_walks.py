"""Walks over a map against lengths that geometry gives: straight on, around a wall, and where there is no way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import ndimage

from hazard_ms.agents.search import walks
from hazard_ms.agents.search.walks import LONGEST_DETOUR, NO_DETOUR, TURNING, barring, detours, frames_between, way_end
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sketch.travel.ways import RADIUS, WALK
from tests.agents.search.test_floor_plan import DOOR, two_rooms


def open_floor(half: float = 4.0) -> SemanticMap:
    """A map on which a square of floor around the origin was seen, from -half to half [m]."""
    seen = SemanticMap((0.0, 0.0), np.zeros(1, bool))
    for y, x in np.ndindex(seen.explored.shape):
        seen.explored[y, x] = max(map(abs, seen.centre_of(y, x))) < half
    return seen


def build(seen: SemanticMap, low: tuple[float, float], high: tuple[float, float], height: float = 1.0) -> None:
    """Let something stand on the map from the corner `low` to `high` [m]."""
    (y0, x0), (y1, x1) = seen.cell_of(low), seen.cell_of(high)
    seen._firm[y0:y1, x0:x1] = height


def metres(seen: SemanticMap, start: tuple[float, float], *goals: tuple[float, float], near: float = 0.5) -> np.ndarray:
    """Lengths of the walks between goals and start [m], [G + 1, G + 1]."""
    frames = frames_between(seen, start, np.array(goals), np.full(len(goals), near), RADIUS)
    return (frames - TURNING) / WALK


def test_a_walk_over_open_floor_ends_before_its_goal() -> None:
    """3 m less 0.5 m; back from there to the start, and on to another goal: all straight, to a cell or two."""
    found = metres(open_floor(), (-1.5, 0.0), (1.5, 0.0), (1.5, 3.0))
    assert found[2, 0] == pytest.approx(2.5, abs=0.2)
    assert found[0, 2] == pytest.approx(2.5, abs=0.2)
    assert found[0, 1] == pytest.approx(2.5, abs=0.5)
    assert frames_between(open_floor(1), (0, 0), np.array([(3.0, 0.0)]), np.array([0.5]), RADIUS)[1, 1] == 0.0


def test_a_walk_goes_around_a_wall() -> None:
    """A wall of 5 m along y between start and goal: over its nearer end, at 2 m, with 0.15 m to spare."""
    seen = open_floor()
    build(seen, (-0.1, -3.0), (0.1, 2.0))
    way = metres(seen, (-1.5, 0.0), (1.5, 0.0))[1, 0]
    assert way == pytest.approx(2 * np.hypot(1.5, 2.15 + RADIUS) - 0.5, rel=0.12)


def test_where_walls_count_a_walk_ends_on_the_side_of_its_goal() -> None:
    """A thing 0.4 m behind a wall is within 1 m from before it; its own side is reached over the wall's end at 2 m."""
    seen, start, goal = open_floor(), (-1.5, 0.0), np.array([(0.5, 0.0)])
    build(seen, (-0.1, -3.0), (0.1, 2.0), 1.9)
    near, far = (frames_between(seen, start, goal, np.ones(1), RADIUS, walls)[1, 0] for walls in (False, True))
    assert (near - TURNING) / WALK == pytest.approx(1.0, abs=0.25)
    over = np.hypot(1.5, 2.15 + RADIUS) + np.hypot(0.5, 2.15 + RADIUS) - 1.0
    assert (far - TURNING) / WALK == pytest.approx(over, rel=0.15)


def test_there_is_no_way_into_a_closed_room() -> None:
    seen = open_floor()
    for low, high in (((1, -1), (1.2, 1)), ((3, -1), (3.2, 1)), ((1, -1.2), (3.2, -1)), ((1, 1), (3.2, 1.2))):
        build(seen, low, high)
    found = metres(seen, (-1.5, 0.0), (2.1, 0.0), (-1.5, 2.0))
    assert np.isinf(found[2, 0]) and np.isinf(found[1, 0]) and np.isinf(found[0, 1])
    assert found[2, 1] == pytest.approx(1.5, abs=0.2)


def test_a_robot_that_stands_too_close_to_something_still_walks() -> None:
    seen = open_floor()
    build(seen, (-1.5, 0.2), (1.0, 0.4))
    assert metres(seen, (-1.0, 0.1), (2.0, -1.0))[1, 0] == pytest.approx(np.hypot(3.0, 1.1) - 0.5, rel=0.15)


def test_coarse_cells_give_the_same_lengths_where_gaps_are_wide(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = open_floor()
    build(seen, (-0.1, -3.0), (0.1, 2.0))
    fine = metres(seen, (-1.5, 0.0), (1.5, 0.0), (1.5, 3.0))
    monkeypatch.setattr(walks, "MOST_CELLS", 1000)
    assert metres(seen, (-1.5, 0.0), (1.5, 0.0), (1.5, 3.0)) == pytest.approx(fine, abs=0.45)


def test_a_detour_is_what_a_walk_takes_longer_than_told() -> None:
    goal, plain = np.array([[3.0, 0.0]]), np.array([WALK * 2.5 + TURNING])
    near, seen = np.array([0.5]), open_floor()
    assert detours(seen, (0.0, 0.0), goal, near, RADIUS, plain).tolist() == [0.0]
    build(seen, (1.4, -2.0), (1.6, 2.0))
    around = frames_between(seen, (0.0, 0.0), goal, near, RADIUS)[-1, 0]
    longer = detours(seen, (0.0, 0.0), goal, near, RADIUS, plain)
    assert longer == pytest.approx(around - plain - NO_DETOUR) and longer > 60.0  # 2.3 m to the side and back: 140
    assert detours(seen, (0.0, 0.0), goal, near, RADIUS, np.array([np.inf])).tolist() == [0.0]
    build(seen, (1.4, -4.5), (1.6, 4.5))
    assert detours(seen, (0.0, 0.0), goal, near, RADIUS, plain).tolist() == [LONGEST_DETOUR]


def hall(*boxes: tuple[tuple[float, float], tuple[float, float]]) -> tuple[SemanticMap, KnownOpening]:
    """A hall of 6 m x 1.8 m around the origin, all that was seen, and a door in its north wall at x from 0 to 0.9 m.

    It is open into the hall: its leaf stands at x = 0 and leaves 0.9 m of the hall free. `boxes`: corners of more [m].
    """
    seen = open_floor()
    for low, high in (((-3.2, 0.9), (0, 1.1)), ((0.9, 0.9), (3.2, 1.1)), ((-3.2, -1.1), (3.2, -0.9))):
        build(seen, low, high, 1.9)
    for x in (-3.2, 3.0):
        build(seen, (x, -1.1), (x + 0.2, 1.1), 1.9)
    build(seen, (-0.05, 0.0), (0.05, 0.9), 1.9)
    for low, high in boxes:
        build(seen, low, high)
    y, x = np.nonzero(seen.explored)
    seen.explored[y, x] = (np.abs(seen.centre_of(y, x)) < (3.2, 1.1)).all(-1)
    leaf = (0.0, 0.9), (0.0, 0.0)
    return seen, KnownOpening("door_0", 0, "door", (0.45, 0.9, 1.0), 0.9, 1.0, False, 0, leaf=leaf)


def test_a_leaf_bars_the_way_where_something_stands_beside_it() -> None:
    """Between leaf and box are 0.45 m, and 0.45 m between box and wall: Fetch, 0.56 m wide, needs the leaf's place."""
    beside = (-0.1, -0.45), (0.1, -0.25)
    seen, door = hall(beside)
    assert barring(seen, (-2.0, 0.0), [door], RADIUS) == door
    assert barring(seen, (2.0, 0.0), [door], RADIUS) == door
    assert barring(seen, (-2.0, 0.0), [replace(door, leaf=None)], RADIUS) is None
    assert barring(seen, (-2.0, 0.0), [], RADIUS) is None


@pytest.mark.parametrize(
    "boxes",
    [
        [],
        [((-0.1, -0.9), (0.1, -0.7))],
        [((0.5, -0.9), (0.7, 0.9))],
        [((-2.0, -0.9), (-1.9, 0.9)), ((-0.1, -0.45), (0.1, -0.25))],
    ],
    ids=["0.9 m are free", "0.7 m are free", "the box bars it alone", "the way to the door is barred"],
)
def test_a_leaf_bars_no_way_where_there_is_room_or_its_place_is_no_help(
    boxes: list[tuple[tuple[float, float], tuple[float, float]]],
) -> None:
    seen, door = hall(*boxes)
    assert barring(seen, (-2.4, 0.0), [door], RADIUS) is None


def test_a_door_that_is_the_way_on_is_not_shut() -> None:
    """Behind it 3 m x 3 m were seen, more than the 5 m2 of the hall beyond its leaf."""
    seen, door = hall(((-0.1, -0.45), (0.1, -0.25)))
    y, x = np.nonzero(~seen.explored)
    points = seen.centre_of(y, x)
    seen.explored[y, x] = (points > (-1.0, 1.1)).all(-1) & (points < (2.0, 4.1)).all(-1)
    assert barring(seen, (2.0, 0.0), [door], RADIUS) is None


def test_a_barred_way_ends_before_what_bars_it() -> None:
    """A board floats in the doorway at x = 2 m: a robot gets no farther, though walls are nearer to the goal.

    With the door shut no way leads there at all.
    """
    seen, goal = two_rooms(), (3.0, 2.5)
    outer = ndimage.binary_dilation(seen.explored, np.ones((5, 5), bool)) & ~seen.explored
    seen.tell(np.where(outer, 1.93, seen.height).astype(np.float32), seen.explored | outer)
    y, x = np.nonzero(seen.explored)
    there = (np.abs(seen.centre_of(y, x) - (2.0, 0.0)) < (0.15, 0.6)).all(-1)
    height = seen.height.copy()
    height[y[there], x[there]] = 0.3
    seen.tell(height, seen.explored)
    end = way_end(seen, (-3.0, 2.5), goal, (DOOR,), RADIUS)
    assert end[0] == pytest.approx(2.0 - 0.15, abs=0.1) and abs(end[1]) < 0.6
    assert way_end(seen, (-3.0, 2.5), goal, (replace(DOOR, open=0.0),), RADIUS) == goal
