"""Measures how sharp the chances are that a detector itself gives, and how sure its looks at things and at clutter are.

The sharpness and the even share (`hazard_ms.sensing.detection.confusion`) are those of a grid by which the true
categories of what was found are likeliest.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.perception.calibration.observing import Observed, Told
from hazard_ms.sensing.detection.confusion import softened

SHARPNESS = (0.3, 0.5, 0.7, 0.85, 1.0, 1.25, 1.5, 2.0, 3.0)  # that are tried [ours]
EVEN = (0.01, 0.02, 0.05, 0.1, 0.2, 0.3)  # that are tried [ours]
SURER = (0.0, 0.35, 0.5, 0.65, 0.8)  # least of each bucket of the largest chance [ours]
DIGITS = 4  # of a share
ALIKE = 10.0  # looks as which the shares of all categories count in that of one [ours]


def worth(looks: Sequence[Observed], classes: Sequence[str]) -> dict[str, Any]:
    """The fields of a `Confusion` that tell of a detector's own chances; none where it tells no chances.

    Each share of looks is as after one more look in each bucket.
    """
    told = [(each, look.kinds.get(each.thing)) for look in looks for each in look.told if each.chances is not None]
    real = [(each, category) for each, category in told if category is not None]
    if not real:
        return {}
    chances = np.array([each.chances for each, _ in real])
    true = np.array([classes.index(category) for _, category in real])
    none = [each for each, category in told if category is None]
    false, names = _counts(none), sorted({each.category for each in none})
    sharpness, even = max(product(SHARPNESS, EVEN), key=lambda pair: _likelihood(chances, true, *pair))
    return {
        "sharpness": sharpness,
        "even": even,
        "surer": SURER,
        "real": _rounded(_counts([each for each, _ in real])),
        "false": _rounded(false),
        "false_of": {name: _rounded(near(_counts([e for e in none if e.category == name]), false)) for name in names},
    }


def _likelihood(chances: NDArray[np.float64], true: NDArray[np.int64], sharpness: float, even: float) -> float:
    """The mean logarithm of the chance of the `true` category, [N], by `chances`, [N, L]."""
    return float(np.log(softened(chances, sharpness, even)[np.arange(len(true)), true]).mean())


def near(own: NDArray[np.float64], every: NDArray[np.float64]) -> NDArray[np.float64]:
    """The counts of its `own`, [M], beside ALIKE more that are shared out as those of `every` category, [M]."""
    return own + ALIKE * every / every.sum()


def _counts(told: Sequence[Told]) -> NDArray[np.float64]:
    """One more than the number of detections in each bucket of SURER."""
    surest = [max(each.chances or (0.0,)) for each in told]
    return 1.0 + np.histogram(surest, (*SURER, np.inf))[0]


def _rounded(count: NDArray[np.float64]) -> tuple[float, ...]:
    """The share of each bucket."""
    return tuple(round(float(share), DIGITS) for share in count / count.sum())
