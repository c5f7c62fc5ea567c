"""Seats of fire: what one first fire has grown to, on the floor and on the things that it has lit.

Flames on the floor belong to the lattice of their first fire (hazard_ms.hazards.fire.spread): its number is that of the
cell over K^2. What burns, or is hotter than boiling water, belongs to the seat with the nearest flame, if it is within
NEAR of it.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.hazards.fire.dousing import NEVER, STEAM
from hazard_ms.hazards.fire.fire_state import ALL_USED, BURNING, NORMAL, FireState, lit
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.simulation.world import World

NEAR = 1.0  # distance within which what burns is put out with the flames of a seat [m] [ours: that of `extinguish`]


def flames(state: FireState, frame: Tensor) -> Tensor:
    """The seat of each flame on the floor that burns at `frame`, [E]: its number, -1 for what does not burn, [E, F]."""
    cells = state.free.shape[-1] ** 2
    return torch.where(lit(state, frame), state.flame_cell.div(cells, rounding_mode="floor"), -1)


def things(state: FireState, world: World) -> Tensor:
    """The seat of each thing that burns or is hot, -1 for others, [E, B]."""
    seat = flames(state, world.frame)
    apart = torch.cdist(world.position[..., :2], state.flame_place[..., :2])  # [m], [E, B, F]
    apart = torch.where(seat[:, None] >= 0, apart, torch.inf)
    least, nearest = apart.min(-1)
    hot = (state.status == BURNING) | (state.temperature >= STEAM)
    own = hot & world.exists & ~world.safe & (least <= NEAR)
    return torch.where(own, seat.gather(1, nearest), -1)


def put_out(state: FireState, world: World, row: int, seat: int) -> None:
    """Put out the `seat` of fire in the environment `row`, as an extinguisher does: for good.

    In `realistic` all that burns there is under powder from then on.
    """
    floor, goods = (flames(state, world.frame) == seat)[row], (things(state, world) == seat)[row]
    if isinstance(state, BlazeState):
        state.flame_coated[row, floor] = 1.0
        state.coated[row, goods] = 1.0
        return
    state.flame_birth[row, floor] = NEVER
    state.flame_used[row, floor] = ALL_USED
    burning = goods & (state.status[row] == BURNING)
    state.status[row, burning] = NORMAL
    state.burn_updates[row, burning] = 0
    state.temperature[row] = torch.where(goods, state.temperature[row].clamp(max=STEAM), state.temperature[row])
