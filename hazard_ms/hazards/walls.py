"""Whether inner walls of a scene stand between two places (Warp), as hazard_ms.simulation.walls has it for torch.

Both say the same of every pair, bit for bit. In torch each wall, and each doorway in it, takes a dozen operations on
all pairs; a kernel looks only at the walls that a line crosses.
"""

from __future__ import annotations

import torch
import warp as wp
from torch import Tensor

from hazard_ms.simulation.kernels.launch import OPTIONS
from hazard_ms.simulation.walls import Walls

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


@wp.func
def fits(e: int, w: int, along: float, half: float, walls: Partitions) -> bool:
    """Whether the wall `w` of environment `e` is open down to the floor from `along` - `half` to `along` + `half`."""
    for d in range(walls.doorway.shape[1]):
        hole = walls.doorway[e, d]
        if int(hole[0]) == w and hole[3] <= 0.0 and along - half >= hole[1] and along + half <= hole[2]:
            return True
    return False


@wp.kernel
def cut(
    walls: Partitions,
    here: wp.array2d(dtype=wp.vec3),
    there: wp.array2d(dtype=wp.vec3),
    pairs: wp.array3d(dtype=wp.bool),
):
    """Clear those of `pairs`, [E, M, P], between whose places a wall lies."""
    e, m, p = wp.tid()
    if pairs[e, m, p]:
        pairs[e, m, p] = clear(e, here[e, m], there[e, p], walls)


@wp.func
def meets(e: int, x: float, y: float, half: float, walls: Partitions) -> bool:
    """Whether a square of half the edge `half` [m] around `x`, `y` [m] overlaps a wall of environment `e`."""
    for w in range(walls.wall.shape[1]):
        wall = walls.wall[e, w]
        place, along = x, y
        if wall[0] > 0.0:
            place, along = y, x
        if wp.abs(place - wall[1]) < wall[2] + half and not fits(e, w, along, half, walls):
            return True
    return False


@wp.kernel
def touch(
    half: float,
    walls: Partitions,
    x: wp.array2d(dtype=float),
    y: wp.array2d(dtype=float),
    found: wp.array2d(dtype=wp.bool),
):
    """Set `found`, [E, N], to whether squares overlap a wall, see `within`."""
    e, n = wp.tid()
    found[e, n] = meets(e, x[e, n], y[e, n], half, walls)


def cut_off(pairs: Tensor, walls: Walls, here: Tensor, there: Tensor) -> Tensor:
    """`pairs`, bool, [E, M, P], without those between whose places a wall lies; cleared in place.

    Places are `here` [m], [E, M, 3], and `there` [m], [E, P, 3], world frame. Raises ValueError for other shapes.
    """
    count, here_count, there_count = pairs.shape
    for name, places, number in (("here", here, here_count), ("there", there, there_count)):
        if places.shape != (count, number, 3):
            raise ValueError(f"{name} must have the shape [{count}, {number}, 3], got {list(places.shape)}")
    partitions = walls.launches.struct(Partitions, walls)
    walls.launches.run(cut, tuple(pairs.shape), partitions, here.contiguous(), there.contiguous(), pairs)
    return pairs


def within(walls: Walls, x: Tensor, y: Tensor, half: float) -> Tensor:
    """Whether squares of half the edge `half` [m] around `x`, `y` [m], [E, ...], overlap a wall: [E, ...], bool.

    In a doorway, and in what is open of a door, they do not. World frame; `x` and `y` broadcast.
    """
    x, y = torch.broadcast_tensors(x, y)
    flat_x, flat_y = (v.flatten(1).contiguous() for v in (x, y))
    found = torch.empty(flat_x.shape, dtype=torch.bool, device=x.device)
    partitions = walls.launches.struct(Partitions, walls)
    walls.launches.run(touch, tuple(found.shape), half, partitions, flat_x, flat_y, found)
    return found.view(x.shape)
