"""The front of a realistic fire on the floor: burning cells light their neighbours (torch)."""

from __future__ import annotations

import torch

from hazard_ms.hazards.base import none_set
from hazard_ms.hazards.fire import coupling, spread
from hazard_ms.hazards.fire.fire import can_burn, enlisted, light, lit
from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.simulation.world import World

# Mean time that a front takes per cell, in units of 1 / rate, over ten cells; 0.41 far out [ours, docs/physics.md 4.3]
FRONT = 0.5
NO_CROWD = 2**31  # number of things on a cell that keeps flames away: never reached


def advance(state: BlazeState, world: World, step: float) -> None:
    """Let flames on the floor light their neighbours in `step` seconds of fire; new flames appear in the next frame."""
    if none_set(state.floor_speed > 0):
        return
    slots = state.flame_cell.shape[1]
    blown = coupling.drift(world, state.flame_place)
    speed = state.floor_speed[:, None, None] * (1.0 if blown is None else blown)
    chance = 1.0 - radiation.exponential(-FRONT * speed / spread.STEP * step)
    draw = world.chance.uniform("fire.spread", slots, spread.DIRECTIONS)
    direction = torch.arange(spread.DIRECTIONS, device=draw.device)
    unused = (state.flame_used[..., None] >> direction) & 1 == 0
    success = ((draw < chance) & unused & lit(state, world.frame)[..., None]).flatten(1)
    if none_set(success):
        return
    chosen = spread.compact(success, spread.AT_ONCE)
    parent = chosen.clamp(min=0) // spread.DIRECTIONS
    cell = torch.where(chosen >= 0, state.flame_cell.gather(1, parent), -1)
    aim = spread.neighbour(cell, chosen.clamp(min=0) % spread.DIRECTIONS, state.free.shape[-1])
    state.flame_used.scatter_add_(1, parent, (chosen >= 0).long() << (chosen.clamp(min=0) % spread.DIRECTIONS))
    kept = can_burn(state, world, aim, NO_CROWD)
    if not none_set(kept):
        light(state, slice(None), enlisted(state, aim, kept), world.frame + 1)
