"""Success and rewards of a rescue, computed from the situation alone, without memory between frames."""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.episode.grasp import distance_to_boxes
from hazard_ms.episode.situation import Situation
from hazard_ms.hazards.base import none_set
from hazard_ms.spec import Goal
from hazard_ms.spec.catalogue import DAMAGED_SHARE

PER_RESCUE = 20.0  # reward for each rescued target [docs/benchmark.md 5, RL]
FOR_HOLDING = 0.1  # reward per frame while a target is in the hand [ours]
FOR_NEARNESS = 0.05  # reward per frame at a target, falling off with distance [ours]
LARGEST = PER_RESCUE + FOR_HOLDING + FOR_NEARNESS  # reward of one frame with one rescue at most


def all_rescued(situation: Situation) -> Tensor:
    """Whether there are targets and all of them are safe, bool [E]."""
    world = situation.world
    return ~(world.target & ~world.safe).any(dim=1) & world.target.any(dim=1)


def damaged_targets(situation: Situation) -> Tensor:
    """Number of targets that were damaged and are not safe, [E]."""
    world = situation.world
    return (situation.episode.damage.damaged & world.target & ~world.safe).sum(1)


def rescued_value(situation: Situation) -> Tensor:
    """Value of the rescued targets as a share of the value of all, damaged ones counting half, [E]."""
    world = situation.world
    saved = world.safe & world.target
    if none_set(saved):
        return torch.zeros(len(saved), device=saved.device)
    worth = torch.where(situation.episode.rescue.damaged, DAMAGED_SHARE, 1.0) * world.value
    total = (world.value * world.target).sum(1).clamp(min=1.0)
    return (worth * saved).sum(1) / total


def rescued_now(situation: Situation) -> Tensor:
    """Number of targets that became safe in this frame, damaged ones counting half, [E]."""
    rescue = situation.episode.rescue
    new = rescue.safe & (rescue.frame == situation.world.frame[:, None])
    if none_set(new):
        return torch.zeros(len(new), device=new.device)
    return (new * torch.where(rescue.damaged, DAMAGED_SHARE, 1.0)).sum(1)


def dense(situation: Situation) -> Tensor:
    """Dense reward, [E]: 20 per rescue, a little for holding a target, less for being near one."""
    world = situation.world
    gripper, _ = situation.agent.gripper_pose()
    distance = torch.where(world.target & ~world.safe, distance_to_boxes(world, gripper), torch.inf).amin(dim=1)
    near = torch.where(distance < torch.inf, 1.0 - torch.tanh(distance), 0.0)
    return PER_RESCUE * rescued_now(situation) + FOR_HOLDING * world.held.any(dim=1) + FOR_NEARNESS * near


def evaluate(goal: Goal, situation: Situation) -> dict[str, Tensor]:
    """The entries of `info` after every frame, [E] each: success, fail, the goal's own numbers, and sim_error.

    If hazards act on the agent, their own entries about it follow.
    """
    world, episode = situation.world, situation.episode
    info = {"success": goal.success(situation)}
    info["fail"] = torch.zeros_like(info["success"]) if goal.fail is None else goal.fail(situation)
    info.update({term.name: term.of(situation) for term in goal.info})
    info["sim_error"] = episode.sim_error.clone()
    for hazard in episode.hazards if situation.affects_agent else ():
        info.update(hazard.agent_info(episode.states[hazard.name], world))
    return info
