"""Heat from flames on surfaces: point sources, thick and thin solids (torch).

    flame length   L = D (3.7 Q*^0.4 - 1.02),  Q* = Q / (rho c T sqrt(g) D^2.5)           (Heskestad)
    flux           q = cos chi Q / (4 pi R^2), from the point at L / 3                    (point source)
    thick solid    dT^2 grows with (4 / pi) q^2 / (k rho c): t_ig = (pi / 4) k rho c ((T_ig - T_0) / q)^2
    thin solid     dT grows with q / (m c):                  t_ig = m c (T_ig - T_0) / q
    losses         no surface gets warmer than T_0 + q / h, h = q_cr / (T_ig - T_0), so below q_cr nothing ignites; a
                   warmer one cools to that by exp(-t / tau), tau = (pi / 4) k rho c / h^2 or m c / h

Both laws are exact for a constant flux, in steps of any length; both are the published ones, without losses above the
critical flux. Limits: only walls stand in the way of heat, nothing else does; near a source the flux is held at that
of a flame, FLAME_FLUX.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.hazards.walls import cut_off
from hazard_ms.simulation.walls import Walls
from hazard_ms.spec import rounding

GRAVITY = 9.81  # acceleration of gravity [m/s^2]
AIR = 353.0  # density times absolute temperature of air [kg K/m^3], specific heat 1 kJ/kg K [docs/physics.md 3.1]
AIR_DENSITY = 1.2  # density of air [kg/m^3] [docs/physics.md 4.4]
KELVIN = 273.15  # absolute temperature of 0 C [K]
STEFAN = 5.670e-11  # constant of Stefan and Boltzmann [kW/m^2 K^4]
EMISSIVITY = 0.9  # emissivity of surfaces [-] [docs/physics.md 4.4]
CONVECTION = 0.010  # heat transfer by convection [kW/m^2 K] [docs/physics.md 4.4]
FLAME_FLUX = 40.0  # largest flux on what a flame touches [kW/m^2] [M: SFPE, small flames 20 to 40]
_TINY = 1e-9  # least value of a divisor, in its own unit, so that 0 / 0 cannot occur
_BLOCK = 2**17  # most pairs worked on at a time on a CPU, see hazard_ms.hazards.fire.heat


class Fires(NamedTuple):
    """M fires of each environment."""

    place: Tensor  # middle of the base [m], [E, M, 3]
    power: Tensor  # heat release [kW], [E, M]; 0 for what does not burn
    radiant: Tensor  # share of it that is radiated, [E, M]
    diameter: Tensor  # diameter of the base [m], [E, M]


def alight(fires: Fires) -> tuple[Fires, Tensor]:
    """The L fires that give off heat in any environment, and their numbers [-], [L]; at least one, on a GPU all."""
    everything = torch.arange(fires.power.shape[1], device=fires.power.device)
    if fires.power.is_cuda:
        return fires, everything
    found = everything[(fires.power > 0).any(0)]
    found = found if len(found) else everything[:1]
    return Fires(*(v.index_select(1, found) for v in fires)), found


def in_blocks(work: Callable[..., Tensor], fires: Fires, walls: Walls, points: Tensor, *more: Tensor) -> Tensor:
    """The result of `work` on fires, walls, `points` [m], [E, P, 3], and `more`, [E, ...], of all environments.

    On a CPU it works on so few of them at a time that all pairs of fires and points stay in its cache.
    """
    environments = len(points)
    block = environments if points.is_cuda else max(1, _BLOCK // max(1, points.shape[1] * fires.place.shape[1]))
    if block >= environments:
        return work(fires, walls, points, *more)
    parts = (slice(k, k + block) for k in range(0, environments, block))
    cut = ((Fires(*(v[p] for v in fires)), walls.part(p), points[p], *(v[p] for v in more)) for p in parts)
    return torch.cat([work(*arguments) for arguments in cut])


def flame_length(power: Tensor, diameter: Tensor, ambient: float = 20.0) -> Tensor:
    """Mean length of flames [m], [...], of fires of `power` [kW] and `diameter` [m], [...], in air of `ambient` [C]."""
    density = AIR_DENSITY * (ambient + KELVIN) * math.sqrt(GRAVITY)
    wide = diameter.clamp(min=_TINY)
    return (wide * (3.7 * rounding.power(power / (density * rounding.power(wide, 2.5)), 0.4) - 1.02)).clamp(min=0.0)


def point_source(power: Tensor, radiant: Tensor | float, square: Tensor, cosine: Tensor | float = 1.0) -> Tensor:
    """Flux [kW/m^2], [...], of fires of `power` [kW], [...], at squared distances `square` [m^2], [...], of points.

    The surface is turned away from a point by acos(`cosine`).
    """
    return cosine * radiant * power / (4.0 * math.pi * square.clamp(min=_TINY))


def flux(fires: Fires, walls: Walls, points: Tensor, ceiling: Tensor) -> Tensor:
    """Flux of all fires [kW/m^2], [E, P], on surfaces that face them at `points` [m], [E, P, 3], world frame.

    Flames end at the `ceiling` [m], [E]; `walls` keep their heat off.
    """
    return in_blocks(_flux, fires, walls, points, ceiling)


def _flux(fires: Fires, walls: Walls, points: Tensor, ceiling: Tensor) -> Tensor:
    raised = torch.minimum(flame_length(fires.power, fires.diameter), ceiling[:, None]) / 3.0
    square = (fires.place[..., 2] + raised)[..., None] - points[:, None, :, 2]
    square = square.square_()
    for axis in (0, 1):
        offset = fires.place[..., axis, None] - points[:, None, :, axis]
        square.addcmul_(offset, offset)
    given = point_source(fires.power[..., None], fires.radiant[..., None], square).clamp(max=FLAME_FLUX)
    if walls.any:
        source = torch.cat([fires.place[..., :2], (fires.place[..., 2] + raised)[..., None]], -1)
        given = given.masked_fill(~cut_off(given > 0.0, walls, source, points), 0.0)
    return given.sum(1)


class Solid(NamedTuple):
    """Properties of surfaces that take up heat, [...]; of `inertia` and `sheet` one is 0."""

    ignition: Tensor  # ignition temperature [C]
    critical: Tensor  # least flux that ignites it [kW/m^2]
    inertia: Tensor  # k rho c of a thick solid [kW^2 s/m^4 K^2]
    sheet: Tensor  # m c of a thin solid [kJ/m^2 K]


def warm(temperature: Tensor, flux: Tensor, solid: Solid, room: float, dt: float) -> Tensor:
    """Temperature [C], [...], of surfaces after `dt` [s] under `flux` [kW/m^2], [...], in a room of `room` [C]."""
    loss = solid.critical / (solid.ignition - room).clamp(min=1.0)  # [kW/m^2 K]
    rise, most = temperature - room, flux / loss.clamp(min=_TINY)
    thick = solid.inertia > 0
    inertia, sheet = solid.inertia.clamp(min=_TINY), solid.sheet.clamp(min=_TINY)
    grown = torch.where(
        thick, rounding.sqrt(rise.square() + 4.0 / math.pi * flux.square() * dt / inertia), rise + flux * dt / sheet
    )
    slowness = torch.where(thick, math.pi / 4.0 * inertia / loss.clamp(min=_TINY), sheet) / loss.clamp(min=_TINY)
    cooled = most + (rise - most) * rounding.exp(-dt / slowness)
    return room + torch.where((rise >= 0) & (rise < most), torch.minimum(grown, most), cooled)
