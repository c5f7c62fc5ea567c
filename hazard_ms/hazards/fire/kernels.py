"""The temperature around points in a burning room (Warp), as hazard_ms.hazards.fire.heat has it for things."""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.walls import Partitions, clear
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.boxes import axes_of, base_of
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)


@wp.struct
class Heat:
    """The fields of hazard_ms.hazards.fire.fire_state.FireState with these names, of B things, A robots, F flames."""

    temperature: wp.array2d(dtype=float)
    agent_temperature: wp.array2d(dtype=float)
    flame_cell: wp.array2d(dtype=wp.int64)
    flame_place: wp.array2d(dtype=wp.vec3)
    flame_birth: wp.array2d(dtype=wp.int64)


@wp.func
def weight_of(offset: wp.vec3, nearest: float) -> float:
    """The weight [1/m^2] of a source at this `offset` [m]; nearer ones than `nearest` [m] weigh no more."""
    return 1.0 / wp.max(wp.dot(offset, offset), nearest * nearest)


@wp.kernel
def temperature_at(
    points: wp.array2d(dtype=wp.vec3),
    frame: wp.array(dtype=wp.int64),
    robots: wp.array2d(dtype=wp.vec3),
    room: float,
    room_weight: float,
    nearest: float,
    flame: float,
    heat: Heat,
    bodies: Bodies,
    walls: Partitions,
    found: wp.array2d(dtype=float),
):
    """Set `found` to the mean temperature [C] around each of the `points` [m] of each environment.

    Sources are the `robots` [m], things that are not safe, and flames, at the temperature `flame` [C], as far as no
    wall stands between; `room_weight` [1/m^2] is that of the room, at the temperature `room` [C].
    """
    e, p = wp.tid()
    point = points[e, p]
    total = float(0.0)
    excess = float(0.0)
    for a in range(robots.shape[1]):
        if clear(e, robots[e, a], point, walls):
            w = weight_of(robots[e, a] - point, nearest)
            total += w
            excess += w * (heat.agent_temperature[e, a] - room)
    total += room_weight
    for b in range(heat.temperature.shape[1]):
        if bodies.exists[e, b] and not bodies.safe[e, b]:
            place = base_of(bodies.position[e, b], axes_of(bodies.rotation[e, b]), bodies.extent[e, b])
            if clear(e, place, point, walls):
                w = weight_of(place - point, nearest)
                total += w
                excess += w * (heat.temperature[e, b] - room)
    for f in range(heat.flame_cell.shape[1]):
        if heat.flame_cell[e, f] < wp.int64(0):
            break  # the roster is in the order of ignition
        if heat.flame_birth[e, f] <= frame[e] and clear(e, heat.flame_place[e, f], point, walls):
            w = weight_of(heat.flame_place[e, f] - point, nearest)
            total += w
            excess += w * (flame - room)
    found[e, p] = room + excess / total
