"""The smoke of a realistic fire: two zones in every room, a hot layer over clear air (Warp, one thread per scene).

    dm/dt = entrained + in - out                                   mass of the layer [kg]
    dE/dt = heat - walls + in - out,   T = T_0 + E / (c m)         its excess heat [kJ], c = 1 kJ/kg K
    heat  = (1 - radiant) Q + absorbed,   Q at most 13.1 MJ per kg of oxygen that the plume draws in

Air is taken from below the layer, in its flames above its lower face from the layer, whose oxygen is of use down to
LEAST_OXYGEN. The radiated part of Q falls on all surfaces by their area; the layer absorbs of it, and radiates, as soot
does. Walls below its face, and the floor, take up radiation; those above it also heat by natural convection. Heat in
walls: `.lining`; openings: `.vents`, `.balance`; air drawn in: `.plumes`. Panes fall out at PANE. Scheme: order 1, in
parts of at most LONGEST; gas and walls implicit, so stable for any step. Limits: the air below stays as it was, a layer
is no hotter than flames, and what cannot burn for lack of oxygen is gone.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.hazards.fire.realistic.twozone import balance, lining, plumes
from hazard_ms.hazards.fire.realistic.twozone.balance import Rooms
from hazard_ms.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

LONGEST = 0.25  # longest part of a step [s] [ours]
# Transfer by natural convection per dT^(1/3): Nu = 0.15 Ra^(1/3) in air of 350 K [kW/m^2 K^(4/3)] [M: Incropera]
NATURAL = 0.15 * 0.030e-3 * (radiation.GRAVITY * 0.70 / (350.0 * 20.9e-6**2)) ** (1.0 / 3.0)
# Absorption by soot per volume fraction and temperature [1/m K], and density of soot [kg/m^3] [M: CFAST]
SOOT_ABSORPTION, SOOT_DENSITY = 1195.5, 1800.0
BEAM = 3.6  # mean length of rays through a gas per volume and surface [-] [M: Incropera]
PER_OXYGEN = 13100.0  # heat per oxygen used up [kJ/kg] [M: Huggett]
OXYGEN = 0.232  # mass fraction of oxygen in air [-]
LEAST_OXYGEN = 0.166  # the same below which nothing burns in the layer: 15 % by volume [-] [M: CFAST]
PANE = 300.0  # temperature of the layer at which panes fall out of windows [C] [M: Roytman]
TOUCH = 0.1  # share of the height below which the layer begins to touch the floor [ours]
SIGHT = 8700.0  # extinction area of smoke, K_m [m^2/kg] [docs/physics.md 3.1]
STEFAN = wp.constant(radiation.STEFAN)
AIR, KELVIN = wp.constant(radiation.AIR), wp.constant(radiation.KELVIN)


@wp.struct
class Sources:
    """M fires of each environment, see radiation.Fires; `soot` [kg/kJ], and `burns` [kW], what oxygen allows them."""

    place: wp.array2d(dtype=wp.vec3)
    power: wp.array2d(dtype=float)
    radiant: wp.array2d(dtype=float)
    diameter: wp.array2d(dtype=float)
    soot: wp.array2d(dtype=float)
    burns: wp.array2d(dtype=float)


@wp.func
def zone_at(e: int, x: float, y: float, rooms: Rooms) -> int:
    """Number of the room at a point [m] of the floor."""
    along = x
    if rooms.zone_across[e] > wp.int64(0):
        along = y
    r = int(0)
    while r < rooms.zone_area.shape[1] - 1 and along > rooms.zone_end[e, r]:
        r = r + 1
    return r


@wp.func
def gather(e: int, fires: Sources, rooms: Rooms, work: wp.array3d(dtype=float)):
    """Add up the fires of every room."""
    for r in range(rooms.zone_area.shape[1]):
        for column in range(balance.AREA + 1):
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
            work[e, r, balance.SOOT] = work[e, r, balance.SOOT] + power * fires.soot[e, k]
            work[e, r, balance.AREA] = work[e, r, balance.AREA] + wide * wide / plumes.PER_AREA


@wp.func
def exchanged(a: float, b: float) -> float:
    """Transfer by radiation between black surfaces of `a` and `b` [C] [kW/m^2 K]."""
    p, q = a + KELVIN, b + KELVIN
    return STEFAN * (p * p + q * q) * (p + q)


@wp.func
def burn(e: int, r: int, rooms: Rooms, work: wp.array3d(dtype=float)):
    """Find how much of the room's fires has oxygen, and the air that they draw in."""
    power, convected, area = work[e, r, balance.POWER], work[e, r, balance.CONVECTED], work[e, r, balance.AREA]
    share = float(1.0)
    work[e, r, balance.ENTRAINED] = 0.0
    if power > 0.0 and rooms.roofed[e] > 0.0:
        base = work[e, r, balance.BASE] / power
        fresh = plumes.entrained(power, convected, area, rooms.zone_height[e, r] - base)
        whole = plumes.entrained(power, convected, area, rooms.height[e] - base)
        rich = OXYGEN
        if rooms.zone_mass[e, r] > balance.LEAST_LAYER:
            rich = OXYGEN - rooms.zone_lack[e, r] / rooms.zone_mass[e, r]
        oxygen = OXYGEN * fresh + wp.max(rich - LEAST_OXYGEN, 0.0) * wp.max(whole - fresh, 0.0)
        share = wp.min(1.0, PER_OXYGEN * oxygen / power)
        work[e, r, balance.ENTRAINED] = fresh
    rooms.zone_share[e, r] = share


