"""Success and rewards of a rescue, computed from the situation alone, without memory between frames."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.episode.grasp import nearest_target
from hazard_ms.episode.situation import Situation
from hazard_ms.kernels.counting import count
from hazard_ms.simulation.world import World
from hazard_ms.spec import Goal
from hazard_ms.spec.catalogue import DAMAGED_SHARE

PER_RESCUE = 20.0  # reward for each rescued target [docs/benchmark.md 5, RL]
FOR_HOLDING = 0.1  # reward per frame while a target is in the hand [ours]
FOR_NEARNESS = 0.05  # reward per frame at a target, falling off with distance [ours]
LARGEST = PER_RESCUE + FOR_HOLDING + FOR_NEARNESS  # reward of one frame with one rescue at most


class Counts(NamedTuple):
    """The fate of the targets by now, as hazard_ms.kernels.counting tells it."""

    number: Tensor  # int64 [E, 3]: targets, safe ones, others that are damaged
    amount: Tensor  # [E, 2] [-]: value of the safe ones as a share of all, things rescued in this frame


def counts(situation: Situation) -> Counts:
    """The fate of the targets by now; the tensors hold until the next call."""
    known = situation.known
    if known is not None and "counts" in known:
        return known["counts"]
    world, damage, rescue = situation.world, situation.episode.damage, situation.episode.rescue
    made = Counts(*world.launches.once(count, lambda: _room_for_counts(world)))
    things = world.target, world.value, world.safe, damage.damaged
    rescues = rescue.safe, rescue.frame, rescue.damaged, world.frame
    world.launches.run(count, (world.num_envs,), *things, *rescues, DAMAGED_SHARE, *made)
    if known is not None:
        known["counts"] = made
    return made


def _room_for_counts(world: World) -> tuple[Tensor, Tensor]:
    return world.frame.new_zeros(world.num_envs, 3), world.value.new_zeros(world.num_envs, 2)


def targets(situation: Situation) -> Tensor:
    """Number of targets, [E]."""
    return counts(situation).number[:, 0].clone()


def rescued(situation: Situation) -> Tensor:
    """Number of targets that are safe, [E]."""
    return counts(situation).number[:, 1].clone()


def damaged_targets(situation: Situation) -> Tensor:
    """Number of targets that were damaged and are not safe, [E]."""
    return counts(situation).number[:, 2].clone()


def all_rescued(situation: Situation) -> Tensor:
    """Whether there are targets and all of them are safe, bool [E]."""
    number = counts(situation).number
    return (number[:, 0] == number[:, 1]) & (number[:, 0] > 0)


def rescued_value(situation: Situation) -> Tensor:
    """Value of the rescued targets as a share of the value of all, damaged ones counting half, [E]."""
    return counts(situation).amount[:, 0].clone()


def rescued_now(situation: Situation) -> Tensor:
    """Number of targets that became safe in this frame, damaged ones counting half, [E]."""
    return counts(situation).amount[:, 1].clone()


def dense(situation: Situation) -> Tensor:
    """Dense reward, [E]: 20 per rescue, a little for holding a target, less for being near one."""
    _, distance = nearest_target(situation.world, situation.agent.gripper_pose()[0])
    hints = FOR_NEARNESS * (1.0 - torch.tanh(distance)) + FOR_HOLDING * situation.world.held.any(dim=1)
    return PER_RESCUE * counts(situation).amount[:, 1] + hints


def evaluate(goal: Goal, situation: Situation) -> dict[str, Tensor]:
    """The entries of `info` after every frame, [E] each: success, fail, the goal's own numbers, and sim_error.

    If hazards act on the agent, their own entries about it follow.
    """
    world, episode = situation.world, situation.episode
    situation = replace(situation, known={})
    info = {"success": goal.success(situation)}
    info["fail"] = torch.zeros_like(info["success"]) if goal.fail is None else goal.fail(situation)
    info.update({term.name: term.of(situation) for term in goal.info})
    info["sim_error"] = episode.sim_error.clone()
    for hazard in episode.hazards if situation.affects_agent else ():
        info.update(hazard.agent_info(episode.states[hazard.name], world))
    return info
