"""Learns how looks at things differ from looks at what is taken for them, by logistic regression."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from hazard_ms.perception.calibration.observing import Observed, Told
from hazard_ms.sensing.detection.odds import OF_THING, length_of

FEWEST = 20  # looks at things and at clutter from which it is learned [ours]
RIDGE = 0.01  # by which the squares of the weights count [ours]
STEPS = 50  # of Newton's method, which needs about ten [ours]
DIGITS = 4  # of a weight
Shown = tuple[float, ...]


def odds_of(looks: Sequence[Observed]) -> dict[str, tuple[float, ...]]:
    """The weights by which `hazard_ms.sensing.detection.odds` tells things from clutter, by category.

    All that can be carried has the same ones. Empty where too few were found.
    """
    told = {each.category for look in looks for each in look.told if each.shown is not None}
    loose = {name for name in told if length_of(name) == OF_THING}
    made: dict[str, tuple[float, ...]] = {}
    for names in (loose, *({name} for name in sorted(told - loose))):
        real, clutter = _shown(looks, names)
        if min(len(real), len(clutter)) >= FEWEST:
            weights = _weights(np.array([*real, *clutter]), np.arange(len(real) + len(clutter)) < len(real))
            made |= dict.fromkeys(sorted(names), weights)
    return made


def _shown(looks: Sequence[Observed], names: Collection[str]) -> tuple[list[Shown], list[Shown]]:
    """What is shown of things, and of clutter, that are told as one of the categories `names`.

    Of a thing that is found in several parts the largest counts.
    """
    real, clutter = list[Shown](), list[Shown]()
    for look in looks:
        largest: dict[int, Told] = {}
        for told in look.told:
            if told.category not in names or told.shown is None:
                continue
            if not told.thing:
                clutter.append(told.shown)
            elif look.kinds[told.thing] in names:
                known = largest.get(told.thing, told)
                largest[told.thing] = max(known, told, key=lambda each: each.sighting.size)
        real += [told.shown for told in largest.values() if told.shown is not None]
    return real, clutter


def _weights(given: NDArray[np.float64], real: NDArray[np.bool_]) -> tuple[float, ...]:
    """The weights of a logistic regression, as if there had been as many looks at things as at clutter.

    `given`, [N, S]: what is shown in each look; `real`, [N]: whether it is of a thing.
    """
    middle, spread = given.mean(0), given.std(0)
    middle[0], spread[0] = 0.0, 1.0
    scaled, weights = (given - middle) / np.maximum(spread, 1e-9), np.zeros(given.shape[1])
    for _ in range(STEPS):
        chance = 1.0 / (1.0 + np.exp(-scaled @ weights))
        slope = scaled.T @ (real - chance) - RIDGE * weights
        bend = (scaled * (chance * (1.0 - chance))[:, None]).T @ scaled + RIDGE * np.eye(len(weights))
        weights = weights + np.linalg.solve(bend, slope)
    weights = weights / np.maximum(spread, 1e-9)
    weights[0] -= float(weights[1:] @ middle[1:]) + np.log(real.sum() / (~real).sum())
    return tuple(round(float(each), DIGITS) for each in weights)
