"""What lies in a container: in the basket of a shopping cart, or on what lies there already.

The basket is an oriented box, given in shares of the cart's own box. Piles: what lies in the axis-aligned box of a settled thing has
settled, too, one layer per call (HAZARD wind/manager.py:113-127, physics.md 1.3). A thing is where the middle of its base is, and in a
basket where its centre is, too: a suitcase may stand in it on its head. Hazards and the record of rescues ask the same question here.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.hazards.air import spans
from hazard_ms.hazards.base import nobody
from hazard_ms.hazards.drag import axes_of, planes, to_body
from hazard_ms.world import World

CATEGORY = "cart"
# The basket in shares of the cart's extent from its centre: 0.46 to 0.885 m of a height of 1.025 m, the handle is at +y [ours].
BASKET_LOW, BASKET_HIGH = (-0.436, -0.435, -0.051), (0.436, 0.371, 0.363)
TOUCH = 0.02  # what rests on a thing, or has sunk a little into the basket's floor, counts as inside [m] [ours]
_BLOCK = 2**16  # pairs of bodies worked on at a time on a CPU: they stay in its cache


def container_index(world: World) -> Tensor:
    """Indices along B of the containers of every scene, padded with -1: [E, C], C at least 1. Scenes are fixed: ask once."""
    rows = [[len(s.bodies) + k for k, f in enumerate(s.fixtures) if f.category == CATEGORY] for s in world.specs]
    width = max(1, *(len(row) for row in rows))
    return torch.tensor([row + [-1] * (width - len(row)) for row in rows], device=world.device)


def in_containers(world: World, containers: Tensor, settled: Tensor) -> Tensor:
    """Bodies that lie in `containers`, [E, C] of `container_index`, or on what has `settled`, [E, B], bool: [E, B], bool.

    What is in a hand or has been put away lies nowhere; what had settled is only listed if it still lies there.
    """
    moving = max(len(s.bodies) for s in world.specs)  # bodies come before fixtures
    found = torch.zeros_like(settled)
    e, cart = torch.arange(len(settled), device=world.device)[:, None], containers.clamp(min=0)
    carts = world.position[e, cart], world.rotation[e, cart], world.extent[e, cart]  # [E, C, 3], [E, C, 4], [E, C, 3]
    if nobody(settled) and nobody(_near(world, carts, moving)):
        return found
    centre = world.position[:, :moving]
    base = world.base_of(centre, world.rotation[:, :moving], world.extent[:, :moving])
    inside = _in_baskets(carts, containers >= 0, base, centre)
    able = world.exists & world.movable & ~world.held & ~world.away
    below = (settled & able)[:, :moving]
    if not nobody(below):
        inside = inside | _on_piles(world, base, below)
    found[:, :moving] = inside
    return found & able


def _near(world: World, carts: tuple[Tensor, Tensor, Tensor], moving: int) -> Tensor:
    """Which of the first M = `moving` bodies may have a point in a cart: position, rotation, extent -> bool, [E, C, M]."""
    place, _, extent = carts
    reach = (extent.sum(-1, keepdim=True) + world.extent[:, None, :moving, 2]).mul_(0.5).add_(2 * TOUCH)
    gap = (world.position[:, None, :moving, :2] - place[:, :, None, :2]).abs_()
    return (gap < reach[..., None]).all(-1)


def _in_baskets(carts: tuple[Tensor, Tensor, Tensor], real: Tensor, *points: Tensor) -> Tensor:
    """Which bodies have one of their `points` [m], each [E, M, 3], in the basket of a cart that is `real`, [E, C]: [E, M], bool."""
    place, turn, extent = (part.movedim(-1, 0) for part in carts)
    offset = torch.stack([p.movedim(-1, 0)[:, :, None] for p in points], 2) - place[:, :, None, :, None]  # [3, E, points, C, M]
    local = to_body(axes_of(turn.movedim(0, -1))[:, :, :, None, :, None], offset)
    low = (extent * extent.new_tensor(BASKET_LOW)[:, None, None]).sub_(TOUCH)[:, :, None, :, None]
    high = (extent * extent.new_tensor(BASKET_HIGH)[:, None, None]).add_(TOUCH)[:, :, None, :, None]
    x, y, z = ((local > low) & (local < high)).unbind()
    return (x & y & z & real[:, None, :, None]).any(2).any(1)


def _on_piles(world: World, base: Tensor, below: Tensor) -> Tensor:
    """Which bodies have their `base` [m], [E, M, 3], in the axis-aligned box of another one of `below`, [E, M]: [E, M], bool."""
    moving = below.shape[1]
    half = spans(axes_of(world.rotation[:, :moving]), planes(world.extent[:, :moving])).mul_(0.5).add_(TOUCH)
    half.masked_fill_(~below, -1.0)  # nothing is in a box of negative size
    points, centres = planes(base), planes(world.position[:, :moving])
    block = len(below) if below.is_cuda else max(1, _BLOCK // moving**2)
    parts = [_within(points[:, k : k + block], centres[:, k : k + block], half[:, k : k + block]) for k in range(0, len(below), block)]
    return torch.cat(parts)


def _within(points: Tensor, centres: Tensor, half: Tensor) -> Tensor:
    """Which `points` are in the box of another index, [E, M], bool; all [m], [3, E, M]."""
    gap = (points[0, :, :, None] - centres[0, :, None]).abs_().sub_(half[0, :, None])
    for axis in (1, 2):
        gap = torch.maximum(gap, (points[axis, :, :, None] - centres[axis, :, None]).abs_().sub_(half[axis, :, None]))
    gap.diagonal(dim1=1, dim2=2).fill_(1.0)
    return (gap < 0.0).any(2)
