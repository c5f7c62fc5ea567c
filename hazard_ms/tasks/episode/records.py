"""Records of the damage that hazards have done, and of the things that were rescued."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.hazards.base import State, none_set, quantity
from hazard_ms.simulation.world import World


@dataclass
class Damage(State):
    """Things that any hazard ever damaged. Nothing heals, and what is safe can no longer be damaged."""

    damaged: Tensor = quantity("E B", "", "was damaged at some time", dtype="bool")
    frame: Tensor = quantity("E B", "frame", "when it was first damaged; -1: never", dtype="int", fill=-1, low=-1)

    def add(self, now: Tensor, world: World) -> None:
        """Record the things that a hazard is damaging `now`, bool [E, B]."""
        new = now & world.exists & ~world.safe & ~self.damaged
        if none_set(new):
            return
        self.damaged |= new
        self.frame.copy_(torch.where(new, world.frame[:, None], self.frame))


@dataclass
class Rescue(State):
    """Things that are safe, since when, and whether they were damaged by then. It alone decides `world.safe`."""

    safe: Tensor = quantity("E B", "", "rescued", dtype="bool")
    frame: Tensor = quantity("E B", "frame", "when it was rescued; -1: not yet", dtype="int", fill=-1, low=-1)
    damaged: Tensor = quantity("E B", "", "was damaged when it was rescued", dtype="bool")

    def mark(self, world: World, now: Tensor, damage: Damage) -> None:
        """Rescue the things of the mask `now`, bool [E, B], that are not rescued yet."""
        new = now & world.exists & ~self.safe
        if none_set(new):
            return
        self.safe |= new
        self.damaged |= new & damage.damaged
        self.frame.copy_(torch.where(new, world.frame[:, None], self.frame))
        world.safe |= new
