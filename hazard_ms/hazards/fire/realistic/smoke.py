"""Smoke of a realistic fire, for torch: the layers of all rooms, and the plumes over fires.

The laws of the layers are those of `.twozone`.
"""

from __future__ import annotations

import functools
from functools import partial
from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.hazards.base import none_set
from hazard_ms.hazards.fire.realistic import fuels
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.fire.realistic.radiation import AIR, GRAVITY, KELVIN, Fires, alight, in_blocks
from hazard_ms.hazards.fire.realistic.twozone import balance, network, zones
from hazard_ms.hazards.walls import cut_off
from hazard_ms.simulation.walls import Walls
from hazard_ms.simulation.world import World
from hazard_ms.spec import rounding

PLUME_LIMIT = 900.0  # largest rise of temperature, that in flames [K] [docs/physics.md 3.1: CFAST]
PLUME_WIDTH = 0.12  # radius of a plume per height above its fire [-] [M: Heskestad]
# Ceiling jet: rise per Q^(2/3) / H^(5/3) above the fire, per (Q / r)^(2/3) / H from NEAR H on, in the top part of H
# [docs/physics.md 3.1: Alpert]
JET_ABOVE, JET_ASIDE, NEAR, JET_DEPTH = 16.9, 5.38, 0.18, 0.1
SEEN = 3.0  # what one sees in smoke, times its extinction [-] [docs/physics.md 3.1: Jin]
FARTHEST = 100.0  # distance that counts as clear sight [m] [ours]
VIRTUAL = (-1.02, 0.083)  # height of a plume's virtual origin: per diameter, per Q^0.4 [docs/physics.md 3.1: Heskestad]


class _Sources(NamedTuple):
    """What `zones.Sources` is filled with, [E, M]; `place` is [E, M, 3]."""

    place: Tensor
    power: Tensor
    radiant: Tensor
    diameter: Tensor
    yields: Tensor
    floor: Tensor
    burns: Tensor


def advance(state: BlazeState, world: World, fires: Fires, yields: Tensor, room: float, step: float) -> Tensor:
    """Carry the smoke over `step` [s]; returns the heat release [kW], [E, M], for which the fires have oxygen.

    `yields` [kg/kJ], [E, B, YIELDS], is what each of the first B fires makes, the others are of wood; `room` is the
    temperature outside [C].
    """
    work = state.zone_area[..., None].expand(-1, -1, balance.WORK)
    matrix = state.zone_area[..., None].expand(-1, -1, state.zone_area.shape[1] + network.MORE)
    burns, work, upper, lower, matrix = world.launches.results(
        zones.advance, fires.power, work, state.zone_smoke, state.zone_air, matrix
    )
    place, power, radiant, diameter = (v.contiguous() for v in fires)
    source = _Sources(place, power, radiant, diameter, yields, _of_wood(place.device), burns)
    structs = world.launches.struct(zones.Sources, source), world.launches.struct(balance.Rooms, state)
    world.launches.run(zones.advance, (len(burns),), step, room, *structs, work, upper, lower, matrix)
    return burns


@functools.lru_cache(maxsize=4)
def _of_wood(device: torch.device) -> Tensor:
    """Yields of burning floor [kg/kJ], [1, YIELDS]."""
    return torch.tensor([fuels.MATERIALS["wood"].yields], device=device)


def zone_of(state: BlazeState, points: Tensor) -> Tensor:
    """Number of the room, [E, P], int64, of `points` [m], [E, P, 3], world frame."""
    ends = (state.zone_end_x, state.zone_end_y)
    i, j = ((points[..., k, None] > end[:, None]).sum(-1) for k, end in enumerate(ends))
    return i + state.zone_columns[:, None] * j


def plume_rise(power: Tensor, radiant: Tensor | float, diameter: Tensor, height: Tensor, room: float) -> Tensor:
    """Rise of temperature [K], [...], on the axis of plumes at `height` [m], [...], above their fires (Heskestad).

    These have `power` [kW], [...], and `diameter` [m], [...]; shapes broadcast. In flames, and as far down as the
    correlation says so, it is held at PLUME_LIMIT.
    """
    kelvin = room + KELVIN
    strength = 9.1 * (kelvin / (GRAVITY * (AIR / kelvin) ** 2)) ** (1.0 / 3.0)
    above = (height - virtual_origin(power, diameter)).clamp(min=1e-3)
    return (strength * rounding.power((1.0 - radiant) * power, 2.0 / 3.0) / rounding.power(above, 5.0 / 3.0)).clamp(
        max=PLUME_LIMIT
    )


