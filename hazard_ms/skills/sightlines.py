"""Whether walls stand between places, as far as a map of heights shows them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

TALL = 1.4  # height of what no arm reaches over from a base that stands behind it [m] [ours]


def behind(
    height: NDArray[np.floating],
    cell: float,
    origin: NDArray[np.floating],
    places: NDArray[np.float64],
    goal: tuple[float, float] | NDArray[np.floating],
) -> NDArray[np.bool_]:
    """Whether something TALL stands between each of `places` [m], [P, 2], and what is at `goal` [m], [2]: [P], bool.

    `height` [Y, X] [m], `cell` [m] and `origin` [m] are those of a map. Not so for what lies in something TALL itself,
    as in a shelf.
    """
    goal = np.asarray(goal[:2], dtype=np.float64)
    steps = int(np.ceil(2.0 * np.hypot(*(places - goal).T).max(initial=0.0) / cell)) + 1
    along = goal + np.linspace(0.0, 1.0, steps)[:, None, None] * (places - goal)  # [steps, P, 2]
    x, y = np.moveaxis(np.floor((along - origin) / cell).astype(int), -1, 0)
    inside = (x >= 0) & (y >= 0) & (x < height.shape[1]) & (y < height.shape[0])
    tall = np.zeros(inside.shape, bool)
    tall[inside] = height[y[inside], x[inside]] > TALL
    return np.asarray(tall.any(axis=0) & ~tall[0])
