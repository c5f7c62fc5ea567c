"""The kernels of hazard_ms.hazards.flood.flood, one thread per body, place or environment (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.flood import floating, slab
from hazard_ms.hazards.flood.buoyancy import immersion
from hazard_ms.hazards.flood.reach import PathArrays, reach
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.boxes import axes_of, base_of, spans
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)


@wp.struct
class Flooded:
    """The fields of FloodState with the same names: the surface, [E], and how wet each thing is, [E, B]."""

    level: wp.array(dtype=float)
    surface_slope: wp.array(dtype=float)
    shape: wp.array2d(dtype=wp.int64)
    volume: wp.array2d(dtype=float)
    drag_coefficient: wp.array2d(dtype=float)
    pores: wp.array2d(dtype=float)
    soaking_time: wp.array2d(dtype=float)
    fraction: wp.array2d(dtype=float)
    under: wp.array2d(dtype=float)
    soaked: wp.array2d(dtype=float)


@wp.func
def wet(e: int, b: int, share: float, dt: float, damage_fraction: float, flooded: Flooded):
    """Write that this `share` of a thing has been under water for `dt` [s]: for how long now, and its soaked pores."""
    flooded.fraction[e, b] = share
    if share > 0.0 and share >= damage_fraction:
        flooded.under[e, b] = flooded.under[e, b] + dt
    else:
        flooded.under[e, b] = 0.0
    if flooded.pores[e, b] > 0.0:
        dry = 1.0 - flooded.soaked[e, b]
        gained = dry * (1.0 - wp.exp(-dt * share / flooded.soaking_time[e, b]))
        flooded.soaked[e, b] = flooded.soaked[e, b] + gained


@wp.func
def body_at(e: int, b: int, flooded: Flooded, bodies: Bodies) -> floating.Body:
    """A thing as the water finds it."""
    body = floating.Body()
    body.axes = axes_of(bodies.rotation[e, b])
    body.extent = bodies.extent[e, b]
    body.mass = bodies.mass[e, b]
    body.velocity = bodies.velocity[e, b]
    body.spin = bodies.angular_velocity[e, b]
    body.shape = int(flooded.shape[e, b])
    body.drag_coefficient = flooded.drag_coefficient[e, b]
    body.volume = flooded.volume[e, b] * (1.0 - flooded.pores[e, b] * flooded.soaked[e, b])
    return body


@wp.kernel
def rise(
    frame: wp.array(dtype=wp.int64),
    every: int,
    step: float,
    cap: float,
    full: int,
    steep: float,
    length: float,
    longer: float,
    flooded: Flooded,
):
    """Set the level at the source [m] and the slope of the surface, a tangent, of every environment in its `frame`.

    The level rises by `step` [m] `every` so many frames, `full` times, up to the `cap` [m]. Until then the slope is
    `steep`; from then on the wetted `length` [m] gets `longer` [m] at each update.
    """
    e = wp.tid()
    updates = int(frame[e] / wp.int64(every))
    flooded.level[e] = wp.min(step * float(updates), cap)
    beyond = updates - full + 1  # the first is the one that reaches the cap
    flooded.surface_slope[e] = steep
    if beyond > 0:
        flooded.surface_slope[e] = cap * (1.0 / (length + longer * float(beyond)))


@wp.kernel
def tell(
    flooded: Flooded,
    paths: PathArrays,
    place: wp.array2d(dtype=wp.vec3),
    level: wp.array2d(dtype=float),
    direction: wp.array2d(dtype=wp.vec2),
):
    """Write the level of the water [m] at every `place` [m], and the direction of its flow there."""
    e, p = wp.tid()
    found = reach(e, place[e, p][0], place[e, p][1], paths)
    level[e, p] = flooded.level[e] - flooded.surface_slope[e] * found.path_length
    direction[e, p] = found.direction


@wp.kernel
def immerse(dt: float, slabs: bool, damage_fraction: float, flooded: Flooded, paths: PathArrays, bodies: Bodies):
    """Write how much of every thing is under water, for how long it has been, and its soaked pores, after `dt` [s]."""
    e, b = wp.tid()
    share = float(0.0)
    if bodies.exists[e, b] and flooded.level[e] > 0.0:
        level, slope = flooded.level[e], flooded.surface_slope[e]
        axes, centre, extent = axes_of(bodies.rotation[e, b]), bodies.position[e, b], bodies.extent[e, b]
        if slabs:
            base = base_of(centre, axes, extent)
            found = reach(e, base[0], base[1], paths)
            share = slab.immersed_share(level - slope * found.path_length, base[2], spans(axes, extent)[2])
        else:
            found = reach(e, centre[0], centre[1], paths)
            height, kind = level - slope * found.path_length - centre[2], int(flooded.shape[e, b])
            share = immersion(height, -slope * found.direction, axes, 0.5 * extent, kind).fraction
    wet(e, b, share, dt, damage_fraction, flooded)


@wp.kernel
def push(
    dt: float,
    slabs: bool,
    speed: float,
    liquid: floating.Liquid,
    flooded: Flooded,
    paths: PathArrays,
    bodies: Bodies,
    force: wp.array2d(dtype=wp.vec3),
    torque: wp.array2d(dtype=wp.vec3),
):
    """Write force [N] and torque [N m] of water that flows at `speed` [m/s], on every body over the next `dt` [s]."""
    e, b = wp.tid()
    made = floating.Push()
    if bodies.exists[e, b] and bodies.movable[e, b] and flooded.level[e] > 0.0:
        body = body_at(e, b, flooded, bodies)
        centre = bodies.position[e, b]
        place = centre
        if slabs:
            place = base_of(centre, body.axes, body.extent)
        found, slope = reach(e, place[0], place[1], paths), flooded.surface_slope[e]
        surface = flooded.level[e] - slope * found.path_length
        flow = wp.vec3(speed * found.direction[0], speed * found.direction[1], 0.0)
        if slabs:
            box = spans(body.axes, body.extent)
            share = slab.immersed_share(surface, place[2], box[2])
            slip = flow - body.velocity
            made.force = slab.push(share, box, slip, found.direction, body.mass, liquid.gravity, dt)
        else:
            height = surface - centre[2]
            under = immersion(height, -slope * found.direction, body.axes, 0.5 * body.extent, body.shape)
            made = floating.push(liquid, body, under, flow, height, dt)
    force[e, b] = made.force
    torque[e, b] = made.torque
