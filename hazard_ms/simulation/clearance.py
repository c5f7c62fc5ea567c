"""Finds out what a robot would touch if it were put down somewhere, as things and walls stand now."""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.simulation.building import GLIDE_HEIGHT, partitions
from hazard_ms.simulation.world import World, rotate

TALLEST = 1.4  # height up to which a robot must not touch anything [m]: the G1 is 1.32 tall [ours]
LAYER = 0.02  # between the heights at which its footprint is compared with things [m] [ours]
MARGIN = 0.02  # to everything: PhysX begins to push at a distance of 0.02 m (ManiSkill's contact_offset) [m]
AT_ONCE = 64  # points that are compared with all things at a time [ours]


def in_the_way(world: World, env: int, points: Tensor, radius: float) -> Tensor:
    """The things within `radius` [m] of a robot's axis at each of the `points` [m], [P, 2], as a mask, bool [P, B].

    The axis reaches from the floor to TALLEST, so what hangs closely above a robot is in its way, too. Things count
    with their boxes, but for those in the bag and what a base glides over.
    """
    heights = torch.arange(0.0, TALLEST, LAYER, device=world.device)
    column = torch.cat([points[:, None].expand(-1, len(heights), -1), heights.expand(len(points), -1)[..., None]], -1)
    inverse = world.rotation[env] * world.rotation.new_tensor([1.0, -1.0, -1.0, -1.0])
    offset = column[:, :, None] - world.position[env]  # [P, heights, B, 3]
    local = rotate(inverse.expand(*offset.shape[:-1], 4), offset)
    near = (local.abs() - world.extent[env] / 2).clamp(min=0.0).norm(dim=-1).amin(1) < radius + MARGIN
    flat = ~world.movable[env] & (world.position[env, :, 2] + world.extent[env, :, 2] / 2 < GLIDE_HEIGHT)
    return near & world.exists[env] & ~world.away[env] & ~flat


def in_walls(world: World, env: int, points: Tensor, radius: float) -> Tensor:
    """Whether an upright cylinder of `radius` [m] would touch a wall at each of the `points` [m], [P, 2]: bool [P]."""
    spec, reach = world.specs[env], radius + MARGIN
    low, high = reach - spec.room.beyond, points.new_tensor(spec.room.size) - reach
    touched = ((points < low) | (points > high)).any(-1)
    for centre, half in partitions(spec):
        if centre[2] - half[2] < TALLEST:
            gap = (points - points.new_tensor(centre[:2])).abs() - points.new_tensor(half[:2])
            touched |= gap.clamp(min=0.0).norm(dim=-1) < reach
    return touched


def obstacle(world: World, env: int, point: tuple[float, float], radius: float) -> str:
    """The name of what an upright cylinder of `radius` [m] would touch at `point` [m]; empty if it touches nothing."""
    points = torch.tensor([point], dtype=torch.float32, device=world.device)
    if bool(in_walls(world, env, points, radius)[0]):
        return "a wall"
    touched = torch.nonzero(in_the_way(world, env, points, radius)[0]).flatten().tolist()
    return world.names[env][touched[0]] if touched else ""


def clear_points(world: World, env: int, radius: float, spacing: float) -> Tensor:
    """All points of a grid of `spacing` [m] at which a cylinder of `radius` [m] touches nothing: [P, 2] [m]."""
    x, y = (torch.arange(spacing / 2, size, spacing, device=world.device) for size in world.specs[env].room.size)
    points = torch.cartesian_prod(x, y)
    points = points[~in_walls(world, env, points, radius)]
    clear = [~in_the_way(world, env, part, radius).any(-1) for part in points.split(AT_ONCE)]
    return points[torch.cat(clear)] if clear else points
