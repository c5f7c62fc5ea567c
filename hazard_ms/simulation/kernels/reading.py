"""Bodies as SAPIEN packs them, into the tensors of World (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.boxes import axes_of, centre_of
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)


@wp.kernel
def unpack(
    packed: wp.array2d(dtype=float), row: wp.array(dtype=wp.int64), which: wp.array(dtype=wp.int64), bodies: Bodies
):
    """Write the pose and the velocities of every body of the first environment.

    `packed` has 13 numbers in the `row` of each body, whose index along B is `which`: rotation w x y z, middle of the
    base [m], velocity [m/s] and angular velocity [rad/s], world frame.
    """
    n = wp.tid()
    k, b = int(row[n]), int(which[n])
    rotation = wp.vec4(packed[k, 0], packed[k, 1], packed[k, 2], packed[k, 3])
    base = wp.vec3(packed[k, 4], packed[k, 5], packed[k, 6])
    bodies.rotation[0, b] = rotation
    bodies.position[0, b] = centre_of(base, axes_of(rotation), bodies.extent[0, b])
    bodies.velocity[0, b] = wp.vec3(packed[k, 7], packed[k, 8], packed[k, 9])
    bodies.angular_velocity[0, b] = wp.vec3(packed[k, 10], packed[k, 11], packed[k, 12])
