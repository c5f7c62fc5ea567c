"""Smoke in a room as two zones: a hot layer under the ceiling that the plume fills, clear air below it (torch).

    dV/dt = entrained + heat / 353 - lost                 volume of the layer [m^3], V = A (H - z)
    entrained = 0.21 (g / 353)^(1/3) Q^(1/3) (z - z_f)^(5/3)      Zukoski's plume, as in ASET (NIST)
    dE/dt = heat - lost,   heat = (1 - radiant) Q - h A_w (T - T_0)     excess heat of the layer [kJ]

Density times absolute temperature of air is 353 kg K/m^3, so volume and heat give the temperature. Smoke leaves through
gaps of closed doors and windows, as through a weir whose neutral plane is the layer's lower face. All flames feed one
plume. A layer cannot be hotter than flames: heat beyond that stays unburnt. Scheme: explicit Euler, order 1; a room
takes minutes to fill, a frame is 0.15 s. Limits: one layer per scene (partitions do not hold it), no shortage of
oxygen, no jets under the ceiling.
"""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.hazards.fire.realistic.radiation import AIR, GRAVITY, KELVIN, Fires, to_power
from hazard_ms.spec import Room

ZUKOSKI = 0.21  # coefficient of entrainment [-] [docs/physics.md 3.1]
WALLS = 0.03  # heat transfer to walls and ceiling [kW/m^2 K] [docs/physics.md 3.1: MQH, h_k]
VENT = 0.7  # flow coefficient of openings [-] [docs/physics.md 3.1]
GAP = 0.02  # width of the gaps of a closed door or window [m] [docs/physics.md 4.4]
SIGHT = 8700.0  # extinction area of smoke, K_m [m^2/kg] [docs/physics.md 3.1]
THIN = 1e-3  # least volume of a layer that has a temperature [m^3]
PLUME_LIMIT = 900.0  # largest rise of temperature, that in flames [K] [docs/physics.md 3.1: CFAST]
PLUME_WIDTH = 0.12  # radius of a plume per height above its fire [-] [M: Heskestad]
VIRTUAL = (-1.02, 0.083)  # height of a plume's virtual origin: per diameter, per Q^0.4 [docs/physics.md 3.1: Heskestad]


class Walls(NamedTuple):
    """The walls and ceiling of each room, [E]."""

    area: Tensor  # area of the floor [m^2]
    height: Tensor  # height of the ceiling [m]
    edge: Tensor  # circumference [m]


class Layer(NamedTuple):
    """The layer of smoke of each room, [E]."""

    volume: Tensor  # [m^3]
    energy: Tensor  # excess heat [kJ]
    soot: Tensor  # mass of soot [kg]


def interface(layer_volume: Tensor, walls: Walls) -> Tensor:
    """Height of the layer's lower face above the floor [m], [E]."""
    return (walls.height - layer_volume / walls.area).clamp(min=0.0)


def temperature(layer: Layer, room: float) -> Tensor:
    """Temperature of the layer [C], [E], in a room of `room` [C]."""
    mass = (AIR * layer.volume - layer.energy) / (room + KELVIN)
    hot = AIR * layer.volume / mass.clamp(min=AIR * THIN / 2000.0) - KELVIN
    return torch.where(layer.volume > THIN, hot, room)


def entrained(power: Tensor, height: Tensor) -> Tensor:
    """Air [m^3/s], [...], that a plume of `power` [kW], [...], draws in up to `height` [m], [...], above the fire."""
    return (
        ZUKOSKI
        * (GRAVITY / AIR) ** (1.0 / 3.0)
        * to_power(power, 1.0 / 3.0)
        * to_power(height.clamp(min=0.0), 5.0 / 3.0)
    )


def leak(vents: Tensor, lower: Tensor, hot: Tensor, room: float) -> Tensor:
    """Smoke that leaves through `vents` [kg/s], [E].

    `vents` are width, sill and top [m], [E, O, 3]; the layer's `lower` face [m] and temperature `hot` [C] are [E].
    """
    width, sill, top = vents.unbind(-1)
    density = AIR / (hot + KELVIN)
    lightness = (AIR / (room + KELVIN) - density).clamp(min=0.0)
    face = lower[:, None]
    weir = to_power((top - face).clamp(min=0.0), 1.5) - to_power((sill - face).clamp(min=0.0), 1.5)
    return 2.0 / 3.0 * VENT * (2.0 * GRAVITY * density * lightness).sqrt() * (width * weir).sum(1)


