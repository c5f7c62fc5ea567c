"""Meaning of the ids in a renderer's segmentation: things by their index along B, and everything else."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch
from torch import Tensor

from hazard_ms.sensing.camera import AGENT, NOTHING, STRUCTURE
from hazard_ms.simulation.world import World

OTHERS = {STRUCTURE: "structure", AGENT: "agent", NOTHING: "nothing"}  # names of what is not a thing


def labels_of(
    scene: Any, things: Sequence[Sequence[Any]], robots: Sequence[Any], bags: Sequence[Sequence[Any]]
) -> Tensor:
    """Labels of the renderer's ids, int64 [E, S]: indices along B, or STRUCTURE, AGENT, NOTHING.

    `scene`: ManiSkill's scene; `things`: the actors of each environment, bodies then fixtures; `robots`: the agents;
    `bags`: of each robot the actor of each environment's bag, labelled AGENT, as all robots are.
    """
    highest = max(e.per_scene_id for s in scene.sub_scenes for e in s.entities)
    labels = torch.full((len(things), highest + 1), STRUCTURE, dtype=torch.int64, device=scene.device)
    labels[:, 0] = NOTHING
    links = [[part.entity.per_scene_id for part in link._objs] for robot in robots for link in robot.links]
    for e, row in enumerate(things):
        ids = [actor._objs[0].per_scene_id for actor in row]
        labels[e, torch.tensor(ids)] = torch.arange(len(row), device=scene.device)
        labels[e, torch.tensor([of[e] for of in links])] = AGENT
    for e, bag in (pair for row in bags for pair in enumerate(row)):
        labels[e, bag._objs[0].per_scene_id] = AGENT
    return labels


def label_table(world: World, labels: Tensor, env: int) -> dict[int, tuple[str, str]]:
    """Name and category of each id of the `labels` [E, S] in scene `env`.

    Both are "structure", "agent" or "nothing" for what is not a thing.
    """
    things = world.specs[env].things
    table = {}
    for number, label in enumerate(labels[env].tolist()):
        name, category = (things[label].name, things[label].category) if label >= 0 else (OTHERS[label], OTHERS[label])
        table[number] = (name, category)
    return table
