"""A walk ends where the arm can reach its goal: not behind a wall, however near that is."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.skills.motor.navigation import Ways, plan
from hazard_ms.skills.sightlines import behind

CELL, SIZE, RADIUS = 0.1, 100, 0.29
ORIGIN = np.array([-5.0, -5.0])
START, GOAL = (-2.0, -3.0), (0.25, -3.0)  # the goal lies 0.15 m behind the wall
NEAR, ENOUGH = 0.5, 1.2  # [m]


def floor_with_wall(top: float) -> tuple[np.ndarray, np.ndarray]:
    """A floor that is seen everywhere, and a wall across it, `top` [m] high, with a gap 4.5 m north of the goal."""
    height, seen = np.zeros((SIZE, SIZE), np.float32), np.ones((SIZE, SIZE), bool)
    height[:60, 50:52] = height[75:, 50:52] = top  # x from 0.0 to 0.2 m; the gap is from y = 1.0 to 2.5 m
    return height, seen


@pytest.mark.parametrize("goals", [1, 2])
def test_a_walk_to_what_lies_behind_a_wall_goes_round_it(goals: int) -> None:
    """By hand: the way through the middle of the gap is at least 4 m to it and 4 m on."""
    height, seen = floor_with_wall(2.0)
    ways = Ways(height, seen, CELL, ORIGIN, START, [GOAL, (1.0, 4.0)][:goals], RADIUS)
    path = ways.path(GOAL, NEAR, ENOUGH)
    assert path is not None and path.short <= ENOUGH and path.points[-1][0] > 0.2
    assert 8.0 < path.length < 12.0
    assert ways.length(GOAL, NEAR) == pytest.approx(path.length, rel=0.1)


def test_it_ends_before_what_an_arm_reaches_over() -> None:
    height, seen = floor_with_wall(0.8)
    path = plan(height, seen, CELL, ORIGIN, START, GOAL, RADIUS, NEAR, ENOUGH)
    assert path is not None and path.points[-1][0] < 0.0 and path.length < 2.5


def test_there_is_no_way_where_the_wall_has_no_gap() -> None:
    height, seen = floor_with_wall(2.0)
    height[:, 50:52] = 2.0
    ways = Ways(height, seen, CELL, ORIGIN, START, [GOAL], RADIUS)
    path = ways.path(GOAL, NEAR, ENOUGH)
    assert path is not None and path.short == np.inf
    assert ways.length(GOAL, NEAR) == np.inf


def test_what_lies_in_a_shelf_is_not_behind_it() -> None:
    height, _ = floor_with_wall(2.0)
    places = np.array([[-1.0, -3.0], [1.0, -3.0], [1.0, 1.7]])
    assert behind(height, CELL, ORIGIN, places, GOAL).tolist() == [True, False, False]
    assert not behind(height, CELL, ORIGIN, places[:2], (0.05, -3.0)).any()  # in what is tall itself
    assert not behind(height, CELL, ORIGIN, places[:0], GOAL).any()


def test_nobody_reaches_through_a_shelf_lengthwise_or_through_the_wall_at_its_back() -> None:
    """A shelf, 1 m wide and 0.4 m deep, stands with its back at a wall of 0.2 m; the goal is in its middle."""
    height = np.zeros((SIZE, SIZE), np.float32)
    height[45:55, 48:52] = 1.9  # x from -0.2 to 0.2 m, y from -0.5 to 0.5 m
    height[:, 46:48] = 2.4  # the wall, x from -0.4 to -0.2 m
    front, beside, through = [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]
    assert behind(height, CELL, ORIGIN, np.array([front, beside, through]), (0.0, 0.0)).tolist() == [False, True, True]


def test_another_tall_thing_hides_what_stands_in_a_shelf() -> None:
    height = np.zeros((SIZE, SIZE), np.float32)
    height[45:55, 48:52] = 1.9
    height[:, 58:60] = 2.4  # a wall at x from 0.8 to 1.0 m
    assert behind(height, CELL, ORIGIN, np.array([[0.6, 0.0], [1.2, 0.0]]), (0.0, 0.0)).tolist() == [False, True]
