"""The kernels of hazard_ms.hazards.flood: a thread per body. Their arguments are quantities of FloodState and World, by name."""

from __future__ import annotations

import warp as wp

from hazard_ms.kernels import floating, slab
from hazard_ms.kernels.boxes import axes_of, base_of, spans
from hazard_ms.kernels.buoyancy import immersion
from hazard_ms.kernels.reach import reach
from hazard_ms.launching import OPTIONS

wp.set_module_options(OPTIONS)


@wp.kernel
def immerse(
    dt: float,
    slabs: bool,
    damage_fraction: float,
    level: wp.array(dtype=float),
    fall: wp.array(dtype=float),
    flow: wp.array(dtype=wp.vec2),
    start: wp.array(dtype=float),
    wall: wp.array2d(dtype=wp.vec2),
    near: wp.array2d(dtype=wp.int64),
    gate: wp.array2d(dtype=wp.vec4),
    gate_way: wp.array2d(dtype=float),
    gate_part: wp.array3d(dtype=wp.int64),
    exists: wp.array2d(dtype=bool),
    position: wp.array2d(dtype=wp.vec3),
    rotation: wp.array2d(dtype=wp.vec4),
    extent: wp.array2d(dtype=wp.vec3),
    shape: wp.array2d(dtype=wp.int64),
    pores: wp.array2d(dtype=float),
    soaking_time: wp.array2d(dtype=float),
    fraction: wp.array2d(dtype=float),
    under: wp.array2d(dtype=float),
    soaked: wp.array2d(dtype=float),
):
    """How much of every thing is under water, for how long it has been, and how much its pores have taken, after a frame of `dt` [s]."""
    e, b = wp.tid()
    share = float(0.0)
    if exists[e, b] and level[e] > 0.0:
        axes, centre = axes_of(rotation[e, b]), position[e, b]
        if slabs:
            base = base_of(centre, axes, extent[e, b])
            found = reach(e, base[0], base[1], flow, start, wall, near, gate, gate_way, gate_part)
            share = slab.immersed_share(level[e] - fall[e] * found.way, base[2], spans(axes, extent[e, b])[2])
        else:
            found = reach(e, centre[0], centre[1], flow, start, wall, near, gate, gate_way, gate_part)
            height = level[e] - fall[e] * found.way - centre[2]
            share = immersion(height, -fall[e] * found.toward, axes, 0.5 * extent[e, b], int(shape[e, b])).fraction
    fraction[e, b] = share
    if share > 0.0 and share >= damage_fraction:
        under[e, b] = under[e, b] + dt
    else:
        under[e, b] = 0.0
    if pores[e, b] > 0.0:
        soaked[e, b] = soaked[e, b] + (1.0 - soaked[e, b]) * (1.0 - wp.exp(-dt * share / soaking_time[e, b]))


@wp.kernel
def push(
    dt: float,
    slabs: bool,
    density: float,
    gravity: float,
    damping: float,
    added_mass: float,
    speed: float,
    level: wp.array(dtype=float),
    fall: wp.array(dtype=float),
    flow: wp.array(dtype=wp.vec2),
    start: wp.array(dtype=float),
    wall: wp.array2d(dtype=wp.vec2),
    near: wp.array2d(dtype=wp.int64),
    gate: wp.array2d(dtype=wp.vec4),
    gate_way: wp.array2d(dtype=float),
    gate_part: wp.array3d(dtype=wp.int64),
    exists: wp.array2d(dtype=bool),
    movable: wp.array2d(dtype=bool),
    position: wp.array2d(dtype=wp.vec3),
    rotation: wp.array2d(dtype=wp.vec4),
    velocity: wp.array2d(dtype=wp.vec3),
    angular_velocity: wp.array2d(dtype=wp.vec3),
    extent: wp.array2d(dtype=wp.vec3),
    mass: wp.array2d(dtype=float),
    shape: wp.array2d(dtype=wp.int64),
    volume: wp.array2d(dtype=float),
    pores: wp.array2d(dtype=float),
    soaked: wp.array2d(dtype=float),
    drag_coefficient: wp.array2d(dtype=float),
    force: wp.array2d(dtype=wp.vec3),
    torque: wp.array2d(dtype=wp.vec3),
):
    """Force [N] and torque [N m] of the water on every body that moves, over the next `dt` [s]."""
    e, b = wp.tid()
    made = floating.Push()
    if exists[e, b] and movable[e, b] and level[e] > 0.0:
        axes, centre = axes_of(rotation[e, b]), position[e, b]
        place = centre
        if slabs:
            place = base_of(centre, axes, extent[e, b])
        found = reach(e, place[0], place[1], flow, start, wall, near, gate, gate_way, gate_part)
        surface, stream = level[e] - fall[e] * found.way, wp.vec3(speed * found.toward[0], speed * found.toward[1], 0.0)
        if slabs:
            box = spans(axes, extent[e, b])
            share = slab.immersed_share(surface, place[2], box[2])
            made.force = slab.push(share, box, stream - velocity[e, b], found.toward, mass[e, b], gravity, dt)
        else:
            kind, displaced = int(shape[e, b]), volume[e, b] * (1.0 - pores[e, b] * soaked[e, b])
            height = surface - centre[2]
            wet = immersion(height, -fall[e] * found.toward, axes, 0.5 * extent[e, b], kind)
            made = floating.push(
                wp.vec4(density, gravity, damping, added_mass),
                velocity[e, b],
                angular_velocity[e, b],
                axes,
                extent[e, b],
                mass[e, b],
                displaced,
                kind,
                drag_coefficient[e, b],
                wet,
                stream,
                height,
                dt,
            )
    force[e, b] = made.force
    torque[e, b] = made.torque
