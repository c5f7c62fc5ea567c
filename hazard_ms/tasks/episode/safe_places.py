"""Places in which targets are safe: the bag that the agent carries, or the shopping carts of the scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.hazards.base import none_set
from hazard_ms.simulation import containers
from hazard_ms.simulation.world import World
from hazard_ms.spec import SafePlace

BAG_REACH = 0.45  # most from the gripper to the mouth of the bag at which a drop is a rescue [m] [ours]


@dataclass(frozen=True)
class Drop:
    """The drops of the hands of E agents in one frame."""

    dropped: Tensor  # index along B of what was let go, [E], -1 for none
    gripper: Tensor  # position of the hand [m], world frame, [E, 3]
    bag: Callable[[], Tensor]  # gives the mouth of the bag [m], world frame, [E, 3]


Rule = Callable[[Drop], Tensor | None]  # things that are safe now, [E, B], bool; None: none is


def in_bag(world: World) -> Rule:
    """The rule of the bag: what the hand lets go over it is safe; tools do not go into it."""

    def rule(drop: Drop) -> Tensor | None:
        if none_set(drop.dropped >= 0):
            return None
        over = (drop.gripper - drop.bag()).norm(dim=-1) <= BAG_REACH
        inside = torch.arange(world.num_bodies, device=world.device) == torch.where(over, drop.dropped, -1)[:, None]
        return inside if world.equipment is None else inside & ~world.equipment.tool

    return rule


def in_carts(world: World) -> Rule:
    """The rule of the carts: targets that lie in a cart, or on something that does, are safe."""
    carts = containers.container_index(world)

    def rule(drop: Drop) -> Tensor:
        inside = containers.in_containers(world, carts, torch.zeros_like(world.safe))
        if none_set(inside):
            return inside
        return containers.in_containers(world, carts, inside) & world.target  # and what is piled on it

    return rule


BAG = SafePlace("bag", "the bag that you carry", in_bag, carried=True)
CART = SafePlace("cart", "a shopping cart", in_carts, containers=(containers.CATEGORY,))
