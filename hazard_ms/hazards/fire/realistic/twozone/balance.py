"""The two zones of every room of a scene, as kernels see them, and the pressures at which they balance (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.hazards.fire.realistic.twozone import plumes, vents
from hazard_ms.hazards.fire.realistic.twozone.lining import Column
from hazard_ms.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

AIR, KELVIN = wp.constant(radiation.AIR), wp.constant(radiation.KELVIN)
ENTRAINMENT = wp.constant(plumes.PER_POWER)
OUTSIDE = wp.constant(-1)  # in place of a room's number
FAR = wp.constant(1e3)  # where the outside's layer begins: nowhere [m]
LEAST_LAYER = wp.constant(1e-3)  # mass from which a layer has a temperature [kg] [ours]

# Columns of `Rooms.work`, which holds what the parts of a step tell each other
POWER, CONVECTED, BASE, SOOT, AREA = (wp.constant(k) for k in range(5))  # of all fires: kW, kW, kW m, kg/s, m^2
ENTRAINED, NEED, LOST = wp.constant(5), wp.constant(6), wp.constant(7)  # kg/s, m^3/s, kg/s
MASS, ENERGY, GRIME, LACK = (wp.constant(k) for k in range(8, 12))  # gains by openings: kg/s, kW, kg/s, kg/s
HEAT, UPPER, LOWER, ABOVE, BELOW = (wp.constant(k) for k in range(12, 17))  # kW, films and sources of the linings
WORK = 17  # columns


@wp.struct
class Rooms:
    """The fields of BlazeState with the same names, and `work`, [E, R, WORK]."""

    height: wp.array(dtype=float)
    roofed: wp.array(dtype=float)
    lining_conductivity: wp.array(dtype=float)
    lining_capacity: wp.array(dtype=float)
    lining_thickness: wp.array(dtype=float)
    vents: wp.array2d(dtype=wp.vec4)
    vent_from: wp.array2d(dtype=wp.int64)
    vent_to: wp.array2d(dtype=wp.int64)
    zone_across: wp.array(dtype=wp.int64)
    zone_end: wp.array2d(dtype=float)
    zone_area: wp.array2d(dtype=float)
    zone_edge: wp.array2d(dtype=float)
    zone_mass: wp.array2d(dtype=float)
    zone_energy: wp.array2d(dtype=float)
    zone_soot: wp.array2d(dtype=float)
    zone_lack: wp.array2d(dtype=float)
    zone_wall: wp.array2d(dtype=float)
    zone_upper: wp.array2d(dtype=Column)
    zone_lower: wp.array2d(dtype=Column)
    zone_pressure: wp.array2d(dtype=float)
    zone_height: wp.array2d(dtype=float)
    zone_temperature: wp.array2d(dtype=float)
    zone_density: wp.array2d(dtype=float)
    zone_emissivity: wp.array2d(dtype=float)
    zone_share: wp.array2d(dtype=float)


@wp.func
def side(e: int, r: int, pressure: float, air: float, rooms: Rooms) -> vents.Side:
    """The gas of room `r`, or of the outside, which is -1, at this `pressure` [Pa]; `air` [kg/m^3] is the outside's."""
    made = vents.Side()
    made.air = air
    made.density = air
    made.face = FAR
    if r >= 0:
        made.pressure = pressure
        made.density = AIR / (rooms.zone_temperature[e, r] + KELVIN)
        made.face = rooms.zone_height[e, r]
    return made


@wp.func
def passed(e: int, o: int, a: vents.Side, b: vents.Side, rooms: Rooms) -> vents.Flow:
    """Find the flow [kg/s] through the opening `o`, from the side `a` to the side `b`."""
    vent = rooms.vents[e, o]
    return vents.through(vent[0], vent[1], vent[2], a, b)


@wp.func
def lost(e: int, r: int, other: int, p: float, q: float, air: float, rooms: Rooms) -> float:
    """Volume [m^3/s] that room `r` at `p` [Pa] loses to room `other` at `q` [Pa], by all openings between them."""
    here, there = side(e, r, p, air, rooms), side(e, other, q, air, rooms)
    total = float(0.0)
    for o in range(rooms.vents.shape[1]):
        a, b = int(rooms.vent_from[e, o]), int(rooms.vent_to[e, o])
        if a == r and b == other:
            total = total + vents.volume(passed(e, o, here, there, rooms), here, there)
        if a == other and b == r:
            total = total - vents.volume(passed(e, o, there, here, rooms), there, here)
    return total


