"""The aim `averted` of a problem: what would be lost by its limit if nobody rescued it counts, and little else.

At the limit, a target has lost `1 - damaged_share` of its value if it was damaged before it was safe, and nothing
otherwise (docs/benchmark.md 4.3). So a rescue in time counts this share where the target would be damaged by the limit,
and a target that stays whole counts it without a rescue. Beside that a rescue counts a small share of what it counts by
the score Value, so that of plans that avert the same the one of the higher Value is the best.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hazard_ms.planning.problem import Problem

BESIDE = 0.1  # share of its Value that a rescue counts beside what it averts [ours]


def averting(problem: Problem, beside: float = BESIDE) -> Problem:
    """The same problem with values, [M], by the aim `averted`: `kept` is what plans avert without any rescue.

    `beside`: share of its Value that a rescue counts besides. Raises ValueError unless it is above 0 and at most 1.
    """
    if not 0.0 < beside <= 1.0:
        raise ValueError(f"beside must be above 0 and at most 1, got {beside}")
    loss = 1.0 - problem.damaged_share
    values = np.array(problem.values) * np.where(_at_risk(problem), loss + beside, beside)
    share = beside * problem.damaged_share / (loss + beside)
    return replace(problem, values=values.tolist(), damaged_share=share)


def kept(problem: Problem) -> float:
    """The part of the targets' values that is not lost by the limit although nobody rescues them.

    `problem` has the targets' own values, not those that `averting` gives.
    """
    return float(np.array(problem.values)[~_at_risk(problem)].sum()) * (1.0 - problem.damaged_share)


def _at_risk(problem: Problem) -> np.ndarray:
    """Whether each target is damaged by the limit if nobody rescues it, bool [M]."""
    return np.array(problem.damaged_at) < problem.limit
