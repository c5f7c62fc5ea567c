"""Hundreds of rescues in the sketch as one vector environment of Stable-Baselines3, in one process.

The end of time is an end like others: the score is settled then, and policies see how much time is left. So nothing is
marked as truncated, which would have learners add what might have come after.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.learned.set_policy import worthwhile
from hazard_ms.learning.vector.stable_baselines import SB3VecEnv
from hazard_ms.sketch.environments.batch import SketchBatch
from hazard_ms.sketch.environments.choices import OPTIONS


class SketchVecEnv(SB3VecEnv):
    """The rescues of a `SketchBatch`. The option `stop` is offered only where there is nothing to go to."""

    def __init__(self, batch: SketchBatch, scale: float = 1.0) -> None:
        """Take a `batch` of N rescues; `scale`: factor on the rewards that learners get, but not on those in info."""

        def masks() -> NDArray[np.bool_]:
            made = batch.action_masks()
            return worthwhile(made) if batch.actions == OPTIONS else made

        super().__init__(batch, scale, bootstraps=False, masks=masks)
        self.batch = batch
