"""The aims of a judge of decisions: the score Value or, in homes, what is not lost when time is up.

By the aim `averted` a target that is safe counts as by Value, and every other one what it keeps by itself: all of its
value, half where it is damaged, and nothing where it is carried off. A rescue then adds what would be lost without it
(`hazard_ms.sketch.planning.averting`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.planning.averting import averting
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.rescue_problem import RescueScene
from hazard_ms.sketch.timeline import Timeline
from hazard_ms.spec.catalogue import DAMAGED_SHARE

LITTLE = 1e-6  # share of its Value that a rescue counts beside what it averts: of equal plans the richer one [ours]


@dataclass(frozen=True)
class Aim:
    """The score Value; with `averts` what is not lost when time is up, where things may be `carried_off`."""

    averts: bool = False
    carried_off: bool = False

    def of(self, problem: Problem) -> Problem:
        """The problem whose values are what rescues add by this aim."""
        return averting(problem, LITTLE) if self.averts else problem

    def kept(
        self,
        targets: NDArray[np.int64],
        values: NDArray[np.float64],
        future: Timeline,
        scene: RescueScene,
        held: int | None,
    ) -> NDArray[np.float64]:
        """The value that `targets`, indices [T] along B, worth `values` [T], count if nobody rescues them, [T].

        `held`: index along B of what is in the hand, which nothing carries off.
        """
        if not self.averts:
            return np.zeros(len(targets))
        share = np.where(future.whole_until()[targets] < scene.limit, DAMAGED_SHARE, 1.0)
        if self.carried_off:
            gone = (scene.gone_at(future, targets) < scene.limit) & (targets != (-1 if held is None else held))
            share = np.where(gone, 0.0, share)
        return np.asarray(values * share)


VALUE = Aim()
