"""The kernels of hazard_ms.hazards.wind: a thread per body or point. Their arguments are quantities of WindState and World, by name."""

from __future__ import annotations

import warp as wp

from hazard_ms.kernels import air, draws
from hazard_ms.kernels.boxes import axes_of, spans, to_body
from hazard_ms.kernels.drag import spin_drag
from hazard_ms.launching import OPTIONS

wp.set_module_options(OPTIONS)

CALM = wp.constant(1e-3)  # slower air does nothing [m/s] [C object.py:41]
UNIT_VARIANCE = wp.constant(3.0**0.5)  # length of a vector of three numbers of mean square 1


@wp.func
def speed_at(
    e: int,
    point: wp.vec3,
    gust_intensity: float,
    roughness: float,
    sheltered: bool,
    speed: wp.array(dtype=float),
    gust: wp.array(dtype=float),
    corner: wp.array(dtype=wp.vec2),
    loss: wp.array3d(dtype=float),
    cause: wp.array3d(dtype=float),
) -> float:
    """Speed of the air along its heading [m/s] at a `point` [m] of the environment `e`."""
    here = speed[e] * (1.0 + gust_intensity * gust[e])
    if roughness > 0.0:
        here = here * air.profile(point[2], roughness)
    if sheltered:
        here = here * air.share(e, point, corner[e], loss, cause)
    return here


@wp.kernel
def speeds(
    gust_intensity: float,
    roughness: float,
    sheltered: bool,
    speed: wp.array(dtype=float),
    gust: wp.array(dtype=float),
    corner: wp.array(dtype=wp.vec2),
    loss: wp.array3d(dtype=float),
    cause: wp.array3d(dtype=float),
    points: wp.array2d(dtype=wp.vec3),
    found: wp.array2d(dtype=float),
):
    """Speed of the air along its heading [m/s] at every one of the `points` [m]."""
    e, p = wp.tid()
    found[e, p] = speed_at(e, points[e, p], gust_intensity, roughness, sheltered, speed, gust, corner, loss, cause)


@wp.kernel
def turbulence(
    stream: wp.uint32,
    fixed_length: bool,
    sideways: float,
    turning: float,
    seed: wp.array(dtype=wp.int64),
    frame: wp.array(dtype=wp.int64),
    heading: wp.array(dtype=wp.vec2),
    rotation: wp.array2d(dtype=wp.vec4),
    extent: wp.array2d(dtype=wp.vec3),
    sway: wp.array2d(dtype=wp.vec3),
    twist: wp.array2d(dtype=wp.vec3),
):
    """New random vectors r and r' for a frame; `sideways`, `turning`: standard deviations along each axis, of the height for r'."""
    e, b = wp.tid()
    key = draws.key_of(seed[e], frame[e], stream)
    x = draws.normal_pair(key, 3 * b)
    y = draws.normal_pair(key, 3 * b + 1)
    z = draws.normal_pair(key, 3 * b + 2)
    r = wp.vec3(x[0], y[0], z[0])
    if fixed_length:  # a normal vector has no preferred direction
        r = UNIT_VARIANCE * wp.normalize(r)
    along = wp.vec3(heading[e][0], heading[e][1], 0.0)
    high = spans(axes_of(rotation[e, b]), extent[e, b])[2]
    sway[e, b] = sideways * wp.cross(along, r)
    twist[e, b] = (0.5 * turning * high) * wp.cross(along, wp.vec3(x[1], y[1], z[1]))


@wp.kernel
def push(
    dt: float,
    implicit: bool,
    projected: bool,
    crossflow: bool,
    pressure: bool,
    gust_intensity: float,
    roughness: float,
    sheltered: bool,
    speed: wp.array(dtype=float),
    gust: wp.array(dtype=float),
    corner: wp.array(dtype=wp.vec2),
    loss: wp.array3d(dtype=float),
    cause: wp.array3d(dtype=float),
    heading: wp.array(dtype=wp.vec2),
    felt: wp.array2d(dtype=float),
    strength: wp.array2d(dtype=float),
    sway: wp.array2d(dtype=wp.vec3),
    twist: wp.array2d(dtype=wp.vec3),
    settled: wp.array2d(dtype=bool),
    exists: wp.array2d(dtype=bool),
    movable: wp.array2d(dtype=bool),
    safe: wp.array2d(dtype=bool),
    held: wp.array2d(dtype=bool),
    position: wp.array2d(dtype=wp.vec3),
    rotation: wp.array2d(dtype=wp.vec4),
    velocity: wp.array2d(dtype=wp.vec3),
    angular_velocity: wp.array2d(dtype=wp.vec3),
    extent: wp.array2d(dtype=wp.vec3),
    mass: wp.array2d(dtype=float),
    force: wp.array2d(dtype=wp.vec3),
    torque: wp.array2d(dtype=wp.vec3),
):
    """Force [N] and torque [N m] of the wind on every body, over the next `dt` [s]."""
    e, b = wp.tid()
    force[e, b] = wp.vec3()
    torque[e, b] = wp.vec3()
    if not exists[e, b] or not movable[e, b] or safe[e, b] or held[e, b] or settled[e, b]:
        return
    here = felt[e, b] * speed_at(e, position[e, b], gust_intensity, roughness, sheltered, speed, gust, corner, loss, cause)
    if wp.abs(here) <= CALM:
        return
    axes, size = axes_of(rotation[e, b]), extent[e, b]
    direction = wp.vec3(heading[e][0], heading[e][1], 0.0)
    slip = here - wp.dot(velocity[e, b], direction)
    if crossflow:
        relative = here * direction - velocity[e, b]
        slip = wp.length(relative)
        direction = air.unit(relative)
    across = to_body(axes, direction)
    area = air.projected_area(across, size)
    if not projected:
        box = spans(axes, size)
        area = box[0] * box[2]
    main = air.drag(slip, strength[e, b] * air.DENSITY * area, mass[e, b], dt, implicit)
    turn = main * twist[e, b]
    if pressure:
        turn = turn + main * (axes * air.pressure_arm(across, size))
        turn = turn + spin_drag(angular_velocity[e, b], axes, size, mass[e, b], air.DENSITY, dt, 0.0)
    force[e, b] = main * (direction + sway[e, b])
    torque[e, b] = turn