@wp.func
def warm(e: int, r: int, slab: lining.Slab, room: float, rooms: Rooms, work: wp.array3d(dtype=float)):
    """Find the heat [kW] that the layer gets, that which surfaces get [kW/m^2], and the volume [m^3/s] it makes."""
    gas, upper, lower = rooms.zone_temperature[e, r], rooms.zone_upper[e, r][0], rooms.zone_lower[e, r][0]
    floor, low = rooms.zone_area[e, r], rooms.zone_height[e, r]
    high = rooms.zone_wall[e, r]
    rest = 2.0 * floor + rooms.zone_edge[e, r] * rooms.height[e] - high
    opaque = rooms.zone_emissivity[e, r]
    share = rooms.zone_share[e, r]
    radiated = share * (work[e, r, balance.POWER] - work[e, r, balance.CONVECTED])
    upwards = high / (high + rest) * radiated
    between = floor * (1.0 - opaque) * exchanged(upper, lower) * (upper - lower)
    film = NATURAL * wp.max(wp.abs(gas - upper), 1.0) ** (1.0 / 3.0)
    touch = wp.clamp(1.0 - low / (TOUCH * rooms.height[e]), 0.0, 1.0)
    heat = share * work[e, r, balance.CONVECTED] + opaque * upwards
    work[e, r, balance.UPPER] = film + opaque * exchanged(gas, upper)
    work[e, r, balance.LOWER] = floor / rest * (film * touch + opaque * exchanged(gas, lower))
    work[e, r, balance.ABOVE] = ((1.0 - opaque) * upwards - between) / high
    work[e, r, balance.BELOW] = (radiated - upwards + between) / rest
    work[e, r, balance.HEAT] = heat
    work[e, r, balance.NEED] = heat / AIR
    if rooms.zone_mass[e, r] > balance.LEAST_LAYER:
        taken = high * lining.gain(slab, work[e, r, balance.UPPER]) * (gas - upper)
        taken = taken + rest * lining.gain(slab, work[e, r, balance.LOWER]) * (gas - lower)
        work[e, r, balance.NEED] = (heat - taken) / AIR


