"""The kernels of water on a grid that wet and push things, and tell of places: one thread each (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.flood import floating
from hazard_ms.hazards.flood.kernels import Flooded, body_at, wet
from hazard_ms.hazards.flood.realistic.basin import Basin, here
from hazard_ms.hazards.flood.realistic.cylinders import immersed
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.boxes import axes_of
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)


@wp.kernel
def immerse(dt: float, damage_fraction: float, rows: int, columns: int, flooded: Flooded, basin: Basin, bodies: Bodies):
    """Write how much of every thing is under water, for how long it has been, and its soaked pores, after `dt` [s]."""
    e, b = wp.tid()
    share = float(0.0)
    if bodies.exists[e, b]:
        centre = bodies.position[e, b]
        water = here(e, centre[0], centre[1], rows, columns, basin)
        if water.level > 0.0:
            axes, half = axes_of(bodies.rotation[e, b]), 0.5 * bodies.extent[e, b]
            kind = int(flooded.shape[e, b])
            share = immersed(water.level - centre[2], water.slope, axes, half, kind).fraction
    wet(e, b, share, dt, damage_fraction, flooded)


@wp.kernel
def push(
    dt: float,
    rows: int,
    columns: int,
    liquid: floating.Liquid,
    flooded: Flooded,
    basin: Basin,
    bodies: Bodies,
    force: wp.array2d(dtype=wp.vec3),
    torque: wp.array2d(dtype=wp.vec3),
):
    """Write force [N] and torque [N m] of the water on every body over the next `dt` [s]."""
    e, b = wp.tid()
    made = floating.Push()
    if bodies.exists[e, b] and bodies.movable[e, b]:
        centre = bodies.position[e, b]
        water = here(e, centre[0], centre[1], rows, columns, basin)
        if water.level > 0.0:
            body, height = body_at(e, b, flooded, bodies), water.level - centre[2]
            under = immersed(height, water.slope, body.axes, 0.5 * body.extent, body.shape)
            made = floating.push(liquid, body, under, wp.vec3(water.velocity[0], water.velocity[1], 0.0), height, dt)
    force[e, b] = made.force
    torque[e, b] = made.torque


@wp.kernel
def tell(
    rows: int,
    columns: int,
    basin: Basin,
    place: wp.array2d(dtype=wp.vec3),
    level: wp.array2d(dtype=float),
    velocity: wp.array2d(dtype=wp.vec2),
):
    """Write the level of the water [m] and its velocity [m/s] at every `place` [m]."""
    e, p = wp.tid()
    water = here(e, place[e, p][0], place[e, p][1], rows, columns, basin)
    level[e, p] = water.level
    velocity[e, p] = water.velocity
