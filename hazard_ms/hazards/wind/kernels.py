"""The kernels of hazard_ms.hazards.wind.wind, one thread per body or point (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.wind import air as laws
from hazard_ms.simulation.kernels import draws
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.boxes import axes_of, face_areas, spans, to_body
from hazard_ms.simulation.kernels.drag import spin_drag
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

CALM = wp.constant(1e-3)  # slower air does nothing [m/s] [HAZARD wind/object.py:41]
UNIT_VARIANCE = wp.constant(3.0**0.5)  # length of a vector of three numbers of mean square 1


@wp.struct
class Rules:
    """The fields of hazard_ms.hazards.wind.wind.Wind with the same names."""

    implicit: bool
    projected: bool
    crossflow: bool
    fixed_length: bool
    pressure: bool
    sheltered: bool
    gust_intensity: float
    roughness: float
    pavement: float
    lift: float
    plates: bool


@wp.struct
class Air:
    """The fields of WindState with the same names: the flow of each environment, and what each thing feels of it."""

    heading: wp.array(dtype=wp.vec2)
    speed: wp.array(dtype=float)
    gust: wp.array(dtype=float)
    corner: wp.array(dtype=wp.vec2)
    loss: wp.array3d(dtype=float)
    cause: wp.array3d(dtype=float)
    felt: wp.array2d(dtype=float)
    strength: wp.array2d(dtype=float)
    sway: wp.array2d(dtype=wp.vec3)
    twist: wp.array2d(dtype=wp.vec3)
    settled: wp.array2d(dtype=bool)


@wp.func
def open_speed(mean: float, gust: float, height: float, rules: Rules) -> float:
    """Speed of the air along its heading [m/s] at `height` [m] in the open, from its `mean` [m/s] and the `gust`."""
    if rules.roughness == 0.0:
        return mean * (1.0 + rules.gust_intensity * gust)
    blown = laws.gustiness(height, rules.gust_intensity * gust, rules.roughness)
    return mean * blown * laws.profile(height, rules.roughness, rules.pavement)


@wp.func
def speed_at(e: int, point: wp.vec3, rules: Rules, air: Air) -> float:
    """Speed of the air along its heading [m/s] at a `point` [m] of environment `e`, behind what shelters it."""
    here = open_speed(air.speed[e], air.gust[e], point[2], rules)
    if rules.sheltered:
        here = here * laws.share(e, point, air.corner[e], air.loss, air.cause)
    return here


@wp.kernel
def speeds(rules: Rules, air: Air, points: wp.array2d(dtype=wp.vec3), found: wp.array2d(dtype=float)):
    """Write the speed of the air along its heading [m/s] at every one of the `points` [m]."""
    e, p = wp.tid()
    found[e, p] = speed_at(e, points[e, p], rules, air)


@wp.kernel
def topple(
    dt: float,
    toppling: float,
    rising: float,
    chest: float,
    rules: Rules,
    air: Air,
    agent: wp.array(dtype=wp.vec3),
    lies: wp.array(dtype=bool),
    lain: wp.array(dtype=float),
):
    """Let agents fall over where the air at the height `chest` [m] is as fast as `toppling` [m/s].

    They stand up after `rising` [s], and fall again if it still is.
    """
    e = wp.tid()
    time = lain[e] + dt
    if lies[e] and time >= rising:
        lies[e] = False
    if not lies[e]:
        time = 0.0
        lies[e] = speed_at(e, agent[e] + wp.vec3(0.0, 0.0, chest), rules, air) >= toppling
    lain[e] = time


@wp.kernel
def turbulence(
    stream: wp.uint32,
    sideways: float,
    turning: float,
    seed: wp.array(dtype=wp.int64),
    frame: wp.array(dtype=wp.int64),
    rules: Rules,
    air: Air,
    bodies: Bodies,
):
    """Draw new random vectors `sway` and `twist` for a frame.

    `sideways` and `turning` are standard deviations along each axis, that of `twist` in half heights of the body.
    """
    e, b = wp.tid()
    key = draws.key_of(seed[e], frame[e], stream)
    x = draws.normal_pair(key, 3 * b)
    y = draws.normal_pair(key, 3 * b + 1)
    z = draws.normal_pair(key, 3 * b + 2)
    r = wp.vec3(x[0], y[0], z[0])
    if rules.fixed_length:  # a normal vector has no preferred direction
        r = UNIT_VARIANCE * wp.normalize(r)
    along = wp.vec3(air.heading[e][0], air.heading[e][1], 0.0)
    height = spans(axes_of(bodies.rotation[e, b]), bodies.extent[e, b])[2]
    air.sway[e, b] = sideways * wp.cross(along, r)
    air.twist[e, b] = (0.5 * turning * height) * wp.cross(along, wp.vec3(x[1], y[1], z[1]))


@wp.func
def in_uniform_flow(e: int, b: int, dt: float, rules: Rules, air: Air, bodies: Bodies) -> tuple[wp.vec3, wp.vec3]:
    """Force [N] and torque [N m] on a body in the wind at its centre."""
    here = air.felt[e, b] * speed_at(e, bodies.position[e, b], rules, air)
    if wp.abs(here) <= CALM:
        return wp.vec3(), wp.vec3()
    axes, size, mass = axes_of(bodies.rotation[e, b]), bodies.extent[e, b], bodies.mass[e, b]
    direction = wp.vec3(air.heading[e][0], air.heading[e][1], 0.0)
    slip = here - wp.dot(bodies.velocity[e, b], direction)
    if rules.crossflow:
        relative = here * direction - bodies.velocity[e, b]
        slip = wp.length(relative)
        direction = laws.unit(relative)
    across = to_body(axes, direction)
    area = laws.projected_area(across, size)
    if not rules.projected:
        box = spans(axes, size)
        area = box[0] * box[2]
    main = laws.drag(slip, air.strength[e, b] * laws.DENSITY * area, mass, dt, rules.implicit)
    turn = main * air.twist[e, b]
    if rules.pressure:
        turn = turn + main * (axes * laws.pressure_arm(across, size))
        turn = turn + spin_drag(bodies.angular_velocity[e, b], axes, size, mass, laws.DENSITY, dt, 0.0)
    return main * (direction + air.sway[e, b]), turn


@wp.func
def in_profile(e: int, b: int, dt: float, rules: Rules, air: Air, bodies: Bodies) -> tuple[wp.vec3, wp.vec3]:
    """Force [N] and torque [N m] on a body, integrated over its height from its lowest point to its highest.

    Its area across the flow counts as spread evenly over that height: exact for upright boxes. Air that streams over
    what lies on the ground lifts it, too.
    """
    here = air.felt[e, b] * air.speed[e]
    if wp.abs(here) <= CALM:
        return wp.vec3(), wp.vec3()
    axes, size, mass = axes_of(bodies.rotation[e, b]), bodies.extent[e, b], bodies.mass[e, b]
    heading = wp.vec3(air.heading[e][0], air.heading[e][1], 0.0)
    half = 0.5 * spans(axes, size)[2]
    whole, moment, rate = wp.vec3(), wp.vec3(), float(0.0)
    lifted, tilted, rising = float(0.0), float(0.0), float(0.0)
    plate = wp.vec3()
    if rules.plates:
        plate = laws.plate_normal(size)
    normal, face = axes * plate, wp.dot(plate, face_areas(size))
    for k in range(laws.POINTS):
        up = wp.vec3(0.0, 0.0, laws.NODES[k] * half)
        here = air.felt[e, b] * speed_at(e, bodies.position[e, b] + up, rules, air)
        relative = here * heading - bodies.velocity[e, b]
        against = wp.dot(laws.unit(relative), normal)
        area = laws.projected_area(to_body(axes, laws.unit(relative)), size) - face * wp.abs(against)
        pull = laws.WEIGHTS[k] * air.strength[e, b] * laws.DENSITY * wp.length(relative)
        on_face = pull * face * laws.steepness(against) * wp.dot(relative, normal)
        whole += pull * area * relative
        moment += wp.cross(up, pull * area * relative)
        rate += pull * area
        lifted += on_face
        tilted += laws.NODES[k] * half * on_face
        rising += pull * face * laws.steepness(against)
    held, lying = 1.0 / (1.0 + laws.per_mass(rate, mass) * dt), 1.0 / (1.0 + laws.per_mass(rising, mass) * dt)
    main = held * wp.length(whole)
    turn = held * moment + lying * tilted * wp.cross(wp.vec3(0.0, 0.0, 1.0), normal) + main * air.twist[e, b]
    if rules.pressure:
        across = to_body(axes, laws.unit(whole))
        turn = turn + main * (axes * laws.pressure_arm(across, size))
        turn = turn + lying * lifted * (axes * wp.cross(laws.pressure_point(across, size, plate), plate))
        turn = turn + spin_drag(bodies.angular_velocity[e, b], axes, size, mass, laws.DENSITY, dt, 0.0)
    pushed = held * whole + lying * lifted * normal + main * air.sway[e, b]
    return pushed + suction(e, b, half, rules, air, bodies), turn


@wp.func
def suction(e: int, b: int, half: float, rules: Rules, air: Air, bodies: Bodies) -> wp.vec3:
    """Lift [N] on a body of half height `half` [m].

    It is gone where the gap below is as high as the body itself: air that gets in there makes the pressures equal.
    """
    point, axes = bodies.position[e, b], axes_of(bodies.rotation[e, b])
    near = wp.clamp(1.5 - 0.5 * point[2] / wp.max(half, laws.THIN), 0.0, 1.0)
    here = air.felt[e, b] * speed_at(e, point + wp.vec3(0.0, 0.0, half), rules, air)
    over = wp.vec2(here * air.heading[e][0], here * air.heading[e][1])
    over -= wp.vec2(bodies.velocity[e, b][0], bodies.velocity[e, b][1])
    plan = laws.projected_area(to_body(axes, wp.vec3(0.0, 0.0, 1.0)), bodies.extent[e, b])
    return wp.vec3(0.0, 0.0, near * rules.lift * 0.5 * laws.DENSITY * plan * wp.dot(over, over))


@wp.kernel
def push(
    dt: float,
    rules: Rules,
    air: Air,
    bodies: Bodies,
    force: wp.array2d(dtype=wp.vec3),
    torque: wp.array2d(dtype=wp.vec3),
):
    """Write the force [N] and torque [N m] of the wind on every body over the next `dt` [s]."""
    e, b = wp.tid()
    force[e, b] = wp.vec3()
    torque[e, b] = wp.vec3()
    if not bodies.exists[e, b] or not bodies.movable[e, b]:
        return
    if bodies.safe[e, b] or bodies.held[e, b] or air.settled[e, b]:
        return
    if rules.roughness > 0.0:
        pushed, turned = in_profile(e, b, dt, rules, air, bodies)
        force[e, b] = pushed
        torque[e, b] = turned
    else:
        pushed, turned = in_uniform_flow(e, b, dt, rules, air, bodies)
        force[e, b] = pushed
        torque[e, b] = turned
