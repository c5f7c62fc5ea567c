"""The aim `averted`: what is lost at the end by the score's own rule, for every order of rescues."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from hazard_ms.evaluation.averted.loss import Loss
from hazard_ms.sketch.planning.averting import averting, kept
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel


def small(seed: int) -> Problem:
    """Five targets, about half of which are damaged by the limit."""
    draw = np.random.default_rng(seed)
    damaged = np.where(draw.random(5) < 0.3, np.inf, draw.uniform(50, 1500, 5))
    travel = StaticTravel(draw.uniform(20, 200, (6, 6)))
    gone = np.where(draw.random(5) < 0.7, np.inf, draw.uniform(50, 800, 5)).tolist() if seed % 2 else None
    return Problem(
        travel, draw.choice([1.0, 5.0, 20.0], 5).tolist(), damaged.tolist(), [60.0] * 5, [4.0] * 5, 500.0, gone_at=gone
    )


def score(problem: Problem, order: tuple[int, ...]) -> float | None:
    """What the rescues of an order avert, with 0.1 of their Value; None where they do not end by the limit."""
    values, frame, here, rows = np.array(problem.values), 0.0, problem.travel.start, []
    safe_at = np.full(5, np.inf)
    for target in order:
        ((met, here),) = problem.travel.meetings(here, frame, [target])
        frame = safe_at[target] = met + 64.0
    if frame > problem.limit:
        return None
    damaged = np.minimum(safe_at, problem.limit) > np.array(problem.damaged_at)
    gone = np.zeros(5, bool) if problem.gone_at is None else np.array(problem.gone_at) < problem.limit
    loss = Loss.of(values, np.ones(5, bool), gone & ~np.isfinite(safe_at), damaged)
    rows = [values[t] * (0.5 if damaged[t] else 1.0) for t in order]
    return values.sum() - loss.targets + 0.1 * sum(rows)


@pytest.mark.parametrize("seed", range(6))
def test_the_best_plan_is_the_one_with_the_least_loss_at_the_end(seed: int) -> None:
    problem = small(seed)
    scores = [s for n in range(6) for order in permutations(range(5), n) if (s := score(problem, order)) is not None]
    assert solve(averting(problem)).value + kept(problem) == pytest.approx(max(scores))


def test_what_is_never_damaged_is_kept_and_hardly_counts_as_a_rescue() -> None:
    """Of two targets of value 8, one is damaged at 150: it keeps 4, and counts 4.8 in time, else 0.4; the other 0.8."""
    travel = StaticTravel(np.full((3, 3), 40.0))
    problem = Problem(travel, [8.0, 8.0], [149.0, np.inf], [50.0] * 2, [4.0] * 2, 1000.0)
    aimed = averting(problem)
    assert kept(problem) == 4.0 + 8.0
    assert [aimed.worth(0, 149.0), aimed.worth(0, 151.0), aimed.worth(1, 900.0)] == pytest.approx([4.8, 0.4, 0.8])
    assert [rescue.target for rescue in solve(aimed).rescues] == [0, 1]


def test_what_is_carried_off_counts_whole_even_damaged() -> None:
    """Value 8, gone at 300, damaged at 150: 8.8 in time, 4.4 later; what is gone after the limit is kept."""
    travel = StaticTravel(np.full((3, 3), 40.0))
    problem = Problem(travel, [8.0] * 2, [149.0, np.inf], [50.0] * 2, [4.0] * 2, 1000.0, gone_at=[299.0, 1000.0])
    aimed = averting(problem)
    assert kept(problem) == 8.0
    assert [aimed.worth(0, 149.0), aimed.worth(0, 151.0), aimed.worth(1, 900.0)] == pytest.approx([8.8, 4.4, 0.8])


@pytest.mark.parametrize("beside", [0.0, -0.1, 1.1])
def test_impossible_shares_are_refused(beside: float) -> None:
    with pytest.raises(ValueError, match="beside must be above 0 and at most 1"):
        averting(small(0), beside)