def above(fires: Fires, walls: Walls, points: Tensor, room: float) -> Tensor:
    """Rise of temperature [K], [E, P], at `points` [m], [E, P, 3], world frame, in the hottest plume around each.

    It is 0 outside of all plumes, which `walls` cut off.
    """
    return in_blocks(partial(_above, room), alight(fires)[0], walls, points)


def jet_rise(power: Tensor, apart: Tensor, high: Tensor) -> Tensor:
    """Rise of temperature [K], [...], in the jet under a ceiling `high` [m] above a fire, `apart` [m] aside (Alpert).

    The fire has `power` [kW]; all [...], shapes broadcast.
    """
    high = high.clamp(min=1e-3)
    above = JET_ABOVE * rounding.power(power, 2.0 / 3.0) / rounding.power(high, 5.0 / 3.0)
    aside = JET_ASIDE * rounding.power(power / apart.clamp(min=1e-3), 2.0 / 3.0) / high
    return torch.where(apart > NEAR * high, aside, above).clamp(max=PLUME_LIMIT)


def under_ceiling(fires: Fires, walls: Walls, points: Tensor, ceiling: Tensor) -> Tensor:
    """Rise of temperature [K], [E, P], at `points` [m], [E, P, 3], world frame, in the jet under the `ceiling`.

    It is that of the fire that makes the hottest jet, and 0 below all and behind `walls`; ceilings are [m], [E].
    """
    if none_set(points[..., 2] > (1.0 - JET_DEPTH) * ceiling[:, None]):
        return torch.zeros_like(points[..., 0])
    return in_blocks(_under_ceiling, alight(fires)[0], walls, points, ceiling)


def _under_ceiling(fires: Fires, walls: Walls, points: Tensor, ceiling: Tensor) -> Tensor:
    high = (ceiling[:, None] - fires.place[..., 2])[..., None]  # [E, M, 1]
    aside = rounding.sqrt((points[:, None, :, :2] - fires.place[:, :, None, :2]).square().sum(-1))
    below = ceiling[:, None] - points[..., 2]
    inside = (fires.power > 0)[..., None] & (below >= 0)[:, None] & (below[:, None] < JET_DEPTH * high)
    if walls.any:
        top = torch.cat([fires.place[..., :2], ceiling[:, None, None].expand_as(fires.place[..., :1])], -1)
        inside = cut_off(inside, walls, top, points)
    return torch.where(inside, jet_rise(fires.power[..., None], aside, high), 0.0).amax(1)


def breathed(state: BlazeState, points: Tensor) -> Tensor:
    """The layer around `points` [m], [E, P, 3], world frame: its parts [kg, kJ], [E, P, PARTS], see gas.Gas."""
    here = zone_of(state, points)
    parts = here[..., None].expand(-1, -1, state.zone_smoke.shape[-1])
    high = points[..., 2] > state.zone_height.gather(1, here)
    return torch.where(high[..., None], state.zone_smoke.gather(1, parts), state.zone_air.gather(1, parts))


def visibility(state: BlazeState, points: Tensor) -> Tensor:
    """Sight through smoke [m], [E, P], at `points` [m], [E, P, 3], world frame; at most FARTHEST."""
    here = zone_of(state, points)
    high = points[..., 2] > state.zone_height.gather(1, here)
    thick = torch.where(high, state.zone_density.gather(1, here), state.zone_low_density.gather(1, here))
    return (SEEN / thick.clamp(min=SEEN / FARTHEST)).clamp(max=FARTHEST)


def _above(room: float, fires: Fires, walls: Walls, points: Tensor) -> Tensor:
    apart = points[:, None] - fires.place[:, :, None]  # [E, M, P, 3]
    height = apart[..., 2]
    aside = apart[..., :2].square().sum(-1)
    wide = fires.diameter[..., None] / 2 + PLUME_WIDTH * height
    inside = (height >= 0) & (aside <= wide.square()) & (fires.power > 0)[..., None]
    if walls.any:
        inside = cut_off(inside, walls, fires.place, points)
    rise = plume_rise(fires.power[..., None], fires.radiant[..., None], fires.diameter[..., None], height, room)
    return torch.where(inside, rise, 0.0).amax(1)


def virtual_origin(power: Tensor, diameter: Tensor) -> Tensor:
    """Height [m], [...], from which plumes of fires of `power` [kW] and `diameter` [m], [...], seem to come."""
    return VIRTUAL[0] * diameter + VIRTUAL[1] * rounding.power(power, 0.4)
