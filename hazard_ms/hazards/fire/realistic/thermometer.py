"""Plate thermometers in a realistic fire, of which images are made (Warp, one thread per point).

A plate takes up the flux of every fire as a point source and that of the layer of smoke over it, in the gas of the
layer, or of the hottest plume or ceiling jet around it. The laws are those of `.radiation` and `.smoke`, in single
precision. A plate gets no hotter than the hottest of what heats it: flames, layer and gas.
"""

from __future__ import annotations

import math

import torch
import warp as wp
from torch import Tensor

from hazard_ms.hazards.fire.realistic import radiation, smoke
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.fire.realistic.twozone.balance import Rooms
from hazard_ms.hazards.fire.realistic.twozone.zones import zone_at
from hazard_ms.hazards.walls import Partitions, clear
from hazard_ms.simulation.kernels.launch import OPTIONS, of_environments
from hazard_ms.simulation.world import World

wp.set_module_options(OPTIONS)

AIR, GRAVITY, AIR_DENSITY = (wp.constant(v) for v in (radiation.AIR, radiation.GRAVITY, radiation.AIR_DENSITY))
FLAME_FLUX, CONVECTION = wp.constant(radiation.FLAME_FLUX), wp.constant(radiation.CONVECTION)
STEFAN, KELVIN, EMISSIVITY = (wp.constant(v) for v in (radiation.STEFAN, radiation.KELVIN, radiation.EMISSIVITY))
PLUME_LIMIT, PLUME_WIDTH = wp.constant(smoke.PLUME_LIMIT), wp.constant(smoke.PLUME_WIDTH)
JET_ABOVE, JET_ASIDE, NEAR, JET_DEPTH = (
    wp.constant(v) for v in (smoke.JET_ABOVE, smoke.JET_ASIDE, smoke.NEAR, smoke.JET_DEPTH)
)
PER_DIAMETER, PER_POWER = (wp.constant(v) for v in smoke.VIRTUAL)
SPHERE = wp.constant(4.0 * math.pi)
FAR = wp.constant(1.0e6)  # height of the ceiling in the open [m]
TINY = wp.constant(1.0e-9)  # least value of a divisor, in its own unit
STEPS = wp.constant(6)  # of Newton's method, from above the root of a concave function: five digits


@wp.struct
class Fires:
    """The M fires of each environment, as in `radiation.Fires`."""

    place: wp.array2d(dtype=wp.vec3)
    power: wp.array2d(dtype=float)
    radiant: wp.array2d(dtype=float)
    diameter: wp.array2d(dtype=float)


@wp.func
def flame_length(power: float, diameter: float, room: float) -> float:
    """Mean length of a flame [m], see `radiation.flame_length`."""
    wide = wp.max(diameter, TINY)
    strength = power / (AIR_DENSITY * (room + KELVIN) * wp.sqrt(GRAVITY) * wp.pow(wide, 2.5))
    return wp.max(wide * (3.7 * wp.pow(strength, 0.4) - 1.02), 0.0)


@wp.func
def plume_rise(power: float, radiant: float, diameter: float, height: float, room: float) -> float:
    """Rise of temperature [K] on the axis of a plume, see `smoke.plume_rise`."""
    cold = room + KELVIN
    strength = 9.1 * wp.pow(cold / (GRAVITY * (AIR / cold) * (AIR / cold)), 1.0 / 3.0)
    origin = PER_DIAMETER * diameter + PER_POWER * wp.pow(power, 0.4)
    above = wp.max(height - origin, 1.0e-3)
    return wp.min(strength * wp.pow((1.0 - radiant) * power, 2.0 / 3.0) / wp.pow(above, 5.0 / 3.0), PLUME_LIMIT)


@wp.func
def jet_rise(power: float, apart: float, high: float) -> float:
    """Rise of temperature [K] in the jet under a ceiling `high` [m] above a fire, see `smoke.jet_rise`."""
    third = wp.pow(power, 2.0 / 3.0)
    rise = JET_ABOVE * third / wp.pow(high, 5.0 / 3.0)
    if apart > NEAR * high:
        rise = JET_ASIDE * third / (wp.pow(apart, 2.0 / 3.0) * high)
    return wp.min(rise, PLUME_LIMIT)


