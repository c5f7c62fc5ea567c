"""The places where things were last put down, and which of them something has moved since (torch).

A place is where a thing stood at the start, or where it came to rest within SETTLING after a hand let it go.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.simulation.world import World

MOVED = 0.25  # distance from its place beyond which a thing is no longer there [m] [ours]
SETTLING = 1.0  # time after which what a hand let go has its place [s] [ours: a fall of 1 m takes 0.45 s]


def follow(place: Tensor, rested: Tensor, world: World, dt: float) -> None:
    """Write into `place`, [E, B, 3], where things are [m], world frame, as long as they are in a hand or settle.

    `rested`: time since a hand let each go [s], [E, B], at least SETTLING where none has; `dt` [s] have passed.
    """
    rested.copy_(torch.where(world.held | world.away, 0.0, rested + dt))
    place.copy_(torch.where((rested < SETTLING)[..., None], world.position, place))


def strayed(place: Tensor, world: World) -> Tensor:
    """Whether each thing is farther than MOVED from its `place` [m], [E, B, 3]: bool [E, B]."""
    return (world.position - place).norm(dim=-1) > MOVED
