"""Things that flames touch (torch)."""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.hazards.fire import floor, spread
from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.simulation.world import World

LEAN = 0.05  # how far a flame leans over [m] [ours]
TOUCH_FLUX = 30.0  # flux on what a flame touches [kW/m^2] [M: SFPE, flames on walls 20 to 40]


def touched(fires: radiation.Fires, world: World, ceiling: Tensor) -> Tensor:
    """Whether the flames of another thing, or of the floor, reach each thing, [E, B], bool.

    Things are boxes along the axes, flames stand upright below the `ceiling` [m], [E].
    """
    return radiation.in_blocks(_touched, fires, world.position, floor.half_spans(world.rotation, world.extent), ceiling)


def _touched(fires: radiation.Fires, position: Tensor, half: Tensor, ceiling: Tensor) -> Tensor:
    bodies = half.shape[1]
    cells = half.new_full((*fires.power[:, bodies:].shape, 2), spread.STEP / 2)
    reach = torch.cat([half[..., :2], cells], 1)  # [E, M, 2]
    top = fires.place[..., 2] + torch.minimum(radiation.flame_length(fires.power, fires.diameter), ceiling[:, None])
    top = torch.cat([torch.maximum(top[:, :bodies], (position + half)[..., 2]), top[:, bodies:]], 1)
    gap = (fires.place[:, :, None, :2] - position[:, None, :, :2]).abs()
    beside = (gap <= (reach[:, :, None] + half[:, None, :, :2] + LEAN)).all(-1)
    low, high = (position - half)[..., 2], (position + half)[..., 2]
    level = (low[:, None] <= top[..., None]) & (high[:, None] >= fires.place[..., None, 2])
    near = beside & level & (fires.power > 0)[..., None]
    near[:, :bodies].diagonal(dim1=1, dim2=2).fill_(False)
    return near.any(1)
