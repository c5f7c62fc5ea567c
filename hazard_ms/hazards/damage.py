"""What hazards have done to things, and what was saved from them."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.hazards.base import State, nobody, quantity
from hazard_ms.world import World


@dataclass
class Damage(State):
    """Which things were ever damaged by any hazard; nothing heals, and what is safe is not damaged any more."""

    damaged: Tensor = quantity("E B", "", "was damaged at some time", dtype="bool")
    frame: Tensor = quantity("E B", "frame", "when it was first damaged; -1: never", dtype="int", fill=-1)

    def add(self, now: Tensor, world: World) -> None:
        """Note the things that a hazard is damaging `now`, [E, B], bool."""
        new = now & world.exists & ~world.safe & ~self.damaged
        if nobody(new):
            return
        self.damaged |= new
        self.frame.copy_(torch.where(new, world.frame[:, None], self.frame))


@dataclass
class Rescue(State):
    """Which things are safe, since when, and whether they were damaged by then. It alone decides `world.safe`."""

    safe: Tensor = quantity("E B", "", "rescued", dtype="bool")
    frame: Tensor = quantity("E B", "frame", "when it was rescued; -1: not yet", dtype="int", fill=-1)
    damaged: Tensor = quantity("E B", "", "was damaged when it was rescued", dtype="bool")

    def mark(self, world: World, now: Tensor, damage: Damage) -> None:
        """Rescue the things of the mask `now`, [E, B], that are not rescued yet."""
        new = now & world.exists & ~self.safe
        if nobody(new):
            return
        self.safe |= new
        self.damaged |= new & damage.damaged
        self.frame.copy_(torch.where(new, world.frame[:, None], self.frame))
        world.safe |= new
