"""Blows that things take as they fly or slide into one another, into walls or onto the ground (Warp).

A blow changes a thing's velocity within a physics step. Over a frame it is what the velocity jumps by, where it jumps
by more than weight, friction and wind can have changed it. Its energy is m dv^2 / 2.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.wind import air as laws
from hazard_ms.hazards.wind.kernels import Air, Rules, speed_at
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

GRAVITY = wp.constant(9.81)  # [m/s^2]
# How far a change of velocity must surpass what weight, friction and wind can do to count as a blow [-] [ours]
CLEARLY = wp.constant(2.0)


@wp.func
def by_air(e: int, b: int, dt: float, before: wp.vec3, rules: Rules, air: Air, bodies: Bodies) -> float:
    """Most that the air changes the velocity of a body by in `dt` [m/s]; `before`: its velocity [m/s]."""
    here = air.felt[e, b] * speed_at(e, bodies.position[e, b], rules, air)
    slip = wp.length(wp.vec3(here * air.heading[e][0], here * air.heading[e][1], 0.0) - before)
    size = bodies.extent[e, b]
    area = wp.max(size[0] * size[1], wp.max(size[1] * size[2], size[0] * size[2]))
    rate = laws.per_mass(air.strength[e, b] * laws.DENSITY * area * slip, bodies.mass[e, b])
    return slip * wp.min(rate * dt, 1.0)


@wp.kernel
def strike(
    dt: float,
    rules: Rules,
    air: Air,
    bodies: Bodies,
    before: wp.array2d(dtype=wp.vec3),
    struck: wp.array2d(dtype=float),
):
    """Write the energy of the blow [J] that each thing took in the last frame of `dt` [s], and its velocity after it.

    `before` are the velocities a frame ago [m/s]. What is held or safe takes none.
    """
    e, b = wp.tid()
    now = bodies.velocity[e, b]
    jump = wp.length(now - before[e, b])
    energy = float(0.0)
    free = bodies.exists[e, b] and bodies.movable[e, b] and not bodies.safe[e, b] and not bodies.held[e, b]
    if free and jump > CLEARLY * GRAVITY * dt:
        usual = 2.0 * GRAVITY * dt + by_air(e, b, dt, before[e, b], rules, air, bodies)
        if jump > CLEARLY * usual:
            energy = 0.5 * bodies.mass[e, b] * jump * jump
    struck[e, b] = energy
    before[e, b] = now
