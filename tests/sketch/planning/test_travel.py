"""Walks to what rests and to what moves: never too early, never later for having left earlier."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import MovingTravel, StaticTravel, straight_line
from tests.worlds.rescue_plans import PER_METRE, random_problem

WALK = straight_line(PER_METRE)


def test_a_fleeing_target_is_met_when_the_walk_has_caught_up() -> None:
    """From 0, at 2 m and 0.008 m/frame: 246.03 frames, so the 247th, whether the spot is fixed or a target's own."""
    frames = np.arange(600.0)
    positions = np.stack([2 + 0.008 * frames, 0 * frames], axis=1)[..., None]  # the second target rests at the start
    travel = MovingTravel(frames, positions, [0.0], WALK)
    assert travel.meetings(travel.start, 0.0, [0, 1]) == [(247.0, (0, 247)), (0.0, (1, 0))]
    assert travel.meetings((1, 0), 0.0, [0]) == [(247.0, (0, 247))]


def test_an_approaching_target_is_waited_for_or_met_half_way() -> None:
    """It comes from 4 m at the speed of a walk: half the way each. From 3.9 m on it cannot be met earlier."""
    frames = np.arange(600.0)
    travel = MovingTravel(frames, (4 - np.minimum(frames, 240) / PER_METRE)[:, None, None], [0.0], WALK)
    assert travel.meetings(travel.start, 0.0, [0]) == [(124.0, (0, 124))]
    assert travel.meetings(travel.start, 100.0, [0])[0][0] == 174.0


def test_after_the_recording_targets_rest() -> None:
    travel = MovingTravel([0.0, 10.0], [[[3.0]], [[5.0]]], [0.0], WALK, [[1.0]])
    assert travel.meetings(travel.start, 0.0, [0]) == [(310.0, (0, 1))]
    assert travel.meetings((0, 1), 400.0, [0]) == [(400.0, (0, 1))]
    assert travel.to_carts((0, 1)) == [248.0]
    assert travel.to_carts(travel.start) == [62.0]


def test_whoever_leaves_later_never_meets_earlier() -> None:
    """10,000 random pairs of frames, from fixed places and from those of targets."""
    chance = np.random.default_rng(6)
    for _ in range(100):
        travel = random_problem(chance, True, 5, 2).travel()
        everything = range(travel.targets)
        for _ in range(100):
            node = int(chance.integers(travel.start[0] + 1))
            spot = (node, int(chance.integers(100)) if node < travel.targets else 0)
            early, late = np.sort(chance.uniform(0, 900, 2)).tolist()
            before, after = travel.meetings(spot, early, everything), travel.meetings(spot, late, everything)
            assert all(b[0] <= a[0] and b[0] >= early and a[0] >= late for b, a in zip(before, after, strict=True))


def test_the_least_walks_are_at_most_those_that_any_plan_takes() -> None:
    """They are compared with walks between all pairs of recorded frames in order of time."""
    chance, tight = np.random.default_rng(8), []
    for _ in range(40):
        plain = random_problem(chance, True, 4, 0)
        travel, places = plain.travel(), np.array(plain.positions)  # type: ignore[attr-defined]
        least = travel.least_entries()
        for target in range(travel.targets):
            ways = [WALK(np.array(plain.fixed[-1]), places[:, target]).min()]  # type: ignore[attr-defined]
            for other in set(range(travel.targets)) - {target}:
                pairs = WALK(places[:, None, other], places[None, :, target])
                ways.append(pairs[np.triu_indices(len(places))].min())
            assert least[target] <= min(ways) + 1e-9
            tight.append(least[target] / max(min(ways), 1e-9))
    assert np.mean(tight) > 0.7  # a bound of 0 would hold, too


def test_what_cannot_be_reached_is_left_until_it_can_be() -> None:
    """There is no way beyond 3 m; the target comes back from there at 200, and stays away in the second half."""

    def walk(start: NDArray, end: NDArray) -> NDArray:
        beyond = (start[..., 0] > 3) | (end[..., 0] > 3)
        return np.where(beyond, math.inf, WALK(start, end))

    frames = np.arange(500.0)
    positions = np.where((frames < 200) | (frames > 250), 4.0, 1.0)[:, None, None]
    travel = MovingTravel(frames, positions, [0.0], walk)
    assert travel.meetings(travel.start, 0.0, [0]) == [(200.0, (0, 200))]
    assert travel.meetings(travel.start, 189.0, [0])[0][0] == math.inf
    plan = solve(Problem(travel, [1], [math.inf], [10], [5], limit=400))
    assert (plan.value, plan.frame, plan.exact) == (1, 215, False)


