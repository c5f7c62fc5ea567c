"""The aim `averted` of a problem: what would be lost by its limit if nobody rescued it counts, and little else.

At the limit, a target that nobody rescued has lost all of its value if a hazard has carried it off
(`Problem.gone_at`), `1 - damaged_share` of it if it is damaged, and nothing otherwise (docs/benchmark.md 4.3). What is
rescued has lost only what its damage took before. So a rescue counts the share that would be lost without it, less that
of damage done before; what stays whole where it is counts without a rescue. Beside that a rescue counts a small share
of what it counts by the score Value, so that of plans that avert the same the one of the higher Value is the best.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.planning.problem import Problem

BESIDE = 0.1  # share of its Value that a rescue counts beside what it averts [ours]


def averting(problem: Problem, beside: float = BESIDE) -> Problem:
    """The same problem with values, [M], by the aim `averted`: `kept` is what plans avert without any rescue.

    `beside`: share of its Value that a rescue counts besides. Raises ValueError unless it is above 0 and at most 1.
    """
    if not 0.0 < beside <= 1.0:
        raise ValueError(f"beside must be above 0 and at most 1, got {beside}")
    lost, late = _lost(problem), 1.0 - problem.damaged_share
    counts = lost + beside
    shares = (np.maximum(lost - late, 0.0) + beside * problem.damaged_share) / counts
    return replace(problem, values=(np.array(problem.values) * counts).tolist(), shares=shares.tolist())


def kept(problem: Problem) -> float:
    """The part of the targets' values that is not lost by the limit although nobody rescues them.

    `problem` has the targets' own values, not those that `averting` gives.
    """
    return float(np.array(problem.values) @ (1.0 - _lost(problem)))


def _lost(problem: Problem) -> NDArray[np.float64]:
    """The share of its value that each target has lost by the limit if nobody rescues it, [M]."""
    damaged = np.where(np.array(problem.damaged_at) < problem.limit, 1.0 - problem.damaged_share, 0.0)
    return damaged if problem.gone_at is None else np.where(np.array(problem.gone_at) < problem.limit, 1.0, damaged)
