"""Heat that the cells of a floor take up, which is what they remember of a fire (Warp, one thread per cell).

A cell gets the flux of every fire as a point source, that of the layer of smoke over it, and where flames touch it that
of flames, driven by the wind. Its surface warms as `.radiation` says of thick solids.
"""

from __future__ import annotations

import math

import warp as wp

from hazard_ms.hazards.fire import spread
from hazard_ms.hazards.fire.realistic import radiation, touching
from hazard_ms.hazards.fire.realistic.twozone.balance import Rooms
from hazard_ms.hazards.fire.realistic.twozone.zones import zone_at
from hazard_ms.hazards.walls import Partitions, clear
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

FLAME_FLUX, TOUCH_FLUX = wp.constant(radiation.FLAME_FLUX), wp.constant(touching.TOUCH_FLUX)
STEFAN, KELVIN = wp.constant(radiation.STEFAN), wp.constant(radiation.KELVIN)
QUARTER = wp.constant(math.pi / 4.0)
STEP = wp.constant(spread.STEP)
BESIDE = wp.constant(1.1 * spread.STEP)  # how far the middle of a cell is from that of a neighbour at most [m]
ON_FLOOR = wp.constant(0.1)  # height up to which a fire's base is on the floor [m] [ours]


@wp.struct
class Fires:
    """M fires of each environment: `source` is the point [m] that they radiate from, `drive` the share of TOUCH_FLUX.

    The drive is towards +x, -x, +y, -y; `width` is that of the base [m], `heat` what they radiate [kW].
    """

    place: wp.array2d(dtype=wp.vec3)
    source: wp.array2d(dtype=float)
    heat: wp.array2d(dtype=float)
    width: wp.array2d(dtype=float)
    drive: wp.array2d(dtype=wp.vec4)


@wp.struct
class Floor:
    """The fields of BlazeState with the same names."""

    anchor: wp.array2d(dtype=wp.vec2)
    free: wp.array4d(dtype=bool)
    floor_ignition: wp.array(dtype=float)
    floor_critical: wp.array(dtype=float)
    floor_inertia: wp.array(dtype=float)
    floor_temperature: wp.array4d(dtype=float)


@wp.func
def warmed(rise: float, flux: float, most: float, inertia: float, loss: float, dt: float) -> float:
    """Rise [K] of a thick surface after `dt` [s] under `flux` [kW/m^2], see radiation.warm; `most` is where it ends."""
    if rise < most:
        return wp.min(wp.sqrt(rise * rise + flux * flux * dt / (QUARTER * inertia)), most)
    return most + (rise - most) * wp.exp(-dt * loss * loss / (QUARTER * inertia))


@wp.kernel
def warm(step: float, room: float, fires: Fires, rooms: Rooms, floor: Floor, walls: Partitions):
    """Warm every free cell of the floors for `step` [s] in rooms of `room` [C]."""
    e, s, i, j = wp.tid()
    if floor.floor_inertia[e] <= 0.0 or not floor.free[e, s, i, j]:
        return
    half = floor.free.shape[2] // 2
    corner = floor.anchor[e, s]
    x = corner[0] + STEP * float(i - half)
    y = corner[1] + STEP * float(j - half)
    flux = float(0.0)
    touched = float(0.0)
    for k in range(fires.heat.shape[1]):
        heat = fires.heat[e, k]
        place = fires.place[e, k]
        high = fires.source[e, k]
        if heat > 0.0 and clear(e, wp.vec3(place[0], place[1], high), wp.vec3(x, y, 0.0), walls):
            dx = x - place[0]
            dy = y - place[1]
            flux = flux + wp.min(heat / wp.max(dx * dx + dy * dy + high * high, 1.0e-9), FLAME_FLUX)
            near = wp.abs(dx) + wp.abs(dy) - 0.5 * fires.width[e, k]
            if near < BESIDE - 0.5 * STEP and place[2] < ON_FLOOR:
                way = 0
                if wp.abs(dy) > wp.abs(dx):
                    way = 2
                    if dy < 0.0:
                        way = 3
                elif dx < 0.0:
                    way = 1
                touched = wp.max(touched, TOUCH_FLUX * fires.drive[e, k][way])
    r = zone_at(e, x, y, rooms)
    hot = rooms.zone_temperature[e, r] + KELVIN
    cold = room + KELVIN
    flux = flux + rooms.zone_emissivity[e, r] * STEFAN * (hot * hot * hot * hot - cold * cold * cold * cold)
    flux = wp.max(flux, touched)
    loss = floor.floor_critical[e] / (floor.floor_ignition[e] - room)
    rise = floor.floor_temperature[e, s, i, j] - room
    floor.floor_temperature[e, s, i, j] = room + warmed(rise, flux, flux / loss, floor.floor_inertia[e], loss, step)
