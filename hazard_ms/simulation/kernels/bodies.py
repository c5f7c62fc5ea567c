"""The bodies of all environments as one argument of kernels (Warp).

Warp passes structs to functions by value: give a function what it needs of a body, not the whole struct of arrays.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)


@wp.struct
class Bodies:
    """The fields of hazard_ms.simulation.world.World with the same names, [E, B]: world frame, SI units."""

    exists: wp.array2d(dtype=bool)
    movable: wp.array2d(dtype=bool)
    safe: wp.array2d(dtype=bool)
    held: wp.array2d(dtype=bool)
    away: wp.array2d(dtype=bool)
    position: wp.array2d(dtype=wp.vec3)
    rotation: wp.array2d(dtype=wp.vec4)
    velocity: wp.array2d(dtype=wp.vec3)
    angular_velocity: wp.array2d(dtype=wp.vec3)
    extent: wp.array2d(dtype=wp.vec3)
    mass: wp.array2d(dtype=float)
