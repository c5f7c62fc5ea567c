"""Where walks end and what is in sight from there, over a map with a wall across it and a doorway in the wall."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.agents.search.stands import in_sight
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.skills.motor.navigation import Ways

WALL = 1.0  # where the wall stands, along x [m]
DOOR = (-0.5, 0.4)  # from and to where it is open, along y [m]


def divided() -> SemanticMap:
    """A map, all of it seen, with a wall from south to north that has one doorway."""
    seen = SemanticMap((0.0, 0.0), np.zeros(1, bool))
    height = np.zeros_like(seen.height)
    _, column = seen.cell_of((WALL + 0.01, 0.0))
    height[:, column] = 2.4
    (low, _), (high, _) = (seen.cell_of((0.0, y)) for y in DOOR)
    height[low:high, column] = 0.0
    seen.tell(height, np.ones_like(seen.explored))
    return seen


@pytest.mark.parametrize(
    ("point", "shown"),
    [
        ((2.0, 0.0), True),  # straight through the doorway
        ((1.9, -0.9), True),  # askew: the line meets the wall at y = -0.43
        ((2.0, 1.5), False),  # behind the wall
        ((0.5, 1.5), True),  # on this side
        ((0.0, -3.1), False),  # too far
    ],
)
def test_walls_hide_what_is_behind_them_but_not_through_a_doorway(point: tuple[float, float], shown: bool) -> None:
    assert in_sight(divided(), (0.05, 0.05), np.array([point]), 3.0).tolist() == [shown]


def test_the_way_to_what_is_behind_a_wall_leads_through_the_doorway() -> None:
    """1.5 m apart as the crow flies; the way is longer than past the edge of the doorway, shorter than along axes."""
    seen, here, there = divided(), (0.45, 1.5), (1.95, 1.5)
    ways = Ways(seen.height, seen.explored, seen.cell, seen.origin, here, [there, here], 0.29)
    path = ways.path(there, 0.0)
    assert path is not None and path.short < 0.1
    assert 2 * np.hypot(0.5, 1.1) < path.length < 2 * (0.5 + 1.5) + 0.2
    assert any(abs(x - WALL) < 0.3 and DOOR[0] < y < DOOR[1] for x, y in path.points)
