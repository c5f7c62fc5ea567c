"""The smoke of a realistic fire: two zones in every room, a hot layer over cooler air (Warp, one thread per scene).

    dm/dt = in - out                                  mass of the layer, and of the air [kg]
    dE/dt = heat - walls + in - out,   T = T_0 + E / (c m)         their excess heat [kJ], c = 1 kJ/kg K
    the same of soot, of lack of oxygen, of carbon monoxide and of hydrogen cyanide

What a layer consists of: `.gas`; what fires burn and make: `.combustion`; air that they draw in: `.plumes`; heat:
`.heat`, `.lining`; openings: `.vents`, `.exchange`; pressures: `.balance`, `.network`. Panes fall out at PANE. Scheme:
order 1, in parts of at most LONGEST; what leaves a layer, and gas and its walls, implicit, so stable for any step. All
masses and heats are kept exactly; a volume that the room has not is pressed out in the next parts. Limits: the air
takes up no radiation, and what cannot burn for lack of oxygen is gone.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.hazards.fire.realistic.twozone import balance, combustion, exchange, gas, heat, lining, network, plumes
from hazard_ms.hazards.fire.realistic.twozone.balance import Rooms
from hazard_ms.hazards.fire.realistic.twozone.gas import Gas
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

LONGEST = 0.25  # longest part of a step [s] [ours]
# Absorption by soot per volume fraction and temperature [1/m K], and density of soot [kg/m^3] [M: CFAST]
SOOT_ABSORPTION, SOOT_DENSITY = 1195.5, 1800.0
BEAM = 3.6  # mean length of rays through a gas per volume and surface [-] [M: Incropera]
PANE = 300.0  # temperature of the layer at which panes fall out of windows [C] [M: Roytman]
SIGHT = 8700.0  # extinction area of smoke, K_m [m^2/kg] [docs/physics.md 3.1]
AIR, KELVIN = wp.constant(radiation.AIR), wp.constant(radiation.KELVIN)
UNBOUNDED = wp.constant(1e6)  # where rooms do not end [m]

YIELDS = 5  # per heat [kg/kJ]: soot, carbon monoxide, hydrogen cyanide with enough air and without, and fuel
Yields = wp.types.vector(length=YIELDS, dtype=float)


@wp.struct
class Sources:
    """M fires of each environment, see radiation.Fires; `burns` [kW]: what oxygen allows them.

    `yields` [kg/kJ] are those of the first fires, those of the `floor` hold for all others.
    """

    place: wp.array2d(dtype=wp.vec3)
    power: wp.array2d(dtype=float)
    radiant: wp.array2d(dtype=float)
    diameter: wp.array2d(dtype=float)
    yields: wp.array2d(dtype=Yields)
    floor: wp.array(dtype=Yields)
    burns: wp.array2d(dtype=float)


@wp.func
def zone_at(e: int, x: float, y: float, rooms: Rooms) -> int:
    """Number of the room at a point [m] of the floor."""
    i, j = int(0), int(0)
    for k in range(rooms.zone_area.shape[1]):
        if x > rooms.zone_end_x[e, k]:
            i = i + 1
        if y > rooms.zone_end_y[e, k]:
            j = j + 1
    return i + int(rooms.zone_columns[e]) * j


@wp.func
def gather(e: int, fires: Sources, rooms: Rooms, work: wp.array3d(dtype=float)):
    """Add up the fires of every room."""
    for r in range(rooms.zone_area.shape[1]):
        for column in range(balance.FUEL + 1):
            work[e, r, column] = 0.0
    for k in range(fires.power.shape[1]):
        power = fires.power[e, k]
        if power > 0.0:
            point = fires.place[e, k]
            r = zone_at(e, point[0], point[1], rooms)
            wide = fires.diameter[e, k]
            work[e, r, balance.POWER] = work[e, r, balance.POWER] + power
            work[e, r, balance.CONVECTED] = work[e, r, balance.CONVECTED] + (1.0 - fires.radiant[e, k]) * power
            work[e, r, balance.BASE] = work[e, r, balance.BASE] + power * point[2]
            work[e, r, balance.AREA] = work[e, r, balance.AREA] + wide * wide / plumes.PER_AREA
            made = power * fires.floor[0]
            if k < fires.yields.shape[1]:
                made = power * fires.yields[e, k]
            for part in range(YIELDS):
                column = balance.SOOT + part
                work[e, r, column] = work[e, r, column] + made[part]


@wp.func
def settle(
    e: int, r: int, slab: lining.Slab, room: float, dt: float, rooms: Rooms,
    work: wp.array3d(dtype=float), smoke: wp.array2d(dtype=Gas), air: wp.array2d(dtype=Gas),
):  # fmt: skip
    """Bring the layer and the air of a room, and its walls, to the end of a part of `dt` [s]."""
    above, below = rooms.zone_smoke[e, r][gas.MASS], rooms.zone_air[e, r][gas.MASS]
    stays = above / wp.max(above + dt * work[e, r, balance.LOST], 1.0e-9)
    rests = below / wp.max(below + dt * work[e, r, balance.GONE], 1.0e-9)
    hot = stays * rooms.zone_smoke[e, r] + smoke[e, r] + combustion.products(e, r, dt, rooms, work)
    cool = rests * rooms.zone_air[e, r] + air[e, r]
    hot[gas.ENERGY] = hot[gas.ENERGY] + dt * work[e, r, balance.HEAT]
    cool[gas.ENERGY] = cool[gas.ENERGY] + dt * work[e, r, balance.WARMED]
    rooms.zone_smoke[e, r] = heat.settle(e, r, slab, hot, room, dt, rooms, work)
    rooms.zone_air[e, r] = cool
    describe(e, r, room, rooms)
    cover(e, r, rooms)


@wp.func
def cover(e: int, r: int, rooms: Rooms):
    """Hand walls that the layer newly covers, or leaves, to those above or below its face, with their heat."""
    floor, tall, high = rooms.zone_area[e, r], rooms.height[e], rooms.zone_wall[e, r]
    rest = 2.0 * floor + rooms.zone_edge[e, r] * tall - high
    wetted = floor + rooms.zone_edge[e, r] * (tall - rooms.zone_height[e, r])
    if wetted > high:  # what the layer newly covers was as warm as the walls below it
        old = high / wetted
        rooms.zone_upper[e, r] = old * rooms.zone_upper[e, r] + (1.0 - old) * rooms.zone_lower[e, r]
    if wetted < high:
        old = rest / (rest + high - wetted)
        rooms.zone_lower[e, r] = old * rooms.zone_lower[e, r] + (1.0 - old) * rooms.zone_upper[e, r]
    rooms.zone_wall[e, r] = wetted


@wp.func
def describe(e: int, r: int, room: float, rooms: Rooms):
    """Write height [m], temperatures [C], extinctions [1/m] and emissivity of the layer and of the air below it."""
    smoke, air, floor = rooms.zone_smoke[e, r], rooms.zone_air[e, r], rooms.zone_area[e, r]
    above, below = gas.volume(smoke, room), gas.volume(air, room)
    warmth, thick, opaque, haze = gas.temperature(smoke, room), float(0.0), float(0.0), float(0.0)
    share = below / wp.max(above + below, 1.0e-9)
    if smoke[gas.MASS] > gas.LEAST_LAYER:
        thick = smoke[gas.SOOT] / above
        path = BEAM * above / (2.0 * floor + rooms.zone_edge[e, r] * (1.0 - share) * rooms.height[e])
        opaque = 1.0 - wp.exp(-SOOT_ABSORPTION * thick / SOOT_DENSITY * (warmth + KELVIN) * path)
    if air[gas.MASS] > gas.LEAST_LAYER:
        haze = air[gas.SOOT] / below
    rooms.zone_height[e, r] = rooms.height[e] * share
    rooms.zone_temperature[e, r] = warmth
    rooms.zone_low_temperature[e, r] = gas.temperature(air, room)
    rooms.zone_density[e, r] = SIGHT * thick
    rooms.zone_low_density[e, r] = SIGHT * haze
    rooms.zone_emissivity[e, r] = opaque


@wp.func
def shatter(e: int, rooms: Rooms):
    """Open the windows whose panes the layer has broken."""
    for o in range(rooms.vents.shape[1]):
        vent, r = rooms.vents[e, o], int(rooms.vent_from[e, o])
        if r >= 0:
            if rooms.zone_temperature[e, r] >= PANE and rooms.zone_height[e, r] < vent[2] and vent[3] > vent[0]:
                rooms.vents[e, o] = wp.vec4(vent[3], vent[1], vent[2], vent[3])


@wp.kernel
def advance(
    step: float,
    room: float,
    fires: Sources,
    rooms: Rooms,
    work: wp.array3d(dtype=float),
    smoke: wp.array2d(dtype=Gas),
    air: wp.array2d(dtype=Gas),
    matrix: wp.array3d(dtype=float),
):
    """Carry all rooms of a scene over `step` [s]; `room` is the temperature [C] outside."""
    e = wp.tid()
    count = rooms.zone_area.shape[1]
    slab = lining.Slab()
    slab.conductivity = rooms.lining_conductivity[e]
    slab.capacity = rooms.lining_capacity[e]
    slab.thickness = rooms.lining_thickness[e]
    outside = AIR / (room + KELVIN)
    gather(e, fires, rooms, work)
    parts = int(wp.ceil(step / LONGEST - 1.0e-4))
    dt = step / float(parts)
    if rooms.roofed[e] > 0.0:
        for _ in range(parts):
            for r in range(count):
                if rooms.zone_area[e, r] > 0.0:
                    combustion.burn(e, r, dt, rooms, work)
                    heat.warm(e, r, slab, room, dt, rooms, work)
                smoke[e, r] = Gas()
                air[e, r] = Gas()
            if rooms.zone_end_x[e, 0] < UNBOUNDED and rooms.zone_end_y[e, 0] < UNBOUNDED:
                network.settle_pressures(e, outside, rooms, work, matrix)
            else:
                balance.balance(e, outside, rooms, work)
            exchange.exchange(e, outside, dt, rooms, work, smoke, air)
            shatter(e, rooms)
            for r in range(count):
                if rooms.zone_area[e, r] > 0.0:
                    settle(e, r, slab, room, dt, rooms, work, smoke, air)
    for k in range(fires.power.shape[1]):
        point = fires.place[e, k]
        fires.burns[e, k] = fires.power[e, k] * rooms.zone_share[e, zone_at(e, point[0], point[1], rooms)]
