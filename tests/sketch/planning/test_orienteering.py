"""Plans are the best there are: worked examples, and every order tried on small problems."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.sketch.planning import orienteering
from hazard_ms.sketch.planning.bound import never_damaged, upper_bound
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import MovingTravel, StaticTravel, straight_line
from tests.worlds.rescue_plans import PER_METRE, Drift, best_by_trial, random_problem

# Whether targets move, and the most targets and carts
KINDS = {"bag": (False, 7, 0), "carts": (False, 5, 2), "moving bag": (True, 5, 0), "moving carts": (True, 4, 2)}
LONG_KINDS = {"more carts": (False, 7, 2), "longer moving bag": (True, 7, 0), "more moving carts": (True, 6, 3)}


def line(targets: list[float], carts: list[float], **rest: object) -> list[Problem]:
    """Things that rest on a line [m], with the start at 0: as a table, and as positions."""
    places = np.array([*targets, *carts, 0.0])
    table = StaticTravel(PER_METRE * np.abs(places[:, None] - places), len(carts))
    positions = np.array(targets)[None, :, None]
    moving = MovingTravel([0], positions, [0.0], straight_line(PER_METRE), np.array(carts)[:, None])
    return [Problem(travel, **rest) for travel in (table, moving)]  # type: ignore[arg-type]


def steps(problem: Problem) -> list[tuple[int, float, float]]:
    """Target, frame at which it is safe, and value that it adds."""
    return [(rescue.target, rescue.safe, rescue.value) for rescue in solve(problem).rescues]


def test_what_fits_into_the_time_is_rescued_and_else_what_is_worth_more() -> None:
    """1 m to either side: 62 + 50 frames to the first, 2 * 62 + 50 more to the other."""
    for problem in line([1, -1], [], values=[1, 5], damaged_at=[math.inf] * 2, pick=[50] * 2, drop=[0] * 2, limit=300):
        plan = solve(problem)
        assert (plan.value, plan.frame, plan.exact, plan.gap) == (6, 286, True, 0)
        assert steps(replace(problem, limit=286)) == steps(problem)
        assert steps(replace(problem, limit=280)) == [(1, 112, 5)]


def test_the_first_rescue_is_the_one_that_would_be_damaged() -> None:
    """A whole at 112 and B damaged at 348 is worth 7.5; B at 174 is late already, and A at 410, too: 5."""
    rest = {"values": [5, 5], "damaged_at": [150, 100], "pick": [50] * 2, "drop": [0] * 2, "limit": 500}
    for problem in line([1, -2], [], **rest):
        assert steps(problem) == [(0, 112, 5), (1, 348, 2.5)]
        assert steps(replace(problem, damaged_at=[112, 348])) == [(0, 112, 5), (1, 348, 5)]
        assert solve(replace(problem, damaged_at=[111.9, 348])).value == 7.5
        assert solve(replace(problem, damaged_share=0.2)).value == 6


def test_the_cart_is_chosen_for_the_way_that_follows() -> None:
    """Cart 0 is nearer to the first target, but from cart 1 it is not as far to the second: 310 frames, not 434."""
    rest = {"values": [1, 1], "damaged_at": [math.inf] * 2, "pick": [0] * 2, "drop": [0] * 2, "limit": 1000}
    for problem in line([1, 4], [0, 3], **rest):
        plan = solve(problem)
        assert [(rescue.target, rescue.met, rescue.safe, rescue.cart) for rescue in plan.rescues] == [
            (0, 62, 186, 1),
            (1, 248, 310, 1),
        ]
        assert plan.frame == 310


def test_what_is_in_the_hand_is_put_away_first() -> None:
    rest = {"values": [1, 5], "damaged_at": [math.inf] * 2, "pick": [10] * 2, "limit": 400, "frame": 100}
    for problem in line([2, 1], [], drop=[4, 4], holding=0, **rest):
        assert steps(problem) == [(0, 104, 1), (1, 104 + 62 + 10 + 4, 5)]
        assert solve(problem).rescues[0].met == 100
    for problem in line([2, 1], [-1], drop=[4], holding=0, **rest):
        assert steps(problem) == [(0, 100 + 62 + 4, 1)]
        assert steps(replace(problem, limit=428)) == [(0, 166, 1), (1, 166 + 124 + 10 + 124 + 4, 5)]
        assert steps(replace(problem, limit=165)) == []


def test_what_flees_faster_than_one_walks_is_left_alone() -> None:
    frames = np.arange(1501.0)
    for speed, safe in ((0.008, [247.0]), (0.0162, [])):  # 2 m / (1/62 - 0.008) m/frame = 246.03 frames
        travel = MovingTravel(frames, (2 + speed * frames)[:, None, None], [0.0], straight_line(PER_METRE))
        plan = solve(Problem(travel, [1], [math.inf], [0], [0], limit=1500))
        assert [rescue.safe for rescue in plan.rescues] == safe


@pytest.mark.parametrize("kind", [*KINDS, *(pytest.param(kind, marks=pytest.mark.long) for kind in LONG_KINDS)])
def test_no_order_is_better(kind: str) -> None:
    """A thousand small problems, about a fifth of which begin with something in the hand."""
    lengths = []
    for seed in range(1000):
        plain = random_problem(np.random.default_rng([seed, *map(ord, kind)]), *(KINDS | LONG_KINDS)[kind])
        problem = plain.problem()
        plan = solve(problem)
        assert (plan.value, plan.frame) == pytest.approx(best_by_trial(plain), abs=1e-6), seed
        assert plan.exact == problem.travel.early_is_best and (plan.gap == 0 or not plan.exact), seed
        assert plan.value <= upper_bound(problem) + 1e-9 <= upper_bound(never_damaged(problem)) + 2e-9, seed
        assert sum(rescue.value for rescue in plan.rescues) == pytest.approx(plan.value), seed
        lengths.append(len(plan.rescues))
    assert max(lengths) >= 3


def test_no_waiting_is_better_unless_a_target_can_outrun_the_walk() -> None:
    """Small problems in which every recorded frame is tried for every meeting."""
    proven = 0
    for seed in range(400):
        plain = random_problem(np.random.default_rng(seed), True, 3, seed % 2, stride=75)
        plan, best = solve(plain.problem()), best_by_trial(plain, waiting=True)
        if plan.exact:
            assert (plan.value, plan.frame) == pytest.approx(best, abs=1e-6), seed
        assert plan.value <= best[0] + 1e-9 and best[0] <= plan.value + plan.gap + 1e-9, seed
        proven += plan.exact
    assert proven >= 100


def test_where_waiting_can_be_better_no_plan_counts_as_exact() -> None:
    """A target comes by at 0.05 m/frame and rests 5 m ahead, at the cart.

    Met at -0.2 m in frame 16, it is in the cart 5.2 m or 322 frames later; awaited there, in frame 310.
    """
    frames = np.arange(400.0)
    positions = np.stack([np.minimum(0.05 * frames - 1, 5), 0 * frames], axis=1)[:, None]
    common = ([5.0], [320.0], [0.0], [0.0], 1000.0, 1, None, frames.tolist(), positions.tolist())
    plain = Drift(*common, fixed=[[5.0, 0.0], [0.0, 0.0]])
    plan = solve(plain.problem())
    assert (plan.value, plan.exact, plan.gap) == (2.5, False, 2.5)
    assert plan.frame == pytest.approx(16 + 5.2 * PER_METRE)
    assert best_by_trial(plain, waiting=True) == (5, 310)


def test_a_search_that_is_cut_short_says_how_much_it_may_have_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first beam of 30 finds the best plan of nearly all problems as small as these, so it is narrowed, too."""
    monkeypatch.setattr(orienteering, "FIRST_BEAM", 1)
    missed = cut = 0
    for seed in range(300):
        plain = random_problem(np.random.default_rng(seed), False, 7, 0)
        best, _ = best_by_trial(plain)
        plan = solve(plain.problem(), most_labels=1, beam=1)
        assert plan.value <= best + 1e-9 and best <= plan.value + plan.gap + 1e-9, seed
        assert plan.gap == 0 or not plan.exact, seed
        missed += plan.value < best - 1e-9
        cut += not plan.exact
    assert cut > missed > 0


