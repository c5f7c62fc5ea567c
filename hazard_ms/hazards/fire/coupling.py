"""Effects of water and wind on a fire, where another hazard of the same task provides them as fields (torch).

What has been under water does not ignite any more, goes out if it burns, and is no hotter than boiling water; flames on
the floor go out below the surface. Wind drives the fire over the floor: towards a direction d the rate of spread
changes by exp(0.0842 w . d), w in m/s, as McArthur's index for forests grows with wind (exp(0.0234 V), V in km/h) [M].
F flames burn in each of E environments.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor

from hazard_ms.hazards.base import none_set
from hazard_ms.hazards.fire.dousing import NEVER, douse
from hazard_ms.hazards.fire.fire_state import BURNING, FireState
from hazard_ms.hazards.fire.spread import DIRECTIONS
from hazard_ms.simulation.world import World
from hazard_ms.spec import rounding

WET = 0.005  # water over the base of a thing, or over the floor, that wets it [m] [ours]
BOILING = 100.0  # boiling temperature of water [C]
PER_WIND = 0.0842  # logarithm of the rate of spread per speed of the wind [s/m]
FASTEST = 15.0  # wind at 1 m beyond which fire spreads no faster: some 25 m/s at 10 m, where McArthur's index ends [M]
ABOVE_FLOOR = 1.0  # height at which the wind counts [m] [ours]
# Unit vectors of the directions of spread, in the order of `spread.neighbour`
DIRECTION_VECTORS = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))


def drench(state: FireState, world: World) -> None:
    """Put out what is under water now, for good, and what extinguishers reach. Does nothing without either."""
    douse(state, world)
    if "water" not in world.fields:
        return
    level = world.fields["water"]
    base = world.base_of(world.position, world.rotation, world.extent)
    wet = world.exists & ~world.held & ~world.safe & (level(base) > base[..., 2] + WET)
    if not none_set(wet):
        state.threshold.masked_fill_(wet, torch.inf)
        state.status.add_((wet & (state.status == BURNING)).long())  # burning -> burnt
        state.temperature.copy_(torch.where(wet, state.temperature.clamp(max=BOILING), state.temperature))
    drowned = (state.flame_cell >= 0) & (level(state.flame_place) > state.flame_place[..., 2] + WET)
    state.flame_birth.masked_fill_(drowned, NEVER)
    state.flame_used.masked_fill_(drowned, 2**DIRECTIONS - 1)


def fastest(wind: tuple[float, float]) -> float:
    """Largest factor on the rate of spread in a scene of this `wind` [m/s]: 1 where there is none."""
    return math.exp(PER_WIND * FASTEST) if any(wind) else 1.0


def drift(world: World, place: Tensor) -> Tensor | None:
    """Factors on the rate of spread, [E, F, 4], towards each direction from `place` [m], [E, F, 3], world frame.

    None where no hazard provides wind.
    """
    if "air" not in world.fields:
        return None
    wind = world.fields["air"](place + place.new_tensor([0.0, 0.0, ABOVE_FLOOR]))
    wind = wind * (FASTEST / wind.norm(dim=-1, keepdim=True).clamp(min=FASTEST))
    along = (wind[..., None, :] * place.new_tensor(DIRECTION_VECTORS)).sum(-1)
    return rounding.exp(PER_WIND * along)
