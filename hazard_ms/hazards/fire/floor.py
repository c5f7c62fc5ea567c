"""Floor that can burn: in the room, clear of furniture and of crowds of things, and clear of other fires (torch).

There are E environments with S lattices of K x K cells each (see hazard_ms.hazards.fire.spread) and B things.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.hazards.fire.spread import CELL, STEP
from hazard_ms.hazards.walls import within
from hazard_ms.simulation.world import World, rotate

SHEET = 0.05  # height below which fixtures (rugs) do not stop a fire [m] [ours]
HUNG = 0.3  # height of the lower edge from which fixtures do not stop a fire [m] [ours]
FLAME_LOW, FLAME_HIGH = 0.01, 0.02  # height of the box in which a new flame must fit [m] [HAZARD fire/fire.py:204]
TOUCH = 1e-5  # tolerance, so that a flame that only touches a wall is inside [m]


def centres(anchor: Tensor, window: int) -> tuple[Tensor, Tensor]:
    """Coordinates [m] of the cells' centres along x and y, [E, S, K] each, of lattices at `anchor` [m], [E, S, 2]."""
    steps = STEP * (torch.arange(window, device=anchor.device) - window // 2)
    return anchor[..., 0, None] + steps, anchor[..., 1, None] + steps


def overlap(place: Tensor, other: Tensor) -> Tensor:
    """Whether flames at `place` [m], [E, C, 3], overlap flames at `other` [m], [E, F, 3]: [E, C, F], bool."""
    return (place[:, :, None, :2] - other[:, None, :, :2]).abs().amax(-1) < CELL


def crowd(world: World, place: Tensor) -> Tensor:
    """Number of things, [E, C], that a new flame at `place` [m], [E, C, 3], world frame, would touch.

    They are those whose axis-aligned box overlaps its own.
    """
    half = half_spans(world.rotation, world.extent)
    low, high = world.position - half, world.position + half
    there = world.exists & ~world.safe & (low[..., 2] < FLAME_HIGH) & (high[..., 2] > FLAME_LOW)
    middle = place[:, :, None, :2]
    within = (middle > low[:, None, :, :2] - CELL / 2) & (middle < high[:, None, :, :2] + CELL / 2)  # [E, C, B, 2]
    return (within.all(-1) & there[:, None]).sum(-1)


def half_spans(rotation: Tensor, extent: Tensor) -> Tensor:
    """Half edge lengths [m], [..., 3], of the axis-aligned boxes around turned boxes.

    Their edges are `extent` [m], [..., 3], their `rotation` is a unit quaternion w x y z, [..., 4].
    """
    w, x, y, z = rotation.unbind(-1)
    diagonal = torch.stack([w * w + x * x, w * w + y * y, w * w + z * z], -1).mul_(2.0).sub_(1.0).abs()
    above = torch.stack([x * y - w * z, y * z - w * x, x * z - w * y], -1).mul_(2.0).abs()  # entries 01, 12, 20
    below = torch.stack([x * z + w * y, x * y + w * z, y * z + w * x], -1).mul_(2.0).abs()  # entries 02, 10, 21
    half = 0.5 * extent
    return diagonal * half + above * half.roll(-1, -1) + below * half.roll(-2, -1)


def free_floor(world: World, rows: Tensor, anchor: Tensor, window: int, fixtures_block: bool) -> Tensor:
    """Cells in the room, in no wall, and under no fixture that stands on the floor, [R, S, K, K], bool.

    Those in doors between rooms count as if these were open: `shut` tells which are not. `rows` are R indices of
    environments, `anchor` [m] is [R, S, 2], `window` is K.
    """
    x, y = centres(anchor, window)
    x, y = x[..., None], y[..., None, :]
    wide, deep = world.room[rows, :, None, None, None].unbind(1)
    margin = CELL / 2 - TOUCH
    free = (x >= margin) & (x <= wide - margin) & (y >= margin) & (y <= deep - margin)
    if world.walls.any:
        walls = world.openings.opened if world.openings.inner else world.walls
        free = free & ~within(walls.part(rows), x, y, margin)
    if not fixtures_block:
        return free
    half = half_spans(world.rotation[rows], world.extent[rows])
    lower_edge = world.position[rows, :, 2] - half[..., 2]
    stands = world.exists[rows] & ~world.movable[rows] & (lower_edge < HUNG) & (2.0 * half[..., 2] >= SHEET)
    for b in stands.any(0).nonzero().flatten().tolist():
        box = (world.position[rows, b], world.rotation[rows, b], world.extent[rows, b], half[:, b])
        free = free & ~(_under(x, y, *box) & stands[:, b, None, None, None])
    return free


def shut(world: World, x: Tensor, y: Tensor) -> Tensor:
    """Whether flames at `x`, `y` [m], [E, ...], would be in a closed door, [E, ...], bool."""
    if not world.openings.inner:
        return torch.zeros_like(x, dtype=torch.bool)
    return within(world.walls, x, y, CELL / 2 - TOUCH)


def _under(x: Tensor, y: Tensor, middle: Tensor, rotation: Tensor, extent: Tensor, span: Tensor) -> Tensor:
    """Cells whose square overlaps the footprint of one box per row (separating axes), [R, S, K, K], bool.

    A box that does not stand upright counts with its axis-aligned half edges `span` [m], [R, 3].
    """
    forward = rotate(rotation, rotation.new_tensor([1.0, 0.0, 0.0]).expand_as(middle))
    upright = 1.0 - 2.0 * (rotation[:, 1] ** 2 + rotation[:, 2] ** 2) > 0.99
    half = torch.where(upright[:, None], 0.5 * extent, span)
    cosine, sine = torch.where(upright, forward[:, 0], 1.0), torch.where(upright, forward[:, 1], 0.0)
    columns = (cosine, sine, half[:, 0], half[:, 1], span[:, 0], span[:, 1], middle[:, 0], middle[:, 1])
    c, s, half_x, half_y, span_x, span_y, mx, my = (v[:, None, None, None] for v in columns)
    dx, dy, corner = x - mx, y - my, CELL / 2 * (c.abs() + s.abs())
    over_own_axes = ((c * dx + s * dy).abs() < half_x + corner) & ((c * dy - s * dx).abs() < half_y + corner)
    return over_own_axes & (dx.abs() < span_x + CELL / 2) & (dy.abs() < span_y + CELL / 2)
