"""Walls on a map: what they hide, what goes round them, and doors that are shut in them."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.agents.search.floor_plan import FloorPlan
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sensing.semantic_map import SemanticMap

WALL = 2.0  # x of a wall that runs along y [m]
DOOR = KnownOpening("door_0", 0, "door", (WALL, 0.0, 1.0), 1.0, 1.0, False, 0)


def two_rooms(tall: float = 1.93) -> SemanticMap:
    """Floor from -4 to 6 m in x and -3 to 3 m in y, and a wall at WALL with a doorway of 1 m at y = 0."""
    seen = SemanticMap((0.0, 0.0), np.ones(1, bool))
    y, x = np.mgrid[0:256, 0:256]
    points = seen.centre_of(y, x)
    inside = (points[..., 0] > -4) & (points[..., 0] < 6) & (np.abs(points[..., 1]) < 3)
    wall = inside & (np.abs(points[..., 0] - WALL) < 0.08) & (np.abs(points[..., 1]) > 0.5)
    seen.tell(np.where(wall, tall, 0.0).astype(np.float32), inside)
    return seen


def test_walls_hide_and_doorways_do_not() -> None:
    """From (0, 0) one sees through the doorway straight ahead, not past its side; both ends may stand at the wall."""
    plan = FloorPlan(two_rooms())
    points = np.array([[4.0, 0.0], [4.0, 2.5], [1.0, 2.0], [1.9, 1.0], [4.0, 0.8]])
    assert plan.clear(points, np.array([[0.0, 0.0]]))[:, 0].tolist() == [True, False, True, True, True]
    assert not FloorPlan(two_rooms(), (DOOR,)).clear(points, np.array([[0.0, 0.0]]))[[0, 4], 0].any()


def test_furniture_is_no_wall() -> None:
    plan = FloorPlan(two_rooms(tall=1.2))
    assert plan.clear(np.array([[4.0, 2.5]]), np.array([[0.0, 2.5]])).all()


def test_ways_lead_through_the_doorway_until_it_is_shut() -> None:
    """From (0, 2) to (4, 2): by the near jamb, (2, 0.5), 2 x 2.5 m; steps to eight neighbours take at most 8 % more."""
    open_plan, shut_plan = FloorPlan(two_rooms()), FloorPlan(two_rooms(), (DOOR,))
    ways = open_plan.ways_from((0.0, 2.0))
    assert open_plan.at(ways, np.array([[4.0, 2.0]]))[0] == pytest.approx(5.0, rel=0.1)
    assert open_plan.at(ways, np.array([[0.0, -2.0]]))[0] == pytest.approx(4.0, abs=0.2)
    assert open_plan.reached(ways, np.array([4.0, 2.0]))
    assert not shut_plan.reached(shut_plan.ways_from((0.0, 2.0)), np.array([4.0, 2.0]))