@wp.func
def settle(
    e: int,
    r: int,
    slab: lining.Slab,
    room: float,
    hottest: float,
    dt: float,
    rooms: Rooms,
    work: wp.array3d(dtype=float),
):
    """Bring the layer of a room and its walls to the end of a part of `dt` [s]."""
    share, power = rooms.zone_share[e, r], work[e, r, balance.POWER]
    mass = rooms.zone_mass[e, r]
    kept = mass / wp.max(mass + dt * work[e, r, balance.LOST], 1.0e-9)
    mass = kept * mass + dt * (work[e, r, balance.ENTRAINED] + work[e, r, balance.MASS])
    energy = kept * rooms.zone_energy[e, r] + dt * (work[e, r, balance.HEAT] + work[e, r, balance.ENERGY])
    soot = kept * rooms.zone_soot[e, r] + dt * (share * work[e, r, balance.SOOT] + work[e, r, balance.GRIME])
    lack = kept * rooms.zone_lack[e, r] + dt * (share * power / PER_OXYGEN + work[e, r, balance.LACK])
    floor, tall = rooms.zone_area[e, r], rooms.height[e]
    high = rooms.zone_wall[e, r]
    rest = 2.0 * floor + rooms.zone_edge[e, r] * tall - high
    above = lining.eliminate(
        rooms.zone_upper[e, r], slab, work[e, r, balance.UPPER], work[e, r, balance.ABOVE], room, dt
    )
    below = lining.eliminate(
        rooms.zone_lower[e, r], slab, work[e, r, balance.LOWER], work[e, r, balance.BELOW], room, dt
    )
    up, down = dt * high * above.gain, dt * rest * below.gain
    ready = mass + up * (1.0 - above.b[0]) + down * (1.0 - below.b[0])
    gas = (energy + mass * room + up * above.a[0] + down * below.a[0]) / wp.max(ready, 1.0e-9)
    rooms.zone_upper[e, r] = lining.restore(above, gas)
    rooms.zone_lower[e, r] = lining.restore(below, gas)
    energy = wp.clamp(mass * (gas - room), 0.0, mass * (hottest - room))
    volume = (mass * (room + KELVIN) + energy) / AIR
    whole = wp.min(1.0, floor * tall / wp.max(volume, 1.0e-9)) * rooms.roofed[e]
    rooms.zone_mass[e, r] = mass * whole
    rooms.zone_energy[e, r] = energy * whole
    rooms.zone_soot[e, r] = soot * whole
    rooms.zone_lack[e, r] = lack * whole
    describe(e, r, volume * whole, room, rooms)
    wetted = floor + rooms.zone_edge[e, r] * (tall - rooms.zone_height[e, r])
    if wetted > high:  # what the layer newly covers was as warm as the walls below it
        old = high / wetted
        rooms.zone_upper[e, r] = old * rooms.zone_upper[e, r] + (1.0 - old) * rooms.zone_lower[e, r]
    if wetted < high:
        old = rest / (rest + high - wetted)
        rooms.zone_lower[e, r] = old * rooms.zone_lower[e, r] + (1.0 - old) * rooms.zone_upper[e, r]
    rooms.zone_wall[e, r] = wetted


@wp.func
def describe(e: int, r: int, volume: float, room: float, rooms: Rooms):
    """Write height [m], temperature [C], extinction [1/m] and emissivity of a layer of `volume` [m^3]."""
    mass, floor = rooms.zone_mass[e, r], rooms.zone_area[e, r]
    warmth, thick, opaque = room, float(0.0), float(0.0)
    depth = volume / floor
    if mass > balance.LEAST_LAYER:
        warmth = room + rooms.zone_energy[e, r] / mass
        thick = rooms.zone_soot[e, r] / volume
        path = BEAM * volume / (2.0 * floor + rooms.zone_edge[e, r] * depth)
        opaque = 1.0 - wp.exp(-SOOT_ABSORPTION * thick / SOOT_DENSITY * (warmth + KELVIN) * path)
    rooms.zone_height[e, r] = wp.max(rooms.height[e] - depth, 0.0)
    rooms.zone_temperature[e, r] = warmth
    rooms.zone_density[e, r] = SIGHT * thick
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
def advance(step: float, room: float, hottest: float, fires: Sources, rooms: Rooms, work: wp.array3d(dtype=float)):
    """Carry all rooms of a scene over `step` [s]; `room` is the temperature [C] outside, `hottest` that of flames."""
    e = wp.tid()
    count = rooms.zone_area.shape[1]
    slab = lining.Slab()
    slab.conductivity = rooms.lining_conductivity[e]
    slab.capacity = rooms.lining_capacity[e]
    slab.thickness = rooms.lining_thickness[e]
    air = AIR / (room + KELVIN)
    gather(e, fires, rooms, work)
    parts = int(wp.ceil(step / LONGEST - 1.0e-4))
    dt = step / float(parts)
    for _ in range(parts):
        for r in range(count):
            if rooms.zone_area[e, r] > 0.0:
                burn(e, r, rooms, work)
                warm(e, r, slab, room, rooms, work)
        if rooms.roofed[e] > 0.0:
            balance.balance(e, air, rooms, work)
            balance.exchange(e, air, room, dt, rooms, work)
            shatter(e, rooms)
        for r in range(count):
            if rooms.zone_area[e, r] > 0.0:
                settle(e, r, slab, room, hottest, dt, rooms, work)
    for k in range(fires.power.shape[1]):
        point = fires.place[e, k]
        fires.burns[e, k] = fires.power[e, k] * rooms.zone_share[e, zone_at(e, point[0], point[1], rooms)]