def test_to_meet_early_is_known_to_be_best_where_walks_keep_up_and_detours_are_no_shorter() -> None:
    frames, one, two = [0.0, 50.0], [[[1.0], [2.0]]] * 2, [[[1.0], [2.0]], [[1.0], [2.8]]]

    def square(start: NDArray, end: NDArray) -> NDArray:
        """By way of the one in the middle it is less."""
        return 100 * ((end - start) ** 2).sum(axis=-1)

    def uphill(start: NDArray, end: NDArray) -> NDArray:
        return 62 * np.maximum(end - start, 0.5 * (start - end))[..., 0]

    assert MovingTravel(frames, one, [0.0], WALK).early_is_best
    assert MovingTravel(frames, two, [0.0], WALK).early_is_best  # 0.8 m are 49.6 frames
    assert not MovingTravel([0.0, 49.0], two, [0.0], WALK).early_is_best
    for walk in (square, uphill):
        travel = MovingTravel(frames, one, [0.0], walk)
        assert not travel.early_is_best and travel.least_entries().tolist() == [0.0, 0.0]
    plan = solve(Problem(travel, [1, 1], [math.inf] * 2, [0] * 2, [0] * 2, limit=100))
    assert (plan.value, plan.exact, plan.gap) == (1, False, 1)


@pytest.mark.parametrize(
    ("frames", "carts", "message"),
    [
        ([[0, 1]], 0, r"frames must have shape \(N, N\).*got \(1, 2\)"),
        ([], 0, r"frames must have shape .*got \(0,\)"),
        ([[0.0]], 1, r"frames must have shape \(N, N\) for targets, 1 carts and the start, got \(1, 1\)"),
        ([[0, -1], [1, 0]], 0, "frames must .* of at least 0, got -1.0"),
        ([[0, math.nan], [1, 0]], 0, "frames must .* of at least 0, got nan"),
    ],
)
def test_bad_tables_are_refused(frames: list, carts: int, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        StaticTravel(frames, carts)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"frames": [0.0, 0.0]}, "frames must be a list of increasing numbers"),
        ({"frames": [0.0, math.nan]}, "frames must be a list of increasing numbers"),
        ({"frames": []}, "frames must be a list of increasing numbers"),
        ({"frames": [0.0, math.inf]}, "frames must hold finite numbers, got inf"),
        ({"positions": [[1.0], [2.0]]}, r"positions must have shape \(2, M, D\), got \(2, 1\)"),
        ({"positions": [[[1.0]]]}, r"positions must have shape \(2, M, D\), got \(1, 1, 1\)"),
        ({"positions": [[[1.0]], [[math.nan]]]}, "positions must hold finite numbers, got nan"),
        ({"start": [0.0, 0.0]}, r"start must have shape \(1,\), got \(2,\)"),
        ({"carts": [[math.inf]]}, "start or carts must hold finite numbers, got inf"),
        ({"carts": [1.0, 2.0]}, r"carts must have shape \(C, 1\), got \(2,\)"),
        ({"walk": lambda a, b: (a - b)[..., 0]}, "walk must .* of at least 0, got -1.0"),
        ({"walk": lambda a, b: a - b}, r"walk must return frames of shape \(3, 3\) here, got \(3, 3, 1\)"),
    ],
)
def test_bad_recordings_are_refused(changes: dict, message: str) -> None:
    given = {"frames": [0.0, 1.0], "positions": [[[1.0]], [[2.0]]], "start": [0.0], "walk": WALK, **changes}
    with pytest.raises(ValueError, match=message):
        MovingTravel(**given)


def test_a_table_can_begin_elsewhere() -> None:
    """Ways between targets and carts stay; those from the start are the given ones."""
    table = StaticTravel(
        [[0.0, 10.0, 30.0, 9.0], [20.0, 0.0, 40.0, 9.0], [5.0, 6.0, 0.0, 9.0], [1.0, 2.0, 3.0, 0.0]], 1
    )
    moved = table.starting([70.0, 80.0, 90.0])
    assert [met for met, _ in moved.meetings(moved.start, 100.0, [0, 1])] == [170.0, 180.0]
    assert moved.to_carts(moved.start) == [90.0] and moved.to_carts((1, 0)) == [40.0]
    assert moved.least_entries().tolist() == [5.0, 6.0] and table.to_carts(table.start) == [3.0]
    with pytest.raises(ValueError, match=r"frames must have shape \(3,\), got \(2,\)"):
        table.starting([1.0, 2.0])
