"""The base of the fires of all presets: what is damaged, and where flames are."""

from __future__ import annotations

from typing import ClassVar

import torch
from torch import Tensor

from hazard_ms.hazards.base import Flames, Hazard, Level
from hazard_ms.hazards.fire.declared import TEMPERATURE
from hazard_ms.hazards.fire.fire_state import BURNING, NORMAL, FireState, lit
from hazard_ms.simulation.world import World


class Burning(Hazard):
    """Base of fires, whose state is a FireState."""

    name: ClassVar[str] = "fire"
    level: ClassVar[Level] = TEMPERATURE
    uses: ClassVar[tuple[str, ...]] = ("water", "air")

    def damaged(self, state: FireState, world: World) -> Tensor:
        return state.status != NORMAL

    def flames(self, state: FireState, world: World) -> Flames:
        things = (state.status == BURNING) & world.exists & ~world.safe
        place = torch.cat([world.position, state.flame_place], 1)
        return Flames(place, torch.cat([things, lit(state, world.frame)], 1))
