"""A policy plays in the sketch: its features, its mask, and the option of the highest logit."""

from __future__ import annotations

import numpy as np
import torch

from hazard_ms.agents.learned.set_policy import SetPolicy, worthwhile
from hazard_ms.sketch.rescues.features import SketchEncoder
from hazard_ms.sketch.rescues.scene import Ints
from hazard_ms.sketch.world import Sketch


class Player:
    """Plays the options that a policy likes best."""

    def __init__(self, policy: SetPolicy) -> None:
        """Take a `policy`, which may go on learning."""
        self.policy, self.encoder = policy, SketchEncoder(policy.shape.ranges)

    def play(self, sketch: Sketch, chance: np.random.Generator) -> Ints:
        """The options that it chooses for all rescues, [N]; nothing is drawn."""
        del chance
        features = self.encoder.encode(sketch.stack, sketch.state, sketch.slots)
        chosen = self.policy.choose(torch.from_numpy(features), torch.from_numpy(worthwhile(sketch.mask)))
        return np.asarray(chosen.numpy(), np.int64)