def test_problems_of_the_size_of_scenes_are_solved_exactly(capsys: pytest.CaptureFixture[str]) -> None:
    """14 targets in a room of 6 m, 94 frames to pick up, 1,500 frames in all; 43 % are damaged at some time."""
    labels, spent = [], 0.0
    for seed in range(10):
        chance = np.random.default_rng(seed)
        places = chance.uniform(0, 6, (15, 2))
        damaged_at = np.where(chance.random(14) < 0.43, chance.uniform(100, 1500, 14), math.inf)
        travel = StaticTravel(PER_METRE * np.linalg.norm(places[:, None] - places, axis=-1))
        scene = Problem(travel, chance.choice([1.0, 5.0], 14), damaged_at, [94] * 14, [4] * 14, limit=1500)
        start = time.process_time()
        plan = solve(scene)
        spent += time.process_time() - start
        assert plan.exact and 4 <= len(plan.rescues) <= 12
        labels.append(plan.labels)
    assert max(labels) < 30_000  # without the optimistic bound there are a hundred times as many
    with capsys.disabled():
        print(f" [14 targets: {spent / 10:.3f} s of processor time, {np.mean(labels):.0f} labels]", end="")


def test_plans_are_the_same_every_time() -> None:
    plain = random_problem(np.random.default_rng(3), True, 7, 0)
    assert solve(plain.problem()) == solve(plain.problem())


