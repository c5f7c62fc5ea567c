"""Targets that count less the later they are safe: by hand, and the exact search against every order."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from hazard_ms.planning.orienteering import solve
from hazard_ms.planning.problem import Problem
from hazard_ms.planning.travel import StaticTravel


def problem(fading: float, limit: float = 1000.0, frame: float = 0.0, seed: int = 0, count: int = 5) -> Problem:
    """Targets anywhere within 4 m of the start, some of which are damaged early."""
    draw = np.random.default_rng(seed)
    places = np.vstack([draw.uniform(-4, 4, (count, 2)), np.zeros(2)])
    travel = StaticTravel(62 * np.hypot(*np.moveaxis(places[:, None] - places, -1, 0)))
    values, damaged = draw.choice([1.0, 5.0], count).tolist(), draw.uniform(100, 900, count).tolist()
    return Problem(travel, values, damaged, [60.0] * count, [4.0] * count, limit, frame, fading=fading)


def test_a_target_fades_from_now_on() -> None:
    """Value 1 or 5, 0.0005 a frame from frame 100 on: at frame 500 a fifth is gone; half of the rest when damaged."""
    faded, whole = problem(0.0005, frame=100.0), problem(0.0, frame=100.0)
    for target in range(5):
        assert faded.worth(target, 500) == pytest.approx(0.8 * whole.worth(target, 500))
        assert faded.worth(target, 100) == whole.worth(target, 100)


@pytest.mark.parametrize("seed", range(8))
def test_the_programme_finds_the_best_order_with_fading(seed: int) -> None:
    """All orders of all subsets of five targets are tried."""
    given = problem(0.0006, limit=900.0, seed=seed)
    best = 0.0
    for order in permutations(range(5)):
        frame, spot, value = given.frame, given.travel.start, 0.0
        for target in order:
            frame, spot = given.travel.meetings(spot, frame, [target])[0]
            frame += given.pick[target] + given.drop[target]
            if frame > given.limit:
                break
            value += given.worth(target, frame)
        best = max(best, value)
    plan = solve(given)
    assert plan.exact and plan.value == pytest.approx(best)


def test_of_two_orders_that_save_the_same_the_dearer_target_comes_first() -> None:
    """Values 1 and 5 at 1 m on either side. Without fading, both orders are alike, and the first is taken."""
    travel = StaticTravel(62 * np.array([[0, 2, 1], [2, 0, 1], [1, 1, 0.0]]))
    for fading, first in ((0.0, 0), (0.0001, 1)):
        given = Problem(travel, [1.0, 5.0], [np.inf] * 2, [50.0] * 2, [0.0] * 2, 1000.0, fading=fading)
        assert solve(given).rescues[0].target == first


@pytest.mark.parametrize("fading", [-0.001, 0.002, float("nan")])
def test_fading_beyond_nothing_is_refused(fading: float) -> None:
    with pytest.raises(ValueError, match="fading must be from 0 to 1 over the frames up to the limit"):
        problem(fading)
