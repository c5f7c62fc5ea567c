"""Heat of the layers of a room: what fires give, walls take up, and openings radiate (Warp).

The convected part of a fire goes to the layer; the radiated part falls on all surfaces by their area, less what the
layer absorbs. The layer absorbs and radiates as its soot does; walls that it covers also heat by natural convection, as
the air does at the floor and the walls below it. Openings to the outside radiate as black surfaces of what is behind
them: the layer, as far as it is opaque, and the walls.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.hazards.fire.realistic.twozone import balance, gas, lining
from hazard_ms.hazards.fire.realistic.twozone.balance import Rooms
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

# Transfer by natural convection per dT^(1/3): Nu = 0.15 Ra^(1/3) in air of 350 K [kW/m^2 K^(4/3)] [M: Incropera]
NATURAL = 0.15 * 0.030e-3 * (radiation.GRAVITY * 0.70 / (350.0 * 20.9e-6**2)) ** (1.0 / 3.0)
TOUCH = 0.1  # share of the height below which the layer begins to touch the floor [ours]
AT_ONCE = 0.5  # share of a volume that does not fit into a room which leaves it in the next part of a step [ours]
STEFAN = wp.constant(radiation.STEFAN)
AIR, KELVIN = wp.constant(radiation.AIR), wp.constant(radiation.KELVIN)


@wp.func
def exchanged(a: float, b: float) -> float:
    """Transfer by radiation between black surfaces of `a` and `b` [C] [kW/m^2 K]."""
    p, q = a + KELVIN, b + KELVIN
    return STEFAN * (p * p + q * q) * (p + q)


@wp.func
def natural(a: float, b: float) -> float:
    """Transfer by natural convection between gas and surfaces of `a` and `b` [C] [kW/m^2 K]."""
    return NATURAL * wp.max(wp.abs(a - b), 1.0) ** (1.0 / 3.0)


@wp.func
def open_area(e: int, r: int, low: float, high: float, rooms: Rooms) -> float:
    """Area [m^2] between two heights [m] of what is open from a room to the outside."""
    area = float(0.0)
    for o in range(rooms.vents.shape[1]):
        if int(rooms.vent_from[e, o]) == r and int(rooms.vent_to[e, o]) < 0:
            vent = rooms.vents[e, o]
            area = area + vent[0] * wp.max(wp.min(high, vent[2]) - wp.max(low, vent[1]), 0.0)
    return area


@wp.func
def warm(e: int, r: int, slab: lining.Slab, room: float, dt: float, rooms: Rooms, work: wp.array3d(dtype=float)):
    """Find the heat [kW] that layer and air get, that which surfaces get [kW/m^2], and the volume [m^3/s] it makes."""
    hot, upper, lower = rooms.zone_temperature[e, r], rooms.zone_upper[e, r][0], rooms.zone_lower[e, r][0]
    floor, low, tall, high = rooms.zone_area[e, r], rooms.zone_height[e, r], rooms.height[e], rooms.zone_wall[e, r]
    rest = 2.0 * floor + rooms.zone_edge[e, r] * tall - high
    opaque, share = rooms.zone_emissivity[e, r], rooms.zone_share[e, r]
    smoke, air = rooms.zone_smoke[e, r], rooms.zone_air[e, r]
    radiated = share * (work[e, r, balance.POWER] - work[e, r, balance.CONVECTED])
    upwards = high / (high + rest) * radiated
    between = floor * (1.0 - opaque) * exchanged(upper, lower) * (upper - lower)
    film = natural(hot, upper)
    touch = wp.clamp(1.0 - low / (TOUCH * tall), 0.0, 1.0)
    heat = share * work[e, r, balance.CONVECTED] + opaque * upwards
    over, beneath = open_area(e, r, low, tall, rooms), open_area(e, r, 0.0, low, rooms)
    out = over * (1.0 - opaque) * exchanged(upper, room) * (upper - room)
    out_below = beneath * exchanged(lower, room) * (lower - room)
    cool = rooms.zone_low_temperature[e, r]
    ease = (1.0 - touch) * rest * natural(cool, lower)
    warmed = gas.drawn(ease, air[gas.MASS], dt) * (lower - cool)
    shine = over * opaque * exchanged(hot, room)
    work[e, r, balance.WARMED] = warmed
    work[e, r, balance.SHINE] = shine
    work[e, r, balance.UPPER] = film + opaque * exchanged(hot, upper)
    work[e, r, balance.LOWER] = floor / rest * (film * touch + opaque * exchanged(hot, lower))
    work[e, r, balance.ABOVE] = ((1.0 - opaque) * upwards - between - out) / high
    work[e, r, balance.BELOW] = (radiated - upwards + between - out_below - warmed) / rest
    work[e, r, balance.HEAT] = heat
    need = heat
    if smoke[gas.MASS] > gas.LEAST_LAYER:
        need = need - high * lining.gain(slab, work[e, r, balance.UPPER]) * (hot - upper)
        need = need - rest * lining.gain(slab, work[e, r, balance.LOWER]) * (hot - lower) - shine * (hot - room)
    spare = gas.volume(smoke, room) + gas.volume(air, room) - floor * tall
    made = need * gas.swelling(smoke) + warmed * gas.swelling(air)
    made = made + share * work[e, r, balance.FUEL] * (room + KELVIN) / AIR
    work[e, r, balance.NEED] = made + AT_ONCE * spare / dt


@wp.func
def settle(e: int, r: int, slab: lining.Slab, smoke: gas.Gas, room: float, dt: float, rooms: Rooms,
           work: wp.array3d(dtype=float)) -> gas.Gas:  # fmt: skip
    """Let `smoke`, all of a room's layer after `dt` [s], give heat to the walls, and return what it is then."""
    high = rooms.zone_wall[e, r]
    rest = 2.0 * rooms.zone_area[e, r] + rooms.zone_edge[e, r] * rooms.height[e] - high
    above = lining.eliminate(
        rooms.zone_upper[e, r], slab, work[e, r, balance.UPPER], work[e, r, balance.ABOVE], room, dt
    )
    below = lining.eliminate(
        rooms.zone_lower[e, r], slab, work[e, r, balance.LOWER], work[e, r, balance.BELOW], room, dt
    )
    out = dt * work[e, r, balance.SHINE]
    mass = smoke[gas.MASS] * (1.0 + gas.SWELLING * gas.rise(smoke))  # that of c = 1 kJ/kg K
    up, down = dt * high * above.gain, dt * rest * below.gain
    ready = mass + out + up * (1.0 - above.b[0]) + down * (1.0 - below.b[0])
    known = smoke[gas.ENERGY] + (mass + out) * room + up * above.a[0] + down * below.a[0]
    hot = known / wp.max(ready, 1.0e-9)
    rooms.zone_upper[e, r] = lining.restore(above, hot)
    rooms.zone_lower[e, r] = lining.restore(below, hot)
    kept = smoke
    kept[gas.ENERGY] = wp.max(mass * (hot - room), 0.0)
    return kept
