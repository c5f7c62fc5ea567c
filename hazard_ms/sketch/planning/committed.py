"""The best plan that begins with a given rescue: what a choice is worth if the agent goes through with it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import Spot, Travel


def committed(problem: Problem, target: int, cart: int | None, most_labels: int, beam: int) -> float:
    """The value of the best plan whose first rescue is `target`; 0 where that cannot be safe in time.

    What is in the hand must be that target. `cart`: the one that it is put into, any if None; `most_labels` and `beam`
    are those of `solve`. Raises ValueError for another target than the one in the hand.
    """
    travel = problem.travel
    if problem.holding is None:
        ((met, spot),) = travel.meetings(travel.start, problem.frame, [target])
        ready = met + problem.pick[target]
    elif problem.holding == target:
        spot, ready = travel.start, problem.frame
    else:
        raise ValueError(f"target must be the one in the hand, {problem.holding}, got {target}")
    values = [0.0 if other == target else value for other, value in enumerate(problem.values)]
    best = 0.0
    for safe, after, used in problem.stows(target, spot, ready):
        if safe <= problem.limit and cart in (None, used):
            left = replace(problem, travel=_Onward(travel, after), values=values, frame=safe, holding=None)
            best = max(best, problem.worth(target, safe) + solve(left, most_labels, beam).value)
    return best


class _Onward(Travel):
    """The travel of a problem from another spot than its start."""

    def __init__(self, travel: Travel, spot: Spot) -> None:
        super().__init__(travel.targets, travel.carts, travel.early_is_best)
        self._travel, self._spot = travel, spot

    def _real(self, spot: Spot) -> Spot:
        return self._spot if spot == self.start else spot

    def meetings(self, spot: Spot, frame: float, targets: Sequence[int]) -> list[tuple[float, Spot]]:
        """See `Travel.meetings`."""
        return self._travel.meetings(self._real(spot), frame, targets)

    def to_carts(self, spot: Spot) -> list[float]:
        """See `Travel.to_carts`."""
        return self._travel.to_carts(self._real(spot))

    def least_entries(self) -> NDArray[np.float64]:
        """See `Travel.least_entries`."""
        return self._travel.least_entries()

    def least_exits(self) -> NDArray[np.float64]:
        """See `Travel.least_exits`."""
        return self._travel.least_exits()
