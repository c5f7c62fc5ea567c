"""Targets that count less the later they are safe, or the less likely in time: by hand, and against every order."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel


def problem(
    fading: float = 0.0, limit: float = 1000.0, frame: float = 0.0, seed: int = 0, count: int = 5, spread: float = 0.0
) -> Problem:
    """Targets anywhere within 4 m of the start, some of which are damaged early."""
    draw = np.random.default_rng(seed)
    places = np.vstack([draw.uniform(-4, 4, (count, 2)), np.zeros(2)])
    travel = StaticTravel(62 * np.hypot(*np.moveaxis(places[:, None] - places, -1, 0)))
    values, damaged = draw.choice([1.0, 5.0], count).tolist(), draw.uniform(100, 900, count).tolist()
    return Problem(travel, values, damaged, [60.0] * count, [4.0] * count, limit, frame, fading=fading, spread=spread)


def test_a_target_fades_from_now_on() -> None:
    """Value 1 or 5, 0.0005 a frame from frame 100 on: at frame 500 a fifth is gone; half of the rest when damaged."""
    faded, whole = problem(0.0005, frame=100.0), problem(0.0, frame=100.0)
    for target in range(5):
        assert faded.worth(target, 500) == pytest.approx(0.8 * whole.worth(target, 500))
        assert faded.worth(target, 100) == whole.worth(target, 100)


def test_a_target_counts_by_the_chance_that_it_is_safe_in_time() -> None:
    """Standard deviation 4 * sqrt(900) = 120 frames at frame 900: the 100 frames to spare are 0.8333 of it."""
    risky, sure = problem(spread=4.0), problem()
    for safe, chance in ((900, 0.79767), (1000, 0.5), (400, 1.0), (0, 1.0)):
        assert risky.worth(0, safe) == pytest.approx(chance * sure.worth(0, safe), abs=1e-4)


def test_a_cheap_target_on_the_way_is_left_where_a_dear_one_would_hardly_be_safe_in_time() -> None:
    """Value 1 on the way to value 5: with both, the dear one is safe at frame 480 of 500; without, at 360."""
    travel = StaticTravel([[0.0, 100.0, 100.0], [100.0, 0.0, 300.0], [100.0, 300.0, 0.0]])
    for spread, targets in ((0.0, [0, 1]), (8.0, [1])):
        given = Problem(travel, [1.0, 5.0], [np.inf] * 2, [220.0, 60.0], [0.0, 0.0], 500.0, spread=spread)
        assert [rescue.target for rescue in solve(given).rescues][: len(targets)] == targets


def test_a_target_counts_by_the_chance_to_be_safe_before_it_is_damaged() -> None:
    """At spread 4, after 100 frames, the deviation is 40 frames: 40 before the deadline are 84.13 % (normal tables)."""
    travel = problem().travel
    given = Problem(travel, [2.0] * 5, [140.0] * 5, [0.0] * 5, [0.0] * 5, 10_000.0, spread=4.0)
    assert given.worth(0, 100.0) == pytest.approx(2.0 * (0.5 + 0.5 * 0.8413), abs=1e-3)
    assert given.worth(0, 140.0) == pytest.approx(2.0 * 0.75)
    assert given.worth(0, 141.0) == pytest.approx(2.0 * 0.5)  # later than planned it never is whole


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize(("fading", "spread"), [(0.0006, 0.0), (0.0, 5.0), (0.0004, 3.0)])
def test_the_best_order_is_found(seed: int, fading: float, spread: float) -> None:
    """All orders of all subsets of five targets are tried."""
    given = problem(fading, limit=900.0, seed=seed, spread=spread)
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


@pytest.mark.parametrize("spread", [-1.0, float("inf"), float("nan")])
def test_a_spread_below_nothing_is_refused(spread: float) -> None:
    with pytest.raises(ValueError, match="spread must be finite and at least 0"):
        problem(spread=spread)
