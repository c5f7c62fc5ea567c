"""Comparisons of agents on the episodes that they have in common, each with a bootstrap interval over scenes.

    difference = mean over episodes of  Value of one agent - Value of the other
    regret     = 1 - sum over episodes of the Value of the agent / the same sum of the oracle

A scene is drawn with all of its episodes and the Values of both agents in them, so that how hard scenes are cancels
out (hazard_ms.evaluation.metrics).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hazard_ms.evaluation.metrics import Score, interval, resampled

Episode = tuple[int, str]  # seed and scene


def difference(one: Mapping[Episode, float], other: Mapping[Episode, float], seed: int = 0) -> Score:
    """The mean Value by which `one` is above `other`, -1 to 1, on common episodes; `seed` is that of the bootstrap."""
    values, scenes = _common(one, other)
    if not scenes:
        return Score(None, None, None)
    apart = values[:, 0] - values[:, 1]
    total, count = resampled(np.stack([apart, np.ones_like(apart)], axis=-1), scenes, seed).T
    return interval(float(apart.mean()), total / count)


def regret(own: Mapping[Episode, float], oracle: Mapping[Episode, float], seed: int = 0) -> Score:
    """The share of the Value of `oracle` that is missing in `own`, on common episodes; `seed`: of the bootstrap.

    It is undefined where the oracle rescued nothing.
    """
    values, scenes = _common(own, oracle)
    if not values[:, 1].any():
        return Score(None, None, None)
    saved, best = resampled(values, scenes, seed).T
    shares = np.divide(saved, best, out=np.full(len(best), np.nan), where=best > 0)
    return interval(float(1.0 - values[:, 0].sum() / values[:, 1].sum()), 1.0 - shares)


def _common(one: Mapping[Episode, float], other: Mapping[Episode, float]) -> tuple[NDArray[np.float64], list[str]]:
    """The Values of both on the episodes that both played, [N, 2], and the scenes of these, [N]."""
    both = sorted(set(one) & set(other))
    return np.array([(one[e], other[e]) for e in both], np.float64).reshape(-1, 2), [scene for _, scene in both]
