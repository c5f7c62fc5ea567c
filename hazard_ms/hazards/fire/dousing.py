"""Extinguishers on a fire of the paper: flames under a jet shrink, step by step, as they grew (torch).

A flame that is as large as it gets goes out within FRAMES under any extinguisher's jet. On the floor it does not come
back. A thing is no longer on fire then, and no hotter than boiling water, so it burns again only once it has been
heated up anew: it is safe for a time, and damaged as before [ours: the paper has no extinguishers, and asks for them].
"""

from __future__ import annotations

import torch

from hazard_ms.hazards.base import none_set
from hazard_ms.hazards.fire import spread
from hazard_ms.hazards.fire.fire_state import ALL_USED, BURNING, NORMAL, FireState, lit
from hazard_ms.simulation.jet import spray
from hazard_ms.simulation.world import World

FRAMES = 35  # frames in which the largest flame goes out: 1.2 s [ours]
GROWN = spread.EVERY * spread.GROWTH_STEPS  # age from which a flame is as large as it gets [frames]
UPDATES = 28  # the same of flames on things [updates of heat, of 5 frames]
STEAM = 100.0  # hottest that a thing is under a jet: boiling water [C]
NEVER = 2**40  # birth of a flame that has gone out [frame]


def douse(state: FireState, world: World) -> None:
    """Shrink what the jets reach by one frame's worth, and put out what is gone. Does nothing without extinguishers."""
    flowing = [jet for jet in world.jets if not none_set(jet.flowing)]
    if not flowing:
        return
    things, points = world.num_bodies, torch.cat([world.position, state.flame_place], 1)
    hit = torch.stack([spray(jet, world.walls, points) > 0 for jet in flowing]).any(0)
    burns, on_floor = hit[:, :things] & world.exists & ~world.safe, hit[:, things:] & lit(state, world.frame)
    frame = world.frame[:, None]
    birth = torch.maximum(state.flame_birth, frame - GROWN) + 1 + GROWN // FRAMES
    out = on_floor & (birth > frame)
    state.flame_birth.copy_(torch.where(on_floor, torch.where(out, NEVER, birth), state.flame_birth))
    state.flame_used.masked_fill_(out, ALL_USED)
    left = state.burn_updates.clamp(max=UPDATES) - 1
    burning = burns & (state.status == BURNING)
    state.status.masked_fill_(burning & (left < 0), NORMAL)
    state.burn_updates.copy_(torch.where(burning, left.clamp(min=0), state.burn_updates))
    cooled = burns & (state.status == NORMAL)
    state.temperature.copy_(torch.where(cooled, state.temperature.clamp(max=STEAM), state.temperature))
