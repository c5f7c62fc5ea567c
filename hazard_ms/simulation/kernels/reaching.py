"""The target that is nearest to each hand (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.boxes import axes_of, to_body
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)


@wp.func
def gap(point: wp.vec3, centre: wp.vec3, axes: wp.mat33, extent: wp.vec3) -> float:
    """Distance [m] from `point` [m] to the surface of a box with this `centre` [m]; 0 inside."""
    local = to_body(axes, point - centre)
    outside = wp.vec3(
        wp.max(wp.abs(local[0]) - 0.5 * extent[0], 0.0),
        wp.max(wp.abs(local[1]) - 0.5 * extent[1], 0.0),
        wp.max(wp.abs(local[2]) - 0.5 * extent[2], 0.0),
    )
    return wp.length(outside)


@wp.kernel
def hint(
    hand: wp.array(dtype=wp.vec3),
    target: wp.array2d(dtype=bool),
    now: wp.array(dtype=float),
    per_rescue: float,
    for_holding: float,
    for_nearness: float,
    bodies: Bodies,
    reward: wp.array(dtype=float),
):
    """Set the dense `reward`: `per_rescue` for each of the things rescued `now`, for holding one, for being near one.

    The nearness is that of the `hand` [m] to the target that is not safe yet and nearest to it.
    """
    e = wp.tid()
    held, least = float(0.0), float(wp.inf)
    for b in range(target.shape[1]):
        if bodies.held[e, b]:
            held = 1.0
        if target[e, b] and not bodies.safe[e, b]:
            away = gap(hand[e], bodies.position[e, b], axes_of(bodies.rotation[e, b]), bodies.extent[e, b])
            least = wp.min(least, away)
    reward[e] = per_rescue * now[e] + for_holding * held + for_nearness * (1.0 - wp.tanh(least))


@wp.kernel
def nearest(
    hand: wp.array(dtype=wp.vec3),
    target: wp.array2d(dtype=bool),
    bodies: Bodies,
    index: wp.array(dtype=wp.int64),
    distance: wp.array(dtype=float),
):
    """Find the target that is not safe yet and nearest to the `hand` [m] of each environment.

    Sets its `index`, -1 for none, and the `distance` [m] of the hand from the surface of its box, infinite for none.
    """
    e = wp.tid()
    best, least = int(-1), float(wp.inf)
    for b in range(target.shape[1]):
        if target[e, b] and bodies.exists[e, b] and not bodies.safe[e, b]:
            away = gap(hand[e], bodies.position[e, b], axes_of(bodies.rotation[e, b]), bodies.extent[e, b])
            if away < least:
                best, least = b, away
    index[e] = wp.int64(best)
    distance[e] = least
