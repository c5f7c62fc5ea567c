"""The water of the HAZARD challenge's code: a slab of each bounding box is immersed, and drag is linear (Warp).

    lift  400 g V_slab          the original's impulse 4 g V per frame of 0.01 s
    drag  200 A (flow - v)      its impulse 2 A (u - v) per frame; A: height of the box times its width across the flow

So the original's water has 0.4 of water's density, on the box along the world's axes (docs/physics.md 0.1, 1.2). At the
centre of mass: nothing turns. A step never takes more than the whole slip, and lift is limited as in
hazard_ms.hazards.flood.floating: the original's could blow up. `box` is always the edges of the bounding box along the
world's axes [m], hazard_ms.simulation.kernels.boxes.spans.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

LIFT = wp.constant(400.0)  # effective density of water [kg/m^3] [HAZARD flood/object.py:277]
DRAG = wp.constant(200.0)  # force per area and slip [N s/m^3] [HAZARD flood/object.py:281-290]

_TINY = wp.constant(1e-9)  # least height [m] and mass [kg], so that 0 / 0 cannot occur


@wp.func
def immersed_share(level: float, base: float, high: float) -> float:
    """Share, 0 to 1, of a slab from its `base` [m] to `high` [m] above it that is under the `level` [m]."""
    return wp.clamp((level - base) / wp.max(high, _TINY), 0.0, 1.0)


@wp.func
def push(share: float, box: wp.vec3, slip: wp.vec3, flow: wp.vec2, mass: float, gravity: float, dt: float) -> wp.vec3:
    """Force of the water on a body [N], world frame.

    Args:
        share: Share of the box that is immersed.
        box: Edges of the bounding box [m].
        slip: Velocity of the water relative to the body [m/s].
        flow: Unit vector of the flow, along x or y for the most part.
        mass: Mass of the body [kg].
        gravity: Acceleration of gravity [m/s^2].
        dt: Length of the physics step [s].
    """
    if share <= 0.0:
        return wp.vec3()
    m, base = wp.max(mass, _TINY), box[0] * box[1]
    across = box[0] * wp.abs(flow[1]) + box[1] * wp.abs(flow[0])
    grip = wp.min(DRAG * box[2] * across, m / dt)
    stiff = LIFT * gravity * base * dt * dt / m
    lift, weight = LIFT * gravity * base * box[2] * share, m * gravity
    return slip * grip + wp.vec3(0.0, 0.0, (lift - weight) / wp.max(stiff, 1.0) + weight)
