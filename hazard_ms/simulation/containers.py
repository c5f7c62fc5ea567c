"""Finds what lies in a container: in the basket of a shopping cart, or on what already lies there.

The basket is an oriented box, given as shares of the cart's own box. In piles, what lies in the axis-aligned box of a
settled thing has settled too, one layer per call (HAZARD wind/manager.py:113-127, docs/physics.md 1.3). A thing lies
where the middle of its base lies; in a basket it also lies where its centre does, since a suitcase may stand in it
upside down. Hazards and the record of rescues use the same functions.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.containers import BASKET_HIGH as BASKET_HIGH
from hazard_ms.simulation.kernels.containers import BASKET_LOW as BASKET_LOW
from hazard_ms.simulation.kernels.containers import find
from hazard_ms.simulation.world import World

CATEGORY = "cart"


def container_index(world: World) -> Tensor:
    """Indices along B of the containers of every scene, padded with -1: [E, C], C at least 1.

    It never changes for a given world, so one call is enough.
    """
    rows = [[len(s.bodies) + k for k, f in enumerate(s.fixtures) if f.category == CATEGORY] for s in world.specs]
    width = max(1, *(len(row) for row in rows))
    return torch.tensor([row + [-1] * (width - len(row)) for row in rows], device=world.device)


def in_containers(world: World, containers: Tensor, settled: Tensor) -> Tensor:
    """Whether each body lies in `containers` [E, C], see `container_index`, or on a `settled` one: bool [E, B].

    `settled`: bool [E, B]. A body in a hand or put away does not lie there; a settled one only if it still does.
    """
    (found,) = world.launches.results(find, settled)
    bodies = world.launches.struct(Bodies, world)
    world.launches.run(find, tuple(settled.shape), containers, settled, bodies, found)
    return found.clone()