@wp.func
def surplus(e: int, pressure: float, air: float, rooms: Rooms, work: wp.array3d(dtype=float)) -> float:
    """Volume [m^3/s] that finds no way out if the first room is at `pressure` [Pa]; writes the other pressures.

    What a room makes and does not lose to the outside goes on to the next one.
    """
    rooms.zone_pressure[e, 0] = pressure
    carried = work[e, 0, NEED] - lost(e, 0, OUTSIDE, pressure, 0.0, air, rooms)
    for r in range(1, rooms.zone_area.shape[1]):
        if rooms.zone_area[e, r] > 0.0:
            before = rooms.zone_pressure[e, r - 1]
            low = float(-vents.APART)
            high = float(vents.APART)
            for _ in range(vents.HALVINGS):
                middle = 0.5 * (low + high)
                if lost(e, r - 1, r, before, before - middle * wp.abs(middle), air, rooms) > carried:
                    high = middle
                else:
                    low = middle
            here = before - low * wp.abs(low)
            rooms.zone_pressure[e, r] = here
            carried = carried + work[e, r, NEED] - lost(e, r, OUTSIDE, here, 0.0, air, rooms)
    return carried


@wp.func
def balance(e: int, air: float, rooms: Rooms, work: wp.array3d(dtype=float)):
    """Find the pressures of all rooms."""
    low = float(-vents.HIGHEST)
    high = float(vents.HIGHEST)
    for _ in range(vents.HALVINGS):
        middle = 0.5 * (low + high)
        if surplus(e, middle * wp.abs(middle), air, rooms, work) < 0.0:
            high = middle
        else:
            low = middle


@wp.func
def spill(hot: float, rise: float, above: float) -> float:
    """Air [kg/s] that `hot` smoke [kg/s], `rise` [K] warmer, draws in as it rises by `above` [m] behind an opening."""
    strength = ENTRAINMENT * (hot * rise) ** (1.0 / 3.0)
    drawn = float(0.0)
    if strength > 0.0 and above > 0.0:
        origin = (hot / strength) ** 0.6
        drawn = strength * (origin + above) ** (5.0 / 3.0) - hot
    return drawn


@wp.func
def move(
    e: int, a: int, b: int, sill: float, hot: float, dt: float, room: float, rooms: Rooms, work: wp.array3d(dtype=float)
):
    """Take `hot` smoke [kg/s] out of room `a` and let it rise in room `b`; -1 is the outside.

    No layer gives more than it has: its outflow over `dt` [s] is that of exp(-t) to the first order.
    """
    if a >= 0 and hot > 0.0:
        mass = rooms.zone_mass[e, a]
        work[e, a, LOST] = work[e, a, LOST] + hot
        if b >= 0:
            taken = hot * mass / (mass + dt * hot)
            rise = rooms.zone_temperature[e, a] - room
            above = rooms.zone_height[e, b] - wp.max(rooms.zone_height[e, a], sill)
            work[e, b, MASS] = work[e, b, MASS] + taken + spill(taken, rise, above)
            share = taken / wp.max(mass, LEAST_LAYER)
            work[e, b, ENERGY] = work[e, b, ENERGY] + share * rooms.zone_energy[e, a]
            work[e, b, GRIME] = work[e, b, GRIME] + share * rooms.zone_soot[e, a]
            work[e, b, LACK] = work[e, b, LACK] + share * rooms.zone_lack[e, a]


@wp.func
def exchange(e: int, air: float, room: float, dt: float, rooms: Rooms, work: wp.array3d(dtype=float)):
    """Find what the openings carry in `dt` [s] at the pressures of the rooms."""
    for r in range(rooms.zone_area.shape[1]):
        for column in range(LOST, LACK + 1):
            work[e, r, column] = 0.0
    for o in range(rooms.vents.shape[1]):
        a, b = int(rooms.vent_from[e, o]), int(rooms.vent_to[e, o])
        here = side(e, a, rooms.zone_pressure[e, wp.max(a, 0)], air, rooms)
        there = side(e, b, rooms.zone_pressure[e, wp.max(b, 0)], air, rooms)
        flow = passed(e, o, here, there, rooms)
        sill = rooms.vents[e, o][1]
        move(e, a, b, sill, flow.hot, dt, room, rooms, work)
        move(e, b, a, sill, flow.hot_back, dt, room, rooms, work)
