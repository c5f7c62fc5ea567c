"""The lee of houses and hedges: a map made once per episode, since the mean wind keeps its direction (torch).

From every cell a ray goes upwind over the height map of the fixtures. An obstacle of height H at distance d takes the
share DEEPEST (1 - d / (LEE H)) of the wind, up to half its height; above, the loss falls to nothing at its top. The
deepest loss counts. A fit to measured windbreaks: a quarter of the wind left close behind, all of it back ten heights
downwind [ours]. Limits: no eddies, no jets around corners, and a ray is as thin as a cell, so the lee does not close
behind an end. Cells: E environments, Y by X.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor

from hazard_ms.hazards.fire.floor import half_spans
from hazard_ms.hazards.wind.air import CELL, LOWEST
from hazard_ms.simulation.world import World
from hazard_ms.spec.catalogue import CATEGORIES

LEE = 10.0  # length of the lee in heights of the obstacle [ours]
DEEPEST = 0.75  # share of the wind that a solid obstacle takes [ours]
# Share of the wind that each kind of fixture holds back; 1 for all others [ours]
SOLIDITY = {"cart": 0.0, "street_lamp": 0.0, "tree": 0.5, "hedge": 0.8, "fence": 0.8}
_BLOCK = 2**20  # most cells that are worked on at a time


def map_size(world: World) -> tuple[int, int]:
    """Numbers of cells along y and x that cover every scene of the batch with what lies beyond its sides."""
    rooms = [s.room for s in world.specs]
    x, y = (max(math.ceil((r.size[axis] + 2.0 * r.beyond) / CELL) for r in rooms) for axis in (0, 1))
    return y, x


def south_west(world: World) -> Tensor:
    """South-west corner of each scene's map [m], [E, 2], world frame."""
    return torch.tensor([[-s.room.beyond] * 2 for s in world.specs], device=world.device)


def height_map(world: World, rows: Tensor, shape: tuple[int, int]) -> tuple[Tensor, Tensor]:
    """Height [m] and solidity [-] of the highest sheltering fixture over each cell, both [N, Y, X].

    They are 0 where there is none. `rows` are N indices of environments, `shape` is Y, X.
    """
    corner = south_west(world)[rows]
    y, x = ((torch.arange(n, device=world.device) + 0.5) * CELL for n in shape)
    x, y = corner[:, 0, None, None] + x, corner[:, 1, None, None] + y[:, None]
    table = torch.tensor([SOLIDITY.get(name, 1.0) for name in CATEGORIES], device=world.device)
    solid = torch.where(world.exists & ~world.movable, table[world.category.clamp(min=0)], 0.0)[rows]
    half = half_spans(world.rotation[rows], world.extent[rows])
    high = world.position[rows, :, 2] + half[..., 2]
    counts = (solid > 0.0) & (high >= LOWEST)
    height, solidity = (
        torch.zeros(len(rows), *shape, device=world.device),
        torch.zeros(len(rows), *shape, device=world.device),
    )
    for b in counts.any(0).nonzero().flatten().tolist():  # over the things of a scene, at reset only
        over = (
            _over(x, y, world.position[rows, b], world.rotation[rows, b], world.extent[rows, b])
            & counts[:, b, None, None]
        )
        top = torch.where(over, high[:, b, None, None], 0.0)
        solidity = torch.where(top > height, solid[:, b, None, None], solidity)
        height = torch.maximum(height, top)
    return height, solidity


def _over(x: Tensor, y: Tensor, middle: Tensor, rotation: Tensor, extent: Tensor) -> Tensor:
    """Cells whose middles are within half a cell of the footprint of an upright box per row, [N, Y, X], bool."""
    cosine = 1.0 - 2.0 * (rotation[:, 3] ** 2 + rotation[:, 2] ** 2)
    sine = 2.0 * (rotation[:, 0] * rotation[:, 3] + rotation[:, 1] * rotation[:, 2])
    c, s, mx, my = (v[:, None, None] for v in (cosine, sine, middle[:, 0], middle[:, 1]))
    half_x, half_y = (0.5 * (extent[:, axis, None, None] + CELL) for axis in (0, 1))
    dx, dy = x - mx, y - my
    return ((c * dx + s * dy).abs() < half_x) & ((c * dy - s * dx).abs() < half_y)


def lee(height: Tensor, solidity: Tensor, heading: Tensor) -> tuple[Tensor, Tensor]:
    """Loss of wind near the ground, 0 to DEEPEST [-], and height [m] of what causes it, both [N, Y, X].

    `height` [m] and `solidity` [-], [N, Y, X], are those of `height_map`; `heading` has unit vectors, [N, 2].
    """
    block = max(1, _BLOCK // height[0].numel())
    parts = [slice(k, k + block) for k in range(0, len(height), block)]
    made = [_lee(height[p], solidity[p], heading[p]) for p in parts]
    return torch.cat([m[0] for m in made]), torch.cat([m[1] for m in made])


def _lee(height: Tensor, solidity: Tensor, heading: Tensor) -> tuple[Tensor, Tensor]:
    rows, wide, deep = torch.arange(len(height), device=height.device)[:, None, None], height.shape[2], height.shape[1]
    y, x = (torch.arange(n, device=height.device, dtype=torch.float32) for n in (deep, wide))
    loss, cause = torch.zeros_like(height), torch.zeros_like(height)
    longest = min(math.hypot(wide, deep), LEE * float(height.max()) / CELL)
    for step in range(1, math.ceil(longest) + 1):  # a cell at a time upwind, at reset only
        at_x = (x - step * heading[:, 0, None, None]).round().long()
        at_y = (y[:, None] - step * heading[:, 1, None, None]).round().long()
        there = (at_x >= 0) & (at_x < wide) & (at_y >= 0) & (at_y < deep)
        index = rows, at_y.clamp(0, deep - 1), at_x.clamp(0, wide - 1)
        high = torch.where(there, height[index], 0.0)
        new = DEEPEST * solidity[index] * (1.0 - step * CELL / (LEE * high).clamp(min=CELL)).clamp(min=0.0)
        new = torch.where(high > 0.0, new, 0.0)
        cause = torch.where(new > loss, high, cause)
        loss = torch.maximum(loss, new)
    return loss, cause
