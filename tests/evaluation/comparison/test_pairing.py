"""Differences and regret against cases worked out by hand, and their intervals against formulas of their own."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hazard_ms.evaluation.comparison.pairing import Episode, difference, regret
from hazard_ms.evaluation.metrics import Score


def played(*values: float) -> dict[Episode, float]:
    return {(seed, f"kitchen_b/{seed:02d}"): value for seed, value in enumerate(values)}


def numbers(score: Score) -> list[float]:
    assert score.mean is not None and score.low is not None and score.high is not None
    return [score.mean, score.low, score.high]


def test_a_difference_of_two_episodes() -> None:
    """The differences are 0.1 and -0.3.

    A resample has the first twice with chance 1/4, mean 0.1; both with 1/2, -0.1; the second twice with 1/4, -0.3.
    """
    found = difference(played(0.6, 0.2), played(0.5, 0.5))
    assert numbers(found) == pytest.approx([-0.1, -0.3, 0.1])
    assert numbers(difference(played(0.5, 0.5), played(0.6, 0.2))) == pytest.approx([0.1, -0.1, 0.3])


def test_a_regret_of_two_episodes() -> None:
    """Resamples give 1 - 0.6 / 0.8, 1 - 0.8 / 1.2 and 1 - 0.2 / 0.4, with chances 1/4, 1/2 and 1/4."""
    found = regret(played(0.6, 0.2), played(0.8, 0.4))
    assert numbers(found) == pytest.approx([1 / 3, 1 / 4, 1 / 2])
    assert numbers(regret(played(0.7, 0.3), played(0.7, 0.3))) == [0.0, 0.0, 0.0]


def test_how_hard_episodes_are_cancels_out() -> None:
    hard_and_easy = np.linspace(0.1, 0.8, 25)
    found = difference(played(*(hard_and_easy + 0.05)), played(*hard_and_easy))
    assert numbers(found) == pytest.approx([0.05, 0.05, 0.05])


def test_only_common_episodes_count() -> None:
    first, second = played(0.9, 0.5, 0.1), {(1, "kitchen_b/01"): 0.4, (1, "kitchen_b/00"): 0.0, (7, "x"): 1.0}
    assert numbers(difference(first, second)) == pytest.approx([0.1, 0.1, 0.1])
    assert numbers(regret(first, second)) == pytest.approx([-0.25, -0.25, -0.25])


def test_without_common_episodes_or_rescues_of_the_oracle_there_is_no_number() -> None:
    nothing = Score(None, None, None)
    assert difference(played(0.5), {(9, "park/00"): 0.5}) == nothing == difference({}, {})
    assert regret(played(0.5), {(9, "park/00"): 0.5}) == nothing == regret(played(0.5, 0.2), played(0.0, 0.0))
    assert numbers(regret(played(0.5, 0.0), played(1.0, 0.0)))[0] == 0.5  # resamples without the first are left out


def test_more_seeds_in_the_same_scenes_are_no_more_evidence() -> None:
    """Four equal episodes in each of 25 scenes: the intervals are those of one in each."""
    draw = np.random.default_rng(4)
    first, second = played(*draw.random(25)), played(*draw.random(25))

    def repeated(once: dict[Episode, float]) -> dict[Episode, float]:
        return {(seed + 25 * k, scene): value for (seed, scene), value in once.items() for k in range(4)}

    for score in (difference, regret):
        assert numbers(score(repeated(first), repeated(second))) == pytest.approx(numbers(score(first, second)))


def test_scenes_are_drawn_with_all_their_episodes() -> None:
    """Two scenes, with three episodes at 0.1 and one at -0.3: resamples have means of 0.1, 0 and -0.3."""
    first = {(0, "a"): 0.1, (1, "a"): 0.1, (2, "a"): 0.1, (3, "b"): 0.2}
    second = {(0, "a"): 0.0, (1, "a"): 0.0, (2, "a"): 0.0, (3, "b"): 0.5}
    assert numbers(difference(first, second)) == pytest.approx([0.0, -0.3, 0.1])


def test_in_a_single_scene_episodes_are_drawn() -> None:
    one, other = (
        {(seed, "park/00"): value for seed, value in enumerate(values)} for values in ((0.6, 0.2), (0.5, 0.5))
    )
    assert numbers(difference(one, other)) == pytest.approx([-0.1, -0.3, 0.1])


def test_the_interval_is_as_wide_as_the_formula_for_means_says() -> None:
    """Half a width of 1.96 s / sqrt(n), s being the standard deviation of the differences with 1 / n."""
    draw = np.random.default_rng(5)
    first, second = draw.normal(0.6, 0.2, 100), draw.normal(0.5, 0.2, 100)
    mean, low, high = numbers(difference(played(*first), played(*second)))
    half = 1.96 * float((first - second).std()) / math.sqrt(100)
    assert mean == pytest.approx(float((first - second).mean()))
    assert [low, high] == pytest.approx([mean - half, mean + half], abs=0.07 * half)


def test_about_95_of_100_intervals_hold_the_truth() -> None:
    """Differences of 0.1 +- 0.2 in 25 episodes.

    For so few episodes the formula 1.96 s / sqrt(n) holds the truth in 93.9 % (Student's t with 24 degrees of freedom,
    at 1.96 sqrt(24 / 25)); 300 trials are within 4 sigma = 5.6 % of that.
    """
    draw, held = np.random.default_rng(8), 0
    for _ in range(300):
        low, high = numbers(difference(played(*draw.normal(0.1, 0.2, 25)), played(*np.zeros(25))))[1:]
        held += low <= 0.1 <= high
    assert abs(held / 300 - 0.939) <= 0.056


def test_the_same_results_give_the_same_intervals() -> None:
    draw = np.random.default_rng(2)
    first, second = played(*draw.random(25)), played(*draw.random(25))
    assert difference(first, second) == difference(first, second) != difference(first, second, seed=1)
    assert difference(first, second, seed=1) == difference(dict(reversed(first.items())), second, seed=1)
