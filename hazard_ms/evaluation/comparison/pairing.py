"""Comparisons of agents on the episodes that they have in common, each with a bootstrap interval over episodes.

    difference = mean over episodes of  Value of one agent - Value of the other
    regret     = 1 - sum over episodes of the Value of the agent / the same sum of the oracle

An episode is drawn with the Values of both agents, so that the difficulty of scenes cancels out.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hazard_ms.evaluation.metrics import RESAMPLES, Score, interval

Episode = tuple[int, str]  # seed and scene


def difference(one: Mapping[Episode, float], other: Mapping[Episode, float], seed: int = 0) -> Score:
    """The mean Value by which `one` is above `other`, -1 to 1, on common episodes; `seed` is that of the bootstrap."""
    first, second = _common(one, other)
    if not len(first):
        return Score(None, None, None)
    apart = first - second
    return interval(float(apart.mean()), apart[_resamples(len(apart), seed)].mean(1))


def regret(own: Mapping[Episode, float], oracle: Mapping[Episode, float], seed: int = 0) -> Score:
    """The share of the Value of `oracle` that is missing in `own`, on common episodes; `seed`: of the bootstrap.

    It is undefined where the oracle rescued nothing.
    """
    first, second = _common(own, oracle)
    if not second.any():
        return Score(None, None, None)
    drawn = _resamples(len(first), seed)
    best = second[drawn].sum(1)
    shares = np.divide(first[drawn].sum(1), best, out=np.full(len(best), np.nan), where=best > 0)
    return interval(float(1.0 - first.sum() / second.sum()), 1.0 - shares)


def _common(
    one: Mapping[Episode, float], other: Mapping[Episode, float]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The Values of both on the episodes that both played, [N] each."""
    both = sorted(set(one) & set(other))
    return np.array([one[e] for e in both], np.float64), np.array([other[e] for e in both], np.float64)


def _resamples(count: int, seed: int) -> NDArray[np.int64]:
    """Numbers of the episodes in each resample, [R, N]."""
    return np.random.default_rng(seed).integers(count, size=(RESAMPLES, count))