class Source(NamedTuple):
    """Heat and soot that all fires of each room give off, [E]."""

    power: Tensor  # heat release [kW]
    heat: Tensor  # convected part of it [kW]
    base: Tensor  # height at which the plume begins above the floor [m]
    soot: Tensor  # production of soot [kg/s]


def fill(layer: Layer, walls: Walls, vents: Tensor, source: Source, room: float, hottest: float, dt: float) -> Layer:
    """The layer, [E], after `dt` seconds; `vents` [m], [E, O, 3], see `leak`; `room` and `hottest` temperature [C]."""
    lower, hot = interface(layer.volume, walls), temperature(layer, room)
    faces = walls.area + walls.edge * (walls.height - lower)
    net = source.heat - WALLS * faces * (hot - room) * (layer.volume > THIN)
    density = AIR / (hot + KELVIN)
    drained = (leak(vents, lower, hot, room) / density * dt).clamp(max=layer.volume)
    left = 1.0 - drained / layer.volume.clamp(min=THIN)
    grown = layer.volume - drained + dt * (entrained(source.power, lower - source.base) + net / AIR)
    whole = walls.area * walls.height
    kept = whole / torch.maximum(grown, whole)  # what the room cannot hold is pressed out with what it carries
    volume = (grown * kept).clamp(min=0.0)
    most = AIR * volume * (1.0 - (room + KELVIN) / (hottest + KELVIN))
    energy = torch.minimum(((layer.energy * left + dt * net) * kept).clamp(min=0.0), most)
    return Layer(volume, energy, (layer.soot * left + dt * source.soot) * kept)


def extinction(layer: Layer) -> Tensor:
    """Extinction K of light in the layer [1/m], [E]: things that reflect are seen up to 3 / K, lit signs to 8 / K."""
    return torch.where(layer.volume > THIN, SIGHT * layer.soot / layer.volume.clamp(min=THIN), 0.0)


def plume_rise(power: Tensor, radiant: Tensor | float, diameter: Tensor, height: Tensor, room: float) -> Tensor:
    """Rise of temperature [K], [...], on the axis of plumes at `height` [m], [...], above their fires (Heskestad).

    These have `power` [kW], [...], and `diameter` [m], [...]; shapes broadcast. In flames, and as far down as the
    correlation says so, it is held at PLUME_LIMIT.
    """
    kelvin = room + KELVIN
    strength = 9.1 * (kelvin / (GRAVITY * (AIR / kelvin) ** 2)) ** (1.0 / 3.0)
    above = (height - virtual_origin(power, diameter)).clamp(min=1e-3)
    return (strength * to_power((1.0 - radiant) * power, 2.0 / 3.0) / to_power(above, 5.0 / 3.0)).clamp(max=PLUME_LIMIT)


def above(fires: Fires, points: Tensor, room: float) -> Tensor:
    """Rise of temperature [K], [E, P], at `points` [m], [E, P, 3], world frame, in the hottest plume around each.

    It is 0 outside of all plumes.
    """
    apart = points[:, None] - fires.place[:, :, None]  # [E, M, P, 3]
    height = apart[..., 2]
    aside = apart[..., :2].square().sum(-1)
    wide = fires.diameter[..., None] / 2 + PLUME_WIDTH * height
    inside = (height >= 0) & (aside <= wide.square()) & (fires.power > 0)[..., None]
    rise = plume_rise(fires.power[..., None], fires.radiant[..., None], fires.diameter[..., None], height, room)
    return torch.where(inside, rise, 0.0).amax(1)


def virtual_origin(power: Tensor, diameter: Tensor) -> Tensor:
    """Height [m], [...], from which plumes of fires of `power` [kW] and `diameter` [m], [...], seem to come."""
    return VIRTUAL[0] * diameter + VIRTUAL[1] * to_power(power, 0.4)


def gaps(room: Room) -> list[tuple[float, float, float]]:
    """Width, lower and upper end [m] of the gaps of the doors and windows in the outer walls of `room`."""
    return [(GAP, o.sill, o.sill + o.height) for o in room.openings if o.kind != "doorway"]
