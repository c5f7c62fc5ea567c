"""Things that flames touch (torch)."""

from __future__ import annotations

from functools import partial

import torch
from torch import Tensor

from hazard_ms.hazards.fire import floor, spread
from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.hazards.walls import cut_off
from hazard_ms.simulation.walls import Walls
from hazard_ms.simulation.world import World

LEAN = 0.05  # how far a flame leans over [m] [ours]
TOUCH_FLUX = 30.0  # flux on what a flame touches [kW/m^2] [M: SFPE, flames on walls 20 to 40]


def touched(fires: radiation.Fires, world: World, ceiling: Tensor) -> Tensor:
    """Whether the flames of another thing, or of the floor, reach each thing, [E, B], bool.

    Things are boxes along the axes, flames stand upright below the `ceiling` [m], [E].
    """
    hot, number = radiation.alight(fires)
    half = floor.half_spans(world.rotation, world.extent)
    return radiation.in_blocks(partial(_touched, number), hot, world.walls, world.position, half, ceiling)


def _touched(
    number: Tensor, fires: radiation.Fires, walls: Walls, position: Tensor, half: Tensor, ceiling: Tensor
) -> Tensor:
    """As `touched`, by fires of which those with a `number`, [M], below B are things."""
    bodies = half.shape[1]
    own, thing = number.clamp(max=bodies - 1), number < bodies
    reach = torch.where(thing[:, None], half[:, own, :2], spread.STEP / 2)  # [E, M, 2]
    top = fires.place[..., 2] + torch.minimum(radiation.flame_length(fires.power, fires.diameter), ceiling[:, None])
    top = torch.where(thing, torch.maximum(top, (position + half)[:, own, 2]), top)
    gap = (fires.place[:, :, None, :2] - position[:, None, :, :2]).abs()
    beside = (gap <= (reach[:, :, None] + half[:, None, :, :2] + LEAN)).all(-1)
    low, high = (position - half)[..., 2], (position + half)[..., 2]
    level = (low[:, None] <= top[..., None]) & (high[:, None] >= fires.place[..., None, 2])
    other = number[:, None] != torch.arange(bodies, device=number.device)
    near = beside & level & (fires.power > 0)[..., None] & other
    if walls.any:
        near = cut_off(near, walls, fires.place, position)
    return near.any(1)