def test_where_there_is_nothing_to_rescue_the_plan_is_empty() -> None:
    plan = solve(Problem(StaticTravel([[0]]), [], [], [], [], limit=100, frame=7))
    assert (plan.rescues, plan.value, plan.frame, plan.exact) == ((), 0, 7, True)
    shut_in = StaticTravel([[0, 0], [math.inf, 0]])
    assert solve(Problem(shut_in, [1], [math.inf], [1], [1], limit=100)).rescues == ()


def problem(**changes: object) -> Problem:
    """Two targets and a start, 10 frames apart."""
    rest: dict = {"values": [1, 5], "damaged_at": [50, math.inf], "pick": [1, 1], "drop": [2, 2], "limit": 100}
    return Problem(StaticTravel(10 * (1 - np.eye(3))), **{**rest, **changes})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"values": [1]}, r"values must have shape \(2,\), got \(1,\)"),
        ({"values": [1, -5]}, "values must .* of at least 0, got -5.0"),
        ({"values": [1, math.nan]}, "values must .* of at least 0, got nan"),
        ({"damaged_at": [math.nan, 1]}, "damaged_at must .* got nan"),
        ({"pick": [1, math.inf]}, "pick must hold finite numbers, got inf"),
        ({"drop": [1, 2, 3]}, r"drop must have shape \(2,\), got \(3,\)"),
        ({"limit": math.inf}, "limit must be a frame of at least 0, got inf"),
        ({"limit": math.nan}, "limit must be a frame of at least 0, got nan"),
        ({"frame": -1}, "frame must be a frame of at least 0, got -1"),
        ({"damaged_share": 1.5}, "damaged_share must be from 0 to 1, got 1.5"),
        ({"holding": 2}, "holding must be None or a target from 0 to 1, got 2"),
    ],
)
def test_bad_problems_are_refused(changes: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        problem(**changes)


def test_bad_sizes_of_a_search_are_refused() -> None:
    with pytest.raises(ValueError, match="most_labels must be at least 1, got 0"):
        solve(problem(), most_labels=0)
    with pytest.raises(ValueError, match="beam must be at least 1, got 0"):
        solve(problem(), beam=0)
