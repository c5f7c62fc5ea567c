"""Length of the water's path to a place in a room, and direction of its flow there (Warp).

How a room is described, and the part that runs on the host: hazard_ms.hazards.flood.flow_paths.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

NEVER = wp.constant(1e6)  # path length to where water cannot get [m]


@wp.struct
class PathArrays:
    """The fields of hazard_ms.hazards.flood.flow_paths.FlowPaths, as one argument of kernels."""

    flow: wp.array(dtype=wp.vec2)
    origin_length: wp.array(dtype=float)
    partition: wp.array2d(dtype=wp.vec2)
    source_part: wp.array2d(dtype=wp.int64)
    doorway: wp.array2d(dtype=wp.vec4)
    doorway_distance: wp.array2d(dtype=float)
    doorway_part: wp.array3d(dtype=wp.int64)


@wp.struct
class Reach:
    """The path of water to one place."""

    path_length: float  # length of its path from the source wall [m], NEVER where it cannot get
    direction: wp.vec2  # unit vector of its flow


@wp.func
def reach(e: int, x: float, y: float, paths: PathArrays) -> Reach:
    """The path of water to the place `x`, `y` [m] of environment `e`."""
    found = Reach()
    found.direction = paths.flow[e]
    found.path_length = paths.flow[e][0] * x + paths.origin_length[e] + paths.flow[e][1] * y
    part = wp.int64(0)
    for k in range(paths.partition.shape[1]):
        across = x
        if paths.partition[e, k][0] > 0.0:
            across = y
        if across > paths.partition[e, k][1]:
            part |= wp.int64(1) << wp.int64(k)
    if (part & paths.source_part[e, 0]) != paths.source_part[e, 1]:
        found.path_length = NEVER
    for k in range(paths.doorway.shape[1]):
        if ((part ^ paths.doorway_part[e, k, 0]) & ~paths.doorway_part[e, k, 1]) == wp.int64(0):
            box = paths.doorway[e, k]
            offset = wp.vec2(x - wp.clamp(x, box[0], box[2]), y - wp.clamp(y, box[1], box[3]))
            distance = wp.length(offset)
            if paths.doorway_distance[e, k] + distance < found.path_length:
                found.path_length = paths.doorway_distance[e, k] + distance
                if distance > 0.0:
                    found.direction = offset / distance
    return found


@wp.kernel
def path_lengths(
    paths: PathArrays,
    place: wp.array2d(dtype=wp.vec3),
    path_length: wp.array2d(dtype=float),
    direction: wp.array2d(dtype=wp.vec2),
):
    """Write the length [m] of the water's path to every `place` [m], and the direction of its flow there."""
    e, p = wp.tid()
    found = reach(e, place[e, p][0], place[e, p][1], paths)
    path_length[e, p] = found.path_length
    direction[e, p] = found.direction
