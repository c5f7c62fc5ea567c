"""Success and rewards of a rescue, computed from the situation alone, without memory between frames."""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.counting import count
from hazard_ms.simulation.kernels.reaching import hint
from hazard_ms.simulation.world import World
from hazard_ms.spec import Goal
from hazard_ms.spec.catalogue import DAMAGED_SHARE
from hazard_ms.tasks.episode.situation import Situation

PER_RESCUE = 20.0  # reward for each rescued target [docs/benchmark.md 5, RL]
FOR_HOLDING = 0.1  # reward per frame while a target is in the hand [ours]
FOR_NEARNESS = 0.05  # reward per frame at a target, falling off with distance [ours]
LARGEST = PER_RESCUE + FOR_HOLDING + FOR_NEARNESS  # reward of one frame with one rescue at most


class Counts(NamedTuple):
    """The fate of the targets by now, [E] each, as hazard_ms.simulation.kernels.counting tells it."""

    targets: Tensor  # int64
    saved: Tensor  # int64: those that are safe
    spoilt: Tensor  # int64: those that are not, but damaged
    worth: Tensor  # value of the safe ones as a share of all, damaged ones counting half
    now: Tensor  # things rescued in this frame, damaged ones counting half
    done: Tensor  # bool: there are targets, and all are safe


def counts(situation: Situation) -> Counts:
    """The fate of the targets by now; the tensors hold until the next call."""
    known = situation.known
    if known is not None and "counts" in known:
        return known["counts"]
    world, damage, rescue = situation.world, situation.episode.damage, situation.episode.rescue
    made = Counts(*world.launches.once(count, world.frame, lambda: _room_for_counts(world)))
    things = world.target, world.value, world.safe, damage.damaged
    rescues = rescue.safe, rescue.frame, rescue.damaged, world.frame
    world.launches.run(count, (world.num_envs,), *things, *rescues, DAMAGED_SHARE, *made)
    if known is not None:
        known["counts"] = made
    return made


def _room_for_counts(world: World) -> tuple[Tensor, ...]:
    number, share = torch.zeros_like(world.frame), torch.zeros_like(world.agent_heading)
    return *(number.clone() for _ in range(3)), share, share.clone(), share.bool()


def targets(situation: Situation) -> Tensor:
    """Number of targets, [E]."""
    return counts(situation).targets.clone()


def rescued(situation: Situation) -> Tensor:
    """Number of targets that are safe, [E]."""
    return counts(situation).saved.clone()


def damaged_targets(situation: Situation) -> Tensor:
    """Number of targets that were damaged and are not safe, [E]."""
    return counts(situation).spoilt.clone()


def all_rescued(situation: Situation) -> Tensor:
    """Whether there are targets and all of them are safe, bool [E]."""
    return counts(situation).done.clone()


def rescued_value(situation: Situation) -> Tensor:
    """Value of the rescued targets as a share of the value of all, damaged ones counting half, [E]."""
    return counts(situation).worth.clone()


def rescued_now(situation: Situation) -> Tensor:
    """Number of targets that became safe in this frame, damaged ones counting half, [E]."""
    return counts(situation).now.clone()


def dense(situation: Situation) -> Tensor:
    """Dense reward, [E]: 20 per rescue, a little for holding a target, less for being near one."""
    world, now = situation.world, counts(situation).now
    (made,) = world.launches.once(hint, now, lambda: (torch.zeros_like(now),))
    hand, bodies = situation.agent.gripper_pose()[0].contiguous(), world.launches.struct(Bodies, world)
    worth = (PER_RESCUE, FOR_HOLDING, FOR_NEARNESS)
    world.launches.run(hint, (world.num_envs,), hand, world.target, now, *worth, bodies, made)
    return made.clone()


def evaluate(goal: Goal, situation: Situation) -> dict[str, Tensor]:
    """The entries of `info` after every frame, [E] each: success, fail, the goal's own numbers, and sim_error."""
    situation = Situation(situation.episode, situation.agent, situation.affects_agent, known={})
    info = {"success": goal.success(situation)}
    info["fail"] = torch.zeros_like(info["success"]) if goal.fail is None else goal.fail(situation)
    info.update({term.name: term.of(situation) for term in goal.info})
    info["sim_error"] = situation.episode.sim_error.clone()
    return info


def told(situation: Situation) -> dict[str, Tensor]:
    """The entries of `info` that hazards tell of the agent, [E] each, in the units that they declare [-].

    There are none where hazards do not act on it.
    """
    if not situation.affects_agent:
        return {}
    episode, found = situation.episode, {}
    for hazard in episode.hazards:
        found.update(hazard.agent_info(episode.states[hazard.name], situation.world))
    lies = episode.lying()
    if "agent_fallen" in found and lies is not None:
        found["agent_fallen"] = lies.clone()  # water or wind may have thrown it over
    return found
