"""The two zones of every room of a scene, as kernels see them, and the pressures at which they balance (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.hazards.fire.realistic.twozone import vents
from hazard_ms.hazards.fire.realistic.twozone.gas import Gas
from hazard_ms.hazards.fire.realistic.twozone.lining import Column
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

AIR, KELVIN = wp.constant(radiation.AIR), wp.constant(radiation.KELVIN)
OUTSIDE = wp.constant(-1)  # in place of a room's number
FAR = wp.constant(1e3)  # where the outside's layer begins: nowhere [m]

# Columns of `work`, [E, R, WORK], which holds what the parts of a step tell each other
POWER, CONVECTED, BASE, AREA = (wp.constant(k) for k in range(4))  # of all fires: kW, kW, kW m, m^2
SOOT, MONOXIDE, LEAN, RICH, FUEL = (wp.constant(k) for k in range(4, 9))  # what they make, in the order of Yields: kg/s
ENTRAINED, NEED, LOST, GONE = (wp.constant(k) for k in range(9, 13))  # kg/s, m^3/s, kg/s of smoke and of air
HEAT, UPPER, LOWER, ABOVE, BELOW = (wp.constant(k) for k in range(13, 18))  # kW, films and sources of the linings
WARMED, SHINE, HUNGER = (wp.constant(k) for k in range(18, 21))  # kW into the air, kW/K outdoors, fuel over air
FRESH = wp.constant(21)  # air that comes in through openings, kg/s
WORK = 22  # columns


@wp.struct
class Rooms:
    """The fields of BlazeState with the same names."""

    height: wp.array(dtype=float)
    roofed: wp.array(dtype=float)
    lining_conductivity: wp.array(dtype=float)
    lining_capacity: wp.array(dtype=float)
    lining_thickness: wp.array(dtype=float)
    vents: wp.array2d(dtype=wp.vec4)
    vent_from: wp.array2d(dtype=wp.int64)
    vent_to: wp.array2d(dtype=wp.int64)
    zone_columns: wp.array(dtype=wp.int64)
    zone_end_x: wp.array2d(dtype=float)
    zone_end_y: wp.array2d(dtype=float)
    zone_area: wp.array2d(dtype=float)
    zone_edge: wp.array2d(dtype=float)
    zone_smoke: wp.array2d(dtype=Gas)
    zone_air: wp.array2d(dtype=Gas)
    zone_wall: wp.array2d(dtype=float)
    zone_upper: wp.array2d(dtype=Column)
    zone_lower: wp.array2d(dtype=Column)
    zone_pressure: wp.array2d(dtype=float)
    zone_height: wp.array2d(dtype=float)
    zone_temperature: wp.array2d(dtype=float)
    zone_low_temperature: wp.array2d(dtype=float)
    zone_density: wp.array2d(dtype=float)
    zone_low_density: wp.array2d(dtype=float)
    zone_emissivity: wp.array2d(dtype=float)
    zone_share: wp.array2d(dtype=float)
    zone_draught: wp.array2d(dtype=float)


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
        made.air = AIR / (rooms.zone_low_temperature[e, r] + KELVIN)
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
def joined(e: int, r: int, other: int, rooms: Rooms) -> bool:
    """Whether an opening that is not under water lies between room `r` and room `other`."""
    for o in range(rooms.vents.shape[1]):
        vent = rooms.vents[e, o]
        if vent[0] > 0.0 and vent[2] > vent[1]:
            a, b = int(rooms.vent_from[e, o]), int(rooms.vent_to[e, o])
            if (a == r and b == other) or (a == other and b == r):
                return True
    return False


@wp.func
def surplus(
    e: int, start: int, end: int, pressure: float, air: float, rooms: Rooms, work: wp.array3d(dtype=float)
) -> float:
    """Volume [m^3/s] of the rooms from `start` to before `end` that finds no way out; writes the others' pressures.

    The first of them is at `pressure` [Pa]. What a room makes and does not lose to the outside goes on to the next one.
    """
    rooms.zone_pressure[e, start] = pressure
    carried = work[e, start, NEED] - lost(e, start, OUTSIDE, pressure, 0.0, air, rooms)
    for r in range(start + 1, end):
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
    """Find the pressures of rooms in a row, of those together that openings join; 0 without one to the outside."""
    count = rooms.zone_area.shape[1]
    start = int(0)
    vented = joined(e, 0, OUTSIDE, rooms)
    for r in range(1, count + 1):
        ends = r == count
        if r < count:
            ends = not joined(e, r - 1, r, rooms)
        if ends:
            low = float(-vents.HIGHEST)
            high = float(vents.HIGHEST)
            if vented:
                for _ in range(vents.HALVINGS):
                    middle = 0.5 * (low + high)
                    if surplus(e, start, r, middle * wp.abs(middle), air, rooms, work) < 0.0:
                        high = middle
                    else:
                        low = middle
            else:
                surplus(e, start, r, 0.0, air, rooms, work)
            start = r
            vented = False
        if r < count:
            vented = vented or joined(e, r, OUTSIDE, rooms)