@wp.func
def adiabatic(flux: float, gas: float, room: float) -> float:
    """Temperature [C] at which a surface under `flux` [kW/m^2] in `gas` [C] gains no more heat."""
    cold = room + KELVIN
    background = cold * cold * cold * cold
    hot = gas + KELVIN
    surface = wp.max(hot, wp.sqrt(wp.sqrt(flux / STEFAN + background)))
    for _ in range(STEPS):
        cube = surface * surface * surface
        gain = EMISSIVITY * (flux + STEFAN * (background - surface * cube)) + CONVECTION * (hot - surface)
        surface = surface + gain / (4.0 * EMISSIVITY * STEFAN * cube + CONVECTION)
    return surface - KELVIN


@wp.kernel
def show(
    points: wp.array2d(dtype=wp.vec3),
    room: float,
    hottest: float,
    fires: Fires,
    rooms: Rooms,
    walls: Partitions,
    found: wp.array2d(dtype=float),
):
    """Set `found` to what plates at `points` [m] show [C]; `room` and `hottest`: of room and flames [C]."""
    e, p = wp.tid()
    point = points[e, p]
    r = zone_at(e, point[0], point[1], rooms)
    cold, warm = room + KELVIN, rooms.zone_temperature[e, r] + KELVIN
    flux = rooms.zone_emissivity[e, r] * STEFAN * (warm * warm * warm * warm - cold * cold * cold * cold)
    rise, jet = float(0.0), float(0.0)
    ceiling = float(FAR)
    if rooms.roofed[e] > 0.0:
        ceiling = rooms.height[e]
    for m in range(fires.power.shape[1]):
        power = fires.power[e, m]
        if power > 0.0:
            radiant, diameter = fires.radiant[e, m], fires.diameter[e, m]
            place = fires.place[e, m]
            apart = point - place
            aside = apart[0] * apart[0] + apart[1] * apart[1]
            raised = wp.min(flame_length(power, diameter, 20.0), ceiling) / 3.0
            below = apart[2] - raised
            given = radiant * power / (SPHERE * wp.max(aside + below * below, TINY))
            if clear(e, place + wp.vec3(0.0, 0.0, raised), point, walls):
                flux = flux + wp.min(given, FLAME_FLUX)
            wide = diameter / 2.0 + PLUME_WIDTH * apart[2]
            if apart[2] >= 0.0 and aside <= wide * wide and clear(e, place, point, walls):
                rise = wp.max(rise, plume_rise(power, radiant, diameter, apart[2], room))
            high = wp.max(ceiling - place[2], 1.0e-3)
            under = ceiling - point[2]
            if under >= 0.0 and under < JET_DEPTH * high:
                if clear(e, wp.vec3(place[0], place[1], ceiling), point, walls):
                    jet = wp.max(jet, jet_rise(power, wp.sqrt(aside), high))
    gas = rooms.zone_low_temperature[e, r]
    if point[2] > rooms.zone_height[e, r]:
        gas = rooms.zone_temperature[e, r]
    gas = wp.max(gas, wp.min(wp.max(gas + rise, room + jet), hottest))
    most = wp.max(wp.max(gas, hottest), rooms.zone_temperature[e, r])
    found[e, p] = wp.min(adiabatic(flux, gas, room), most)


def shown(
    state: BlazeState, world: World, fires: radiation.Fires, points: Tensor, room: float, hottest: float
) -> Tensor:
    """Temperature [C], [E, P], that plate thermometers at `points` [m], [E, P, 3], world frame, would show.

    It comes from radiation, plumes, ceiling jets and the layer of smoke. `room` and `hottest` [C]: temperatures of the
    room and of flames.
    """
    points = of_environments(points, world.num_envs)
    found = torch.empty_like(points[..., 0])
    of_fires = world.launches.struct(Fires, radiation.Fires(*(v.contiguous() for v in fires)))
    sources = (world.launches.struct(kind, of) for kind, of in ((Rooms, state), (Partitions, world.walls)))
    arguments = (points, room, hottest, of_fires, *sources, found)
    world.launches.run(show, tuple(found.shape), *arguments)
    return found
