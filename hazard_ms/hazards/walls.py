"""Whether inner walls of a scene stand between two places (Warp), as hazard_ms.simulation.walls has it for torch."""

from __future__ import annotations

import warp as wp

from hazard_ms.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

Frame = wp.types.vector(length=5, dtype=float)


@wp.struct
class Partitions:
    """The fields of hazard_ms.simulation.walls.Walls with the same names."""

    wall: wp.array2d(dtype=wp.vec3)
    doorway: wp.array2d(dtype=Frame)


@wp.func
def passes(e: int, w: int, place: float, height: float, walls: Partitions) -> bool:
    """Whether the wall `w` of environment `e` is open at `place` along it and at `height` [m]."""
    for d in range(walls.doorway.shape[1]):
        hole = walls.doorway[e, d]
        if int(hole[0]) == w and place > hole[1] and place < hole[2] and height >= hole[3] and height < hole[4]:
            return True
    return False


@wp.func
def clear(e: int, here: wp.vec3, there: wp.vec3, walls: Partitions) -> bool:
    """Whether no wall of environment `e` lies between two places [m], see `blocked`."""
    for w in range(walls.wall.shape[1]):
        wall = walls.wall[e, w]
        mine, yours = here[0], there[0]
        start, end = here[1], there[1]
        if wall[0] > 0.0:
            mine, yours = here[1], there[1]
            start, end = here[0], there[0]
        if (mine < wall[1]) != (yours < wall[1]):
            share = (wall[1] - mine) / (yours - mine)
            if not passes(e, w, start + share * (end - start), here[2] + share * (there[2] - here[2]), walls):
                return False
    return True
