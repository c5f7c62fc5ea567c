"""The division of targets is the best there is: plain on a line, and with every division tried on small problems."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel
from hazard_ms.sketch.teams.split import MOST_TARGETS, Split, split
from tests.worlds.rescue_plans import PER_METRE, PlainProblem, best_by_trial, random_problem


def line(*places: float, start: float = 0.0, limit: float = 1000.0) -> Problem:
    """Targets of value 1 at `places` [m] on a line, 50 frames to pick up, none to put away."""
    at = np.array([*places, start])
    travel = StaticTravel(PER_METRE * np.abs(at[:, None] - at))
    count = len(places)
    return Problem(travel, [1.0] * count, [math.inf] * count, [50.0] * count, [0.0] * count, limit)


def order(made: Split) -> list[list[int]]:
    """The targets that each robot fetches, in turn."""
    return [[rescue.target for rescue in own] for own in made.orders]


def test_each_of_two_goes_to_its_side_of_a_line() -> None:
    """2 and 4 m to the left, 2 and 4 m to the right: each side takes 4 x 62 + 2 x 50 = 348 frames, both more."""
    problem = line(-4.0, -2.0, 2.0, 4.0, limit=348.0)
    assert solve(problem).value == 2.0
    made = split([problem, problem])
    assert made.value == 4.0 and made.exact
    assert sorted(order(made)) == [[1, 0], [2, 3]]
    assert {own[-1].safe for own in made.orders} == {348.0}
    assert split([line(-4.0, -2.0, 2.0, 4.0, limit=347.0)] * 2).value == 2.0


def test_each_begins_at_its_own_place() -> None:
    """From 0 and from 10 m: what lies at 1 and 9 m takes 62 + 50 frames of each."""
    made = split([line(1.0, 9.0, limit=112.0), line(1.0, 9.0, start=10.0, limit=112.0)])
    assert made.value == 2.0 and order(made) == [[0], [1]]
    assert split([line(1.0, 9.0, limit=112.0)] * 2).value == 1.0


def test_nothing_is_fetched_twice_and_what_cannot_be_done_is_left() -> None:
    assert split([line(1.0, limit=500.0)] * 3).value == 1.0
    made = split([line(1.0, 50.0, limit=500.0)] * 2)
    assert made.value == 1.0 and sorted(order(made)) == [[], [0]]
    assert split([line()] * 2) == Split(((), ()), 0.0, True)


def best_division(plain: PlainProblem, robots: int) -> float:
    """The most value of all divisions, of each of which every order is tried."""
    count = len(plain.values)
    made = {}
    for own in itertools.product([False, True], repeat=count):
        made[own] = best_by_trial(replace(plain, values=np.where(own, plain.values, 0.0).tolist()), False)[0]
    divisions = itertools.product(range(robots), repeat=count)
    return max(sum(made[tuple(who == r for who in d)] for r in range(robots)) for d in divisions)


@pytest.mark.parametrize(("robots", "most", "carts"), [(1, 5, 2), (2, 5, 0), (2, 4, 2), (3, 5, 0), (4, 4, 1)])
def test_no_division_is_worth_more(robots: int, most: int, carts: int) -> None:
    chance = np.random.default_rng(robots + 10 * carts)
    gained = 0
    for _ in range(12):
        plain = replace(random_problem(chance, False, most, carts), holding=None)
        plain = replace(plain, limit=plain.limit / 2)
        problem = plain.problem()
        made = split([problem] * robots)
        assert made.value == pytest.approx(best_division(plain, robots))
        fetched = [target for own in order(made) for target in own]
        assert len(set(fetched)) == len(fetched)
        assert made.value == pytest.approx(sum(rescue.value for own in made.orders for rescue in own))
        for own in made.orders:
            frame, spot = 0.0, problem.travel.start
            for rescue in own:
                met = problem.travel.meetings(spot, frame, [rescue.target])[0][0]
                stows = problem.stows(rescue.target, (rescue.target, 0), met + problem.pick[rescue.target])
                frame, spot = next((stow.safe, stow.spot) for stow in stows if stow.cart == rescue.cart)
                assert (rescue.met, rescue.safe) == pytest.approx((met, frame)) and frame <= problem.limit
        gained += made.value > solve(problem).value
    assert gained > 0 or robots == 1


def test_bad_input_is_refused() -> None:
    with pytest.raises(ValueError, match="the same number of targets, at most .*, got 1, 2"):
        split([line(1.0), line(1.0, 2.0)])
    with pytest.raises(ValueError, match="got no robots"):
        split([])
    with pytest.raises(ValueError, match=f"at most {MOST_TARGETS}, got 17"):
        split([line(*range(1, 18))])
    with pytest.raises(ValueError, match="empty hands"):
        split([replace(line(1.0), holding=0)])
