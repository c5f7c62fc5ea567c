"""What lies in a container: in the basket of a shopping cart, or on what lies there already.

The basket is an oriented box, given in shares of the cart's own box. Piles: what lies in the axis-aligned box of a settled thing has
settled, too, one layer per call (HAZARD wind/manager.py:113-127, physics.md 1.3). A thing is where the middle of its base is, and in a
basket where its centre is, too: a suitcase may stand in it on its head. Hazards and the record of rescues ask the same question here.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.kernels.containers import find
from hazard_ms.world import World

CATEGORY = "cart"


def container_index(world: World) -> Tensor:
    """Indices along B of the containers of every scene, padded with -1: [E, C], C at least 1. Scenes are fixed: ask once."""
    rows = [[len(s.bodies) + k for k, f in enumerate(s.fixtures) if f.category == CATEGORY] for s in world.specs]
    width = max(1, *(len(row) for row in rows))
    return torch.tensor([row + [-1] * (width - len(row)) for row in rows], device=world.device)


def in_containers(world: World, containers: Tensor, settled: Tensor) -> Tensor:
    """Bodies that lie in `containers`, [E, C] of `container_index`, or on what has `settled`, [E, B], bool: [E, B], bool.

    What is in a hand or has been put away lies nowhere; what had settled is only listed if it still lies there.
    """
    (found,) = world.launches.results(find, settled)
    things = world.exists, world.movable, world.held, world.away, world.position, world.rotation, world.extent
    world.launches.run(find, tuple(settled.shape), containers, settled, *things, found)
    return found.clone()
