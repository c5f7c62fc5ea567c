"""Paths from where no robot should be, and past the edge of what was seen."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.skills.motor.navigation import plan

CELL, SIZE, RADIUS = 0.1, 80, 0.29
ORIGIN = np.array([-4.0, -4.0])  # [m]


def cells(low: float, high: float) -> slice:
    return slice(round((low + 4.0) / CELL), round((high + 4.0) / CELL))


@pytest.mark.parametrize("gap", [0.05, 0.15, 0.25])
def test_a_robot_that_touches_a_wall_gets_away_from_it(gap: float) -> None:
    """Its middle is `gap` from the wall, so that every cell under it is one where no robot fits."""
    height, seen = np.zeros((SIZE, SIZE), np.float32), np.ones((SIZE, SIZE), bool)
    height[:, cells(-2.0, -1.0)] = 1.0
    path = plan(height, seen, CELL, ORIGIN, (-1.0 + gap, 0.0), (2.0, 0.0), RADIUS, 0.3)
    assert path is not None and path.short <= 0.3 and (path.points[:, 0] > -1.0).all()


def test_a_way_may_lead_past_the_edge_of_what_was_seen() -> None:
    """A wall stands across the whole strip that was seen; what lies beside it was not seen, and may be free."""
    height, seen = np.zeros((SIZE, SIZE), np.float32), np.zeros((SIZE, SIZE), bool)
    seen[cells(-0.5, 0.5), cells(-3.0, 3.0)] = True
    height[cells(-0.5, 0.5), cells(-0.1, 0.1)] = 2.0
    path = plan(height, seen, CELL, ORIGIN, (-2.0, 0.0), (2.0, 0.0), 0.2, 0.3)
    assert path is not None and path.short <= 0.3
    assert np.abs(path.points[:, 1]).max() > 0.5
