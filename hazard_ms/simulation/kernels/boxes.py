"""Turned boxes, as functions of kernels (Warp).

`axes` is always the matrix whose columns are a body's own axes in the world frame, `extent` the edges along them [m].
"""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)


@wp.func
def axes_of(rotation: wp.vec4) -> wp.mat33:
    """The rotation matrix of a unit quaternion w x y z: it takes vectors from the body's frame to the world's."""
    w, x, y, z = 2.0 * rotation[0], rotation[1], rotation[2], rotation[3]
    wx, wy, wz = w * x, w * y, w * z
    xx, xy, xz = 2.0 * x * x, 2.0 * x * y, 2.0 * x * z
    yy, yz, zz = 2.0 * y * y, 2.0 * y * z, 2.0 * z * z
    return wp.mat33(
        1.0 - (yy + zz), xy - wz, xz + wy, xy + wz, 1.0 - (xx + zz), yz - wx, xz - wy, yz + wx, 1.0 - (xx + yy)
    )


@wp.func
def to_body(axes: wp.mat33, vector: wp.vec3) -> wp.vec3:
    """Take a vector from the world's frame to the body's."""
    return wp.transpose(axes) * vector


@wp.func
def face_areas(extent: wp.vec3) -> wp.vec3:
    """Areas [m^2] of the faces across a box's axes, from its edges [m]."""
    return wp.vec3(extent[1] * extent[2], extent[0] * extent[2], extent[0] * extent[1])


@wp.func
def spans(axes: wp.mat33, extent: wp.vec3) -> wp.vec3:
    """Edges [m] of the box along the world's axes that encloses a turned box with edges `extent` [m]."""
    a = wp.mat33(
        wp.abs(axes[0, 0]),
        wp.abs(axes[0, 1]),
        wp.abs(axes[0, 2]),
        wp.abs(axes[1, 0]),
        wp.abs(axes[1, 1]),
        wp.abs(axes[1, 2]),
        wp.abs(axes[2, 0]),
        wp.abs(axes[2, 1]),
        wp.abs(axes[2, 2]),
    )
    return a * extent


@wp.func
def base_of(centre: wp.vec3, axes: wp.mat33, extent: wp.vec3) -> wp.vec3:
    """Middle of the base [m] of a box with this `centre` [m]."""
    return centre - axes * wp.vec3(0.0, 0.0, 0.5 * extent[2])


@wp.func
def centre_of(base: wp.vec3, axes: wp.mat33, extent: wp.vec3) -> wp.vec3:
    """Centre [m] of a box with this middle of its `base` [m]."""
    return base + axes * wp.vec3(0.0, 0.0, 0.5 * extent[2])
