"""The best plan that begins with a given rescue: a line with two targets, by hand, and every first rescue by search."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hazard_ms.sketch.planning.committed import committed
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel
from tests.worlds.rescue_plans import PER_METRE

LABELS = (10_000, 1_000)  # of a search


def line(limit: float, holding: int | None = None) -> Problem:
    """A start at 0 m, target 0 of value 1 at 1 m, and target 1 of value 5 at -1 m, picked up in 50 frames."""
    at = np.array([1.0, -1.0, 0.0])
    travel = StaticTravel(PER_METRE * np.abs(at[:, None] - at))
    return Problem(travel, [1.0, 5.0], [np.inf, np.inf], [50.0, 50.0], [0.0, 0.0], limit, holding=holding)


def test_the_wrong_target_first_costs_what_is_too_late_afterwards() -> None:
    """One target takes 62 + 50 frames, both 112 + 124 + 50 = 286."""
    assert [committed(line(286.0), first, None, *LABELS) for first in (0, 1)] == [6.0, 6.0]
    assert [committed(line(285.0), first, None, *LABELS) for first in (0, 1)] == [1.0, 5.0]
    assert [committed(line(111.0), first, None, *LABELS) for first in (0, 1)] == [0.0, 0.0]
    spoilt = dataclasses.replace(line(286.0), damaged_at=[np.inf, 150.0])
    assert [committed(spoilt, first, None, *LABELS) for first in (0, 1)] == [1.0 + 2.5, 6.0]


def test_what_is_in_the_hand_comes_first() -> None:
    """It is put away where one stands, from where the other is 62 + 50 frames away."""
    assert committed(line(112.0, holding=0), 0, None, *LABELS) == 6.0
    assert committed(line(111.0, holding=0), 0, None, *LABELS) == 1.0
    with pytest.raises(ValueError, match="target must be the one in the hand, 0, got 1"):
        committed(line(300.0, holding=0), 1, None, *LABELS)


def test_the_cart_can_be_chosen() -> None:
    """Carts at 0 m and 3 m, targets at 1 m and 4 m: via the far cart 310 frames, via the near one 434."""
    at = np.array([1.0, 4.0, 0.0, 3.0, 0.0])
    travel = StaticTravel(PER_METRE * np.abs(at[:, None] - at), carts=2)
    ways = {limit: Problem(travel, [1.0, 1.0], [np.inf] * 2, [0.0] * 2, [0.0] * 2, limit) for limit in (310.0, 309.0)}
    assert committed(ways[310.0], 0, 1, *LABELS) == committed(ways[310.0], 0, None, *LABELS) == 2.0
    assert committed(ways[310.0], 0, 0, *LABELS) == committed(ways[309.0], 0, 1, *LABELS) == 1.0


def test_the_best_of_all_beginnings_is_the_best_plan() -> None:
    random = np.random.default_rng(5)
    for _ in range(100):
        count, carts = int(random.integers(2, 6)), int(random.integers(0, 3))
        nodes = count + carts + 1
        problem = Problem(
            StaticTravel(random.uniform(10.0, 200.0, (nodes, nodes)), carts),
            values=random.choice([1.0, 5.0], count).tolist(),
            damaged_at=random.uniform(0.0, 900.0, count).tolist(),
            pick=random.uniform(20.0, 80.0, count).tolist(),
            drop=random.uniform(0.0, 50.0, carts or count).tolist(),
            limit=600.0,
        )
        best = solve(problem).value
        beginnings = [committed(problem, target, None, *LABELS) for target in range(count)]
        assert max(beginnings) == pytest.approx(best) and max(beginnings) <= best + 1e-9
