"""Gale rescue: bring the targets into carts, or where the wind leaves them, before a gust front turns and doubles it.

What the wind has not moved when time is up counts as rescued, wherever it lies (docs/benchmark.md 1.2): in the lee of a
house, a wall or a car of the wind that blows then. A thing in a cart is safe for good.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import torch
from torch import Tensor

from hazard_ms.hazards.presets import gale
from hazard_ms.scenes import splits
from hazard_ms.spec import Task, Term
from hazard_ms.spec.catalogue import DAMAGED_SHARE
from hazard_ms.spec.severity import USUAL
from hazard_ms.tasks import words
from hazard_ms.tasks.episode.safe_places import CART
from hazard_ms.tasks.rescue import RESCUE, rescue

FAMILY = "gale"
LEE = dataclasses.replace(
    CART, text="a shopping cart, or where the wind does not move it until time is up,", at_rest=True
)


def kept(situation: Any) -> Tensor:
    """Share of the targets' value that is not lost now, damaged targets counting half, [E]."""
    episode, world = situation.episode, situation.world
    (hazard,) = episode.hazards
    damaged = torch.where(world.safe, episode.rescue.damaged, episode.damage.damaged)
    worth = world.value * torch.where(damaged, DAMAGED_SHARE, 1.0)
    here = world.target & ~hazard.carried_off(episode.states[hazard.name], world)
    return torch.where(here, worth, 0.0).sum(1) / torch.where(world.target, world.value, 0.0).sum(1)


GALE = dataclasses.replace(
    RESCUE, info=(*RESCUE.info, Term("kept", kept, "value of the targets that is not lost, of all", low=0.0, high=1.0))
)


def hazard_gale(physics: str = "paper", severity: str = USUAL) -> Task:
    """The task HazardGale-v1 with the physics of a preset. Raises ValueError for unknown names."""
    return dataclasses.replace(
        rescue([gale(physics, severity)]),
        scenes=lambda split: splits.scene_names(split, FAMILY),
        splits=splits.split_names(FAMILY),
        goal=GALE,
        safe_place=LEE,
        text="Put every target into a shopping cart, or in the lee, before wind that turns can carry it away.",
        rewordings=words.GALE,
        averted=True,
        mitigations=("push",),
    )
