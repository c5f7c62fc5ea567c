"""Success, information and rewards of a rescue task, from the world alone: no memory between frames."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch
from torch import Tensor

from hazard_ms.catalogue import DAMAGED_SHARE
from hazard_ms.hand import distance_to_boxes

if TYPE_CHECKING:
    from hazard_ms.env import HazardEnv

PER_RESCUE = 20.0  # benchmark.md 5, RL: reward per object rescued
HOLDING = 0.1  # per frame while a target is in the hand [ours]
NEAR = 0.05  # per frame at a target, falling off with distance [ours]
LARGEST = PER_RESCUE + HOLDING + NEAR  # of one frame


def evaluate(env: HazardEnv) -> dict[str, Tensor]:
    """What `info` holds after every frame; all [E]."""
    world = env.world
    left = (world.target & ~world.safe).any(dim=1)
    worth = torch.where(env.episode.rescue.damaged, DAMAGED_SHARE, 1.0) * world.value
    total = (world.value * world.target).sum(1).clamp(min=1.0)
    info = {
        "success": ~left & world.target.any(dim=1),
        "fail": torch.zeros_like(left),  # a rescue task cannot be lost: what burns may still be saved, for half its value
        "rescued": (world.safe & world.target).sum(1),
        "targets": world.target.sum(1),
        "value": (worth * (world.safe & world.target)).sum(1) / total,
        "damaged": (env.episode.damage.damaged & world.target & ~world.safe).sum(1),
        "sim_error": env.episode.sim_error.clone(),
    }
    for hazard in env.task.hazards:
        info.update(hazard.agent_info(env.episode.states[hazard.name], world) if env.affects_agent else {})
    return info


def rescued_now(env: HazardEnv) -> Tensor:
    """How many targets became safe in this frame, each counting 1, or half if damaged, [E]."""
    new = env.episode.rescue.safe & (env.episode.rescue.frame == env.world.frame[:, None])
    return (new * torch.where(env.episode.rescue.damaged, DAMAGED_SHARE, 1.0)).sum(1)


def sparse(env: HazardEnv) -> Tensor:
    """One per target rescued in this frame, half if it was damaged, [E]."""
    return rescued_now(env)


def dense(env: HazardEnv) -> Tensor:
    """20 per rescue, a little for holding, less for being near a target, [E]."""
    world = env.world
    gripper, _ = env.agent.gripper_pose()
    distance = torch.where(world.target & ~world.safe, distance_to_boxes(world, gripper), torch.inf).amin(dim=1)
    near = torch.where(distance.isfinite(), 1.0 - torch.tanh(distance.nan_to_num(posinf=0.0)), 0.0)
    return PER_RESCUE * rescued_now(env) + HOLDING * world.held.any(dim=1) + NEAR * near
