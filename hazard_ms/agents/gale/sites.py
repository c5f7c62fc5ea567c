"""The lee as a place to rescue things to: sites on the ground beside the carts of a rescue's problem."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.planning.travel import Spot, Travel

Array = NDArray[np.float64]
DETOUR = 1.1  # length of ways in the open over that of straight lines [ours: as for all planning in the open]
NEAREST = 2  # sites of each target, each of them at least APART from the others [ours]
APART = 1.5  # [m] [ours]


class Sites(NamedTuple):
    """S places on the ground [m], [S, 2], and which of them keep each of M targets until the end, bool [M, S]."""

    places: Array
    keep: NDArray[np.bool_]


def sites(points: Array, good: NDArray[np.bool_], goals: Array) -> Sites:
    """The `points` [m], [P, 2], nearest to `goals` [m], [M, 2], of those that are `good` for each target, bool [M, P].

    One that is chosen for a target serves all others that it is good for.
    """
    chosen: list[int] = []
    for goal, fine in zip(goals, good, strict=True):
        left = np.hypot(*(points - goal).T)
        left[~fine] = np.inf
        for _ in range(NEAREST):
            if not np.isfinite(left).any():
                break
            best = int(left.argmin())
            if all(np.hypot(*(points[best] - points[other])) >= APART or not fine[other] for other in chosen):
                chosen.append(best)
            left[np.hypot(*(points - points[best]).T) < APART] = np.inf
    return Sites(points[chosen].reshape(-1, 2), good[:, chosen])


class OnGround(Travel):
    """Another travel whose last carts are sites, each for some of the targets alone."""

    def __init__(self, base: Travel, keep: NDArray[np.bool_], holding: int | None) -> None:
        """`keep`: which of the last S carts of `base` each target may be brought to, [M, S]; `holding`: see Problem."""
        super().__init__(base.targets, base.carts, base.early_is_best)
        always = np.ones((base.targets, base.carts - keep.shape[1]), bool)
        self._base, self._holding = base, holding
        self._extra = np.where(np.hstack([always, keep]), 0.0, np.inf)  # [M, C]
        self._rows = self._extra.tolist()

    def meetings(self, spot: Spot, frame: float, targets: Sequence[int]) -> list[tuple[float, Spot]]:
        """The earliest frame at which each of `targets` can be met after `frame`, and where; inf for never."""
        return self._base.meetings(spot, frame, targets)

    def to_carts(self, spot: Spot) -> list[float]:
        """Frames from a spot to each cart and site, [C]; inf where the target there may not be brought."""
        frames, target = self._base.to_carts(spot), spot[0] if spot[0] < self.targets else self._holding
        return frames if target is None else [a + b for a, b in zip(frames, self._rows[target], strict=True)]

    def least_entries(self) -> Array:
        """Least frames of the walk to each target from wherever the rescue before it can end, [M]."""
        return self._base.least_entries()

    def least_exits(self) -> Array:
        """Least frames of the walk from each target to each cart and site, [M, C]."""
        return np.asarray(self._base.least_exits() + self._extra)
