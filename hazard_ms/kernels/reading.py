"""Bodies as SAPIEN packs them, into the tensors of World."""

from __future__ import annotations

import warp as wp

from hazard_ms.kernels.boxes import axes_of, centre_of
from hazard_ms.launching import OPTIONS

wp.set_module_options(OPTIONS)


@wp.kernel
def unpack(
    packed: wp.array2d(dtype=float),
    row: wp.array(dtype=wp.int64),
    extent: wp.array2d(dtype=wp.vec3),
    position: wp.array2d(dtype=wp.vec3),
    rotation: wp.array2d(dtype=wp.vec4),
    velocity: wp.array2d(dtype=wp.vec3),
    angular_velocity: wp.array2d(dtype=wp.vec3),
):
    """Rotation, base, velocity and angular velocity of every body, at its `row` of 13 numbers; of the first environment."""
    b = wp.tid()
    k = int(row[b])
    turn = wp.vec4(packed[k, 0], packed[k, 1], packed[k, 2], packed[k, 3])
    base = wp.vec3(packed[k, 4], packed[k, 5], packed[k, 6])
    rotation[0, b] = turn
    position[0, b] = centre_of(base, axes_of(turn), extent[0, b])
    velocity[0, b] = wp.vec3(packed[k, 7], packed[k, 8], packed[k, 9])
    angular_velocity[0, b] = wp.vec3(packed[k, 10], packed[k, 11], packed[k, 12])
