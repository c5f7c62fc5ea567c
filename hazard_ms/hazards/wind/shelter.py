"""The lee of houses, hedges and cars: a map made once per episode, since the mean wind keeps its direction (torch).

From every cell a ray goes upwind over the height map of the fixtures. What it meets takes the share of the wind that
hazard_ms.hazards.wind.wakes gives for its height, shape and width, at most DEEPEST, up to half its height; above, the
loss falls to nothing at its top. The deepest loss counts. Fixtures that touch, such as the pieces of a hedge, are as
wide as they are together. Limits: no eddies, no jets around corners, nothing is lost beside the ends of an obstacle or
above it. Cells: E environments, Y by X.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor

from hazard_ms.hazards.fire.floor import half_spans
from hazard_ms.hazards.wind import wakes
from hazard_ms.hazards.wind.air import CELL, LOWEST
from hazard_ms.simulation.kernels.launch import Launches
from hazard_ms.simulation.world import World
from hazard_ms.spec.catalogue import CATEGORIES

DEEPEST = 0.75  # largest share of the wind that a solid obstacle takes, where air turns round behind it [ours]
# Coefficients of the wakes of fences and of blunt blocks [Taylor & Salmon 1993: 0.8 for fences, 0.25 to 0.4 for long
# low buildings, 0.2 to 0.35 for cubes], and thicknesses in heights up to and from which they hold: air that has
# passed over an edge comes down again on a roof as deep as high [Hosker 1984: from 0.3 to 1]
FENCE, BLOCK, THIN, THICK = 0.8, 0.3, 0.3, 1.0
# Share of the wind that each kind of fixture holds back; 1 for all others [ours]
SOLIDITY = {"cart": 0.0, "street_lamp": 0.0, "tree": 0.5, "hedge": 0.8, "fence": 0.8}


def map_size(world: World) -> tuple[int, int]:
    """Numbers of cells along y and x that cover every scene of the batch with what lies beyond its sides."""
    rooms = [s.room for s in world.specs]
    x, y = (max(math.ceil((r.size[axis] + 2.0 * r.beyond) / CELL) for r in rooms) for axis in (0, 1))
    return y, x


def south_west(world: World) -> Tensor:
    """South-west corner of each scene's map [m], [E, 2], world frame."""
    return torch.tensor([[-s.room.beyond] * 2 for s in world.specs], device=world.device)


def height_map(world: World, rows: Tensor, shape: tuple[int, int]) -> tuple[Tensor, Tensor, Tensor]:
    """Height [m], solidity and coefficient of the wake [-] of the highest sheltering fixture over each cell.

    All [N, Y, X], and 0 where there is none. `rows` are N indices of environments, `shape` is Y, X.
    """
    corner = south_west(world)[rows]
    y, x = ((torch.arange(n, device=world.device) + 0.5) * CELL for n in shape)
    x, y = corner[:, 0, None, None] + x, corner[:, 1, None, None] + y[:, None]
    table = torch.tensor([SOLIDITY.get(name, 1.0) for name in CATEGORIES], device=world.device)
    solid = torch.where(world.exists & ~world.movable, table[world.category.clamp(min=0)], 0.0)[rows]
    half = half_spans(world.rotation[rows], world.extent[rows])
    high = world.position[rows, :, 2] + half[..., 2]
    counts = (solid > 0.0) & (high >= LOWEST)
    blunt = ((world.extent[rows, :, :2].amin(-1) / high.clamp(min=LOWEST) - THIN) / (THICK - THIN)).clamp(0.0, 1.0)
    wake = solid * (FENCE + (BLOCK - FENCE) * blunt)
    height, solidity, coefficient = torch.zeros(3, len(rows), *shape, device=world.device).unbind()
    for b in counts.any(0).nonzero().flatten().tolist():  # over the things of a scene, at reset only
        over = (
            _over(x, y, world.position[rows, b], world.rotation[rows, b], world.extent[rows, b])
            & counts[:, b, None, None]
        )
        top = torch.where(over, high[:, b, None, None], 0.0)
        solidity = torch.where(top > height, solid[:, b, None, None], solidity)
        coefficient = torch.where(top > height, wake[:, b, None, None], coefficient)
        height = torch.maximum(height, top)
    return height, solidity, coefficient


def _over(x: Tensor, y: Tensor, middle: Tensor, rotation: Tensor, extent: Tensor) -> Tensor:
    """Cells whose middles are within half a cell of the footprint of an upright box per row, [N, Y, X], bool."""
    cosine = 1.0 - 2.0 * (rotation[:, 3] ** 2 + rotation[:, 2] ** 2)
    sine = 2.0 * (rotation[:, 0] * rotation[:, 3] + rotation[:, 1] * rotation[:, 2])
    c, s, mx, my = (v[:, None, None] for v in (cosine, sine, middle[:, 0], middle[:, 1]))
    half_x, half_y = (0.5 * (extent[:, axis, None, None] + CELL) for axis in (0, 1))
    dx, dy = x - mx, y - my
    return ((c * dx + s * dy).abs() < half_x) & ((c * dy - s * dx).abs() < half_y)


def lee(
    world: World | None, height: Tensor, solidity: Tensor, coefficient: Tensor, heading: Tensor
) -> tuple[Tensor, Tensor]:
    """Loss of wind near the ground, 0 to DEEPEST [-], and height [m] of what causes it, both [N, Y, X].

    `height` [m], `solidity` and `coefficient` [-], [N, Y, X], are those of `height_map`; `heading` has unit vectors,
    [N, 2]. The kernels run in the launches of `world`, or where that is None in new ones.
    """
    launches = Launches() if world is None else world.launches
    heading, nowhere = heading.contiguous(), torch.full_like(height, math.inf)
    right, left, ends = nowhere, -nowhere, (nowhere.clone(), -nowhere)
    for _ in range(sum(height.shape[1:])):  # an end is known to cells that are so many steps away, at reset only
        launches.run(wakes.widen, tuple(height.shape), heading, height, right, left, *ends)
        if height.device.type == "cpu" and torch.equal(right, ends[0]) and torch.equal(left, ends[1]):
            break
        (right, left), ends = ends, (right, left)
    loss, cause = torch.empty_like(height), torch.empty_like(height)
    maps = height, solidity, coefficient, right, left
    launches.run(wakes.lee, tuple(height.shape), DEEPEST, heading, *maps, loss, cause)
    return loss, cause
