"""Pushes for the bodies that move freely, and for no others (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

Vectors = wp.array2d(dtype=wp.vec3)


@wp.kernel
def free_only(bodies: Bodies, force: Vectors, torque: Vectors, kept_force: Vectors, kept_torque: Vectors):
    """Keep `force` [N] and `torque` [N m], [E, B], of movable bodies neither safe nor held; others get none."""
    e, b = wp.tid()
    if bodies.movable[e, b] and not bodies.safe[e, b] and not bodies.held[e, b]:
        kept_force[e, b] = force[e, b]
        kept_torque[e, b] = torque[e, b]
    else:
        kept_force[e, b] = wp.vec3(0.0)
        kept_torque[e, b] = wp.vec3(0.0)
