"""The optimistic bound, by hand. That no plan exceeds it is tested with the plans."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.sketch.planning.bound import Completion, never_damaged, upper_bound
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel
from tests.worlds.rescue_plans import PER_METRE


@pytest.fixture
def problem() -> Problem:
    """Targets at 1 m and -2 m of the start: entries of 62 + 50 and 124 + 50 frames. The second one comes too late."""
    places = np.array([1.0, -2.0, 0.0])
    travel = StaticTravel(PER_METRE * np.abs(places[:, None] - places))
    return Problem(travel, [5, 5], [150, 100], [40, 40], [10, 10], limit=500)


def test_what_comes_too_late_counts_half_and_what_does_not_fit_counts_in_part(problem: Problem) -> None:
    assert upper_bound(problem) == 7.5
    assert upper_bound(replace(problem, limit=112 + 87)) == pytest.approx(6.25)  # half of the 174 frames are left
    assert upper_bound(replace(problem, limit=173)) == 5  # even alone it would be too late
    assert upper_bound(replace(problem, limit=111)) == 0
    assert upper_bound(replace(problem, frame=39)) == 5  # 39 + 112 > 150
    assert upper_bound(replace(problem, frame=38)) == 7.5


def test_without_damage_the_bound_counts_all_in_full(problem: Problem) -> None:
    assert upper_bound(never_damaged(problem)) == 10
    assert never_damaged(problem).damaged_at == (math.inf, math.inf)


def test_what_is_in_the_hand_counts_from_the_frame_at_which_it_is_safe(problem: Problem) -> None:
    assert upper_bound(replace(problem, holding=1)) == 10  # safe at 10; the other at 122 at the earliest
    assert upper_bound(replace(problem, holding=1, frame=35)) == 5 + 2.5  # 35 + 10 + 112 > 150
    assert upper_bound(replace(problem, holding=1, limit=9)) == 0


def test_the_earliest_frame_of_a_wanted_value(problem: Problem) -> None:
    rest = Completion(problem)
    assert rest.best(0, 0, 5) == (7.5, 112)
    assert rest.best(0, 0, 6.25) == (7.5, 112 + 87)
    assert rest.best(0, 0, 7.5) == (7.5, 112 + 174)
    assert rest.best(0, 0, 7.6) == (7.5, math.inf)
    assert rest.best(30, 0, 0) == (7.5, 30)
    assert rest.best(0, 0b01, 1.25) == (2.5, 87)


def test_the_nearest_cart_is_part_of_the_entry() -> None:
    """Each target is 1 m from the nearer cart: 62 there, 40, 62 back and 10 frames; 2 m is the other way round."""
    places = np.array([1.0, 4.0, 0.0, 3.0, 0.0])
    travel = StaticTravel(PER_METRE * np.abs(places[:, None] - places), carts=2)
    problem = Problem(travel, [1, 1], [math.inf] * 2, [40, 40], [10, 10], limit=348)
    assert upper_bound(problem) == 2
    assert upper_bound(replace(problem, limit=348 - 87)) == pytest.approx(1.5)
