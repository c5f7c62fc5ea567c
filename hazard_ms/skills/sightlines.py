"""Whether walls stand between places, as far as a map of heights shows them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

TALL = 1.4  # height of what no arm reaches over from a base that stands behind it [m] [ours]
# depth up to which an arm reaches into something tall, such as a shelf, to what stands in it [m] [ours: half of a shelf
# of 0.42 m and a cell of a map, both ways]; what is farther in it stands behind its end, or behind the wall at its back
WITHIN = 0.35


def behind(
    height: NDArray[np.floating],
    cell: float,
    origin: NDArray[np.floating],
    places: NDArray[np.float64],
    goal: tuple[float, float] | NDArray[np.floating],
) -> NDArray[np.bool_]:
    """Whether something TALL stands between each of `places` [m], [P, 2], and what is at `goal` [m], [2]: [P], bool.

    `height` [Y, X] [m], `cell` [m] and `origin` [m] are those of a map. What lies in something TALL itself, as in a
    shelf, is not behind the part of it WITHIN reach of what is free.
    """
    goal = np.asarray(goal[:2], dtype=np.float64)
    steps = int(np.ceil(2.0 * np.hypot(*(places - goal).T).max(initial=0.0) / cell)) + 1
    along = goal + np.linspace(0.0, 1.0, steps)[:, None, None] * (places - goal)  # [steps, P, 2]
    x, y = np.moveaxis(np.floor((along - origin) / cell).astype(int), -1, 0)
    inside = (x >= 0) & (y >= 0) & (x < height.shape[1]) & (y < height.shape[0])
    tall = np.zeros(inside.shape, bool)
    tall[inside] = height[y[inside], x[inside]] > TALL
    hidden = tall.copy()
    if tall[:1].any():  # the goal lies in something tall: what is of one piece with it, not too deep, does not count
        away = np.linspace(0.0, 1.0, steps)[:, None] * np.hypot(*(places - goal).T)
        hidden &= ~np.logical_and.accumulate(tall, axis=0) | (away > WITHIN)
    return np.asarray(hidden.any(axis=0))
