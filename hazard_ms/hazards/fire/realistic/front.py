"""The floor of a realistic fire: cells that flames and smoke have heated to their ignition catch fire (torch)."""

from __future__ import annotations

import math
from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.hazards.base import none_set
from hazard_ms.hazards.fire import coupling, floor, spread
from hazard_ms.hazards.fire.fire import can_burn, enlisted, light
from hazard_ms.hazards.fire.realistic import radiation, scorch
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.fire.realistic.twozone.balance import Rooms
from hazard_ms.hazards.walls import Partitions
from hazard_ms.simulation.world import World
from hazard_ms.spec import rounding

NO_CROWD = 2**31  # number of things on a cell that keeps flames away: never reached


class _Fires(NamedTuple):
    """What `scorch.Fires` is filled with, [E, M]; `place` is [E, M, 3], `drive` [E, M, 4]."""

    place: Tensor
    source: Tensor
    heat: Tensor
    width: Tensor
    drive: Tensor


def warm(state: BlazeState, world: World, fires: radiation.Fires, room: float, step: float) -> None:
    """Heat the cells of the floor for `step` seconds of fire; `room` is the room's temperature [C]."""
    if none_set((state.floor_inertia > 0) & (fires.power > 0).any(1)):
        return
    fires = radiation.alight(fires)[0]
    length = torch.minimum(radiation.flame_length(fires.power, fires.diameter), state.ceiling[:, None])
    source = fires.place[..., 2] + length / 3.0
    heat = fires.radiant * fires.power / (4.0 * math.pi)
    blown = coupling.drift(world, fires.place)
    drive = torch.ones((*heat.shape, spread.DIRECTIONS), device=heat.device) if blown is None else rounding.sqrt(blown)
    made = _Fires(fires.place.contiguous(), source, heat, fires.diameter.contiguous(), drive)
    launches = world.launches
    sources = ((scorch.Fires, made), (Rooms, state), (scorch.Floor, state), (Partitions, world.walls))
    structs = (launches.struct(kind, of) for kind, of in sources)
    launches.run(scorch.warm, tuple(state.free.shape), step, room, *structs)


def advance(state: BlazeState, world: World) -> None:
    """Light the cells that are hot enough; new flames appear in the next frame."""
    hot = state.free & (state.floor_temperature >= state.floor_ignition[:, None, None, None])
    if none_set(hot):
        return
    if world.openings.inner:  # floor under a closed door waits
        x, y = floor.centres(state.anchor, state.free.shape[-1])
        hot = hot & ~floor.shut(world, *torch.broadcast_tensors(x[..., None], y[..., None, :]))
    hot = hot.flatten(1)
    if none_set(hot):
        return
    aim = spread.compact(hot, spread.AT_ONCE)
    kept = can_burn(state, world, aim, NO_CROWD)
    tried = torch.zeros_like(hot).scatter_(1, aim.clamp(min=0), aim >= 0)
    state.free.copy_(state.free & ~tried.view_as(state.free))  # once: it burns now, or other flames are on it
    if not none_set(kept):
        light(state, slice(None), enlisted(state, aim, kept), world.frame + 1)
