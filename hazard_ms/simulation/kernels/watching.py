"""Simulations that broke: numbers that no sound one has (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)


@wp.func
def beyond(value: wp.vec3, centre: wp.vec3, half: wp.vec3) -> bool:
    """Whether `value` is not within `half` of `centre` along each axis; NaN never is."""
    x = wp.abs(value[0] - centre[0]) <= half[0]
    y = wp.abs(value[1] - centre[1]) <= half[1]
    return not (x and y and wp.abs(value[2] - centre[2]) <= half[2])


@wp.func
def no_rotation(rotation: wp.vec4, most: float) -> bool:
    """Whether a number of `rotation` is farther than `most` from 0; NaN always is."""
    w = wp.abs(rotation[0]) <= most and wp.abs(rotation[1]) <= most
    return not (w and wp.abs(rotation[2]) <= most and wp.abs(rotation[3]) <= most)


@wp.kernel
def broken(
    centre: wp.array(dtype=wp.vec3),
    half: wp.array(dtype=wp.vec3),
    joints: wp.array2d(dtype=float),
    turned: float,
    fastest: float,
    spinning: float,
    bodies: Bodies,
    known: wp.array(dtype=bool),
    fresh: wp.array(dtype=bool),
):
    """Mark environments in which a body that moves, or a joint, has a number that none can have.

    Those that are not yet `known` are `fresh`; then all of them are known.

    Places are within `half` of `centre` [m]; the others are at most `turned` (of a rotation), `fastest` [m/s] and
    `spinning` [rad/s] along each axis; `joints` are finite.
    """
    e = wp.tid()
    bad = bool(False)
    zero = wp.vec3(0.0, 0.0, 0.0)
    speed, spin = wp.vec3(fastest, fastest, fastest), wp.vec3(spinning, spinning, spinning)
    for b in range(bodies.exists.shape[1]):
        watched = bodies.exists[e, b] and bodies.movable[e, b] and not bodies.away[e, b] and not bodies.held[e, b]
        if watched:
            bad = bad or beyond(bodies.position[e, b], centre[e], half[e]) or no_rotation(bodies.rotation[e, b], turned)
            bad = bad or beyond(bodies.velocity[e, b], zero, speed)
            bad = bad or beyond(bodies.angular_velocity[e, b], zero, spin)
    for j in range(joints.shape[1]):
        bad = bad or not wp.isfinite(joints[e, j])
    fresh[e] = bad and not known[e]
    known[e] = known[e] or bad
