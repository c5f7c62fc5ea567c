"""How much likelier a look is at a thing than at what only looks like it: parts of hedges and cars are taken for carts.

The logarithm of these odds is linear in what a look shows of it: how sure the detector is, how many pixels there are,
and how many there would be 1 m before the middle of the picture, which is how large it is.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from hazard_ms.spec.foreign.plain import Within

SHOWN = 5  # numbers that `shown` tells
LEAST = 1e-3  # no chance counts as smaller, nor as larger than 1 less this [ours]
FARTHEST = 7.0  # most that a look changes the logarithm of the odds [ours]
Weights = Annotated[tuple[Annotated[float, Within(-1e3, 1e3)], ...], Within(SHOWN, SHOWN)]


def shown(chance: float, pixels: float, size: float) -> NDArray[np.float64]:
    """What counts of a look, [SHOWN]: 1, the log-odds of the largest `chance` that the detector gives, and octaves.

    Those of its `pixels`, of the `size`, its pixels 1 m before the middle of the picture, and these once more, squared.
    """
    chance = min(max(chance, LEAST), 1.0 - LEAST)
    large = math.log2(max(size, 1.0))
    return np.array([1.0, math.log(chance / (1.0 - chance)), math.log2(max(pixels, 1.0)), large, large**2])


def odds(weights: Weights, chance: float, pixels: float, size: float) -> float:
    """How many times as likely a look with this is at a thing as at clutter, by the `weights` of its category."""
    return math.exp(min(max(float(shown(chance, pixels, size) @ np.array(weights)), -FARTHEST), FARTHEST))
