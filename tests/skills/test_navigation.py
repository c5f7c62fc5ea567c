"""Paths over a height grid, against geometry that can be worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.skills.motor.navigation import Ways, plan

CELL, SIZE, RADIUS = 0.1, 80, 0.29
ORIGIN = np.array([-4.0, -4.0])


def grid() -> tuple[np.ndarray, np.ndarray]:
    return np.zeros((SIZE, SIZE), np.float32), np.ones((SIZE, SIZE), bool)


def box(height: np.ndarray, x: tuple[float, float], y: tuple[float, float], top: float) -> None:
    a, b = (int(round((v + 4.0) / CELL)) for v in y)
    c, d = (int(round((v + 4.0) / CELL)) for v in x)
    height[a:b, c:d] = top


def distance_to_box(point: np.ndarray, x: tuple[float, float], y: tuple[float, float]) -> float:
    return float(np.hypot(max(x[0] - point[0], 0.0, point[0] - x[1]), max(y[0] - point[1], 0.0, point[1] - y[1])))


def along(path_points: np.ndarray, start: tuple[float, float]) -> np.ndarray:
    whole = np.vstack([np.asarray(start)[None], path_points])
    pieces = [np.linspace(a, b, 50) for a, b in zip(whole[:-1], whole[1:], strict=True)]
    return np.vstack(pieces)


def test_free_floor_is_crossed_straight() -> None:
    height, seen = grid()
    path = plan(height, seen, CELL, ORIGIN, (-2.0, -1.0), (2.0, 1.5), RADIUS, 0.5)
    assert path is not None and len(path.points) <= 2
    assert path.short <= 0.5
    assert path.length == pytest.approx(np.hypot(4.0, 2.5) - 0.5, abs=0.25)


def test_a_wall_is_passed_through_its_gap_at_a_robot_s_distance() -> None:
    height, seen = grid()
    lower, upper = ((-0.1, 0.1), (-4.0, 1.0)), ((-0.1, 0.1), (2.0, 4.0))
    box(height, *lower, 2.0)
    box(height, *upper, 2.0)
    path = plan(height, seen, CELL, ORIGIN, (-2.0, -2.0), (2.0, -2.0), RADIUS, 0.3)
    assert path is not None and path.short <= 0.3
    points = along(path.points, (-2.0, -2.0))
    assert min(min(distance_to_box(p, *lower), distance_to_box(p, *upper)) for p in points) > RADIUS - CELL / 2
    assert any(1.0 < p[1] < 2.0 and abs(p[0]) < 0.2 for p in points)


def test_a_gap_narrower_than_the_robot_is_no_way() -> None:
    height, seen = grid()
    box(height, (-0.1, 0.1), (-4.0, 1.0), 2.0)
    box(height, (-0.1, 0.1), (1.4, 4.0), 2.0)
    path = plan(height, seen, CELL, ORIGIN, (-2.0, -2.0), (2.0, -2.0), RADIUS, 0.3)
    if path is not None:
        assert path.short > 1.0 and (path.points[:, 0] < 0.0).all()


def test_a_book_is_walked_around_where_there_is_room_and_over_where_there_is_none() -> None:
    height, seen = grid()
    book = ((-0.2, 0.2), (-0.2, 0.2))
    box(height, *book, 0.08)
    free = plan(height, seen, CELL, ORIGIN, (-2.0, 0.0), (2.0, 0.0), RADIUS, 0.3)
    assert free is not None and min(distance_to_box(p, *book) for p in along(free.points, (-2.0, 0.0))) > 0.15
    box(height, (-4.0, 4.0), (-0.9, -0.5), 1.0)
    box(height, (-4.0, 4.0), (0.5, 0.9), 1.0)
    narrow = plan(height, seen, CELL, ORIGIN, (-2.0, 0.0), (2.0, 0.0), RADIUS, 0.3)
    assert narrow is not None and narrow.short <= 0.3


def test_to_a_thing_on_a_table_it_ends_at_the_table_s_edge() -> None:
    height, seen = grid()
    table = ((0.6, 1.8), (-0.6, 0.6))
    box(height, *table, 0.75)
    path = plan(height, seen, CELL, ORIGIN, (-2.0, 0.0), (0.9, 0.0), RADIUS, 0.5)
    assert path is not None
    assert distance_to_box(path.points[-1], *table) == pytest.approx(RADIUS + CELL / 2, abs=0.1)
    assert path.short < 0.75


def test_it_finds_its_way_out_from_too_near_an_obstacle() -> None:
    height, seen = grid()
    box(height, (-2.0, -1.0), (-1.0, 1.0), 1.0)
    path = plan(height, seen, CELL, ORIGIN, (-0.8, 0.0), (2.0, 0.0), RADIUS, 0.3)
    assert path is not None and path.short <= 0.3
    assert (path.points[:, 0] > -0.85).all()


def test_seen_floor_is_preferred_to_unseen_floor() -> None:
    height, seen = grid()
    seen[:] = False
    seen[36:44, 10:50] = True  # y from -0.4 to 0.4
    seen[36:70, 42:50] = True  # x from 0.2 to 1.0
    path = plan(height, seen, CELL, ORIGIN, (-2.5, 0.0), (0.6, 2.5), RADIUS, 0.3)
    assert path is not None and path.short <= 0.3
    cells = np.floor((along(path.points, (-2.5, 0.0)) - ORIGIN) / CELL).astype(int)
    assert seen[cells[:, 1], cells[:, 0]].mean() > 0.9


def test_outside_the_map_there_is_no_path() -> None:
    height, seen = grid()
    assert plan(height, seen, CELL, ORIGIN, (0.0, 0.0), (9.0, 0.0), RADIUS, 0.3) is None


def test_one_search_gives_the_paths_to_all_goals() -> None:
    """The same as a search for each; lengths along the cells are up to 8 % longer (a knight's move: 2.414 / 2.236)."""
    height, seen = grid()
    box(height, (-0.1, 0.1), (-4.0, 1.0), 2.0)
    goals = [(2.0, -2.0), (-1.0, 3.0), (3.0, 3.0), (-3.0, -3.0)]
    ways = Ways(height, seen, CELL, ORIGIN, (-2.0, -2.0), goals, RADIUS)
    for goal in goals:
        alone = plan(height, seen, CELL, ORIGIN, (-2.0, -2.0), goal, RADIUS, 0.5)
        path = ways.path(goal, 0.5)
        assert path is not None and alone is not None and np.array_equal(path.points, alone.points)
        assert path.length - CELL <= ways.length(goal, 0.5) <= 1.09 * path.length + CELL


def test_where_no_way_leads_its_length_is_infinite() -> None:
    height, seen = grid()
    box(height, (-0.1, 0.1), (-4.0, 4.0), 2.0)
    ways = Ways(height, seen, CELL, ORIGIN, (-2.0, -2.0), [(2.0, 2.0)], RADIUS)
    assert ways.length((2.0, 2.0), 0.5) == float("inf")
    outside = Ways(height, seen, CELL, ORIGIN, (-2.0, -2.0), [(99.0, 0.0)], RADIUS)
    assert outside.path((99.0, 0.0), 0.5) is None and outside.length((99.0, 0.0), 0.5) == float("inf")


@pytest.mark.parametrize("offset", [0.0, 0.02, 0.05, 0.08])
def test_a_gap_is_tried_where_the_map_is_too_coarse_to_tell_whether_the_robot_fits(offset: float) -> None:
    """It is 0.62 m wide, the robot 0.58 m; every cell that an obstacle touches is an obstacle as a whole."""
    height, seen = grid()
    low, high = 1.0 + offset, 1.62 + offset
    box(height, (-0.1, 0.1), (-4.0, float(np.ceil(round(low / CELL, 6))) * CELL), 2.0)
    box(height, (-0.1, 0.1), (float(np.floor(round(high / CELL, 6))) * CELL, 4.0), 2.0)
    path = plan(height, seen, CELL, ORIGIN, (-2.0, 1.3), (2.0, 1.3), RADIUS, 0.3)
    assert path is not None and path.short <= 0.3
    inside = [p for p in along(path.points, (-2.0, 1.3)) if abs(p[0]) < 0.1]
    assert inside and all(low + RADIUS - CELL / 2 < p[1] < high - RADIUS + CELL / 2 for p in inside)
    box(height, (-0.1, 0.1), (-2.0, -1.0), 0.0)
    around = plan(height, seen, CELL, ORIGIN, (-2.0, 1.3), (2.0, 1.3), RADIUS, 0.3)
    assert around is not None and around.points[:, 1].min() < -1.0, "a wide gap is worth a detour"


def test_a_detour_is_worth_it_where_only_its_end_is_near_enough() -> None:
    """Before the wall, over which an arm reaches, the robot gets to 1.1 m from its goal; behind it, to the goal."""
    height, seen = grid()
    box(height, (-0.1, 0.1), (-4.0, 1.5), 1.2)
    lazy = plan(height, seen, CELL, ORIGIN, (-1.5, -1.0), (0.6, -1.0), RADIUS, 0.5)
    assert lazy is not None and lazy.points[-1, 0] < 0.0 and 0.9 < lazy.short <= 1.1
    eager = plan(height, seen, CELL, ORIGIN, (-1.5, -1.0), (0.6, -1.0), RADIUS, 0.5, 0.8)
    assert eager is not None and eager.points[-1, 0] > 0.0 and eager.short <= 0.5
