"""Observations of the practice tasks beside the robot's own joints, all in the frame of its base."""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.spec import Term
from hazard_ms.tasks import practice_rewards as rewards
from hazard_ms.tasks.episode.grasp import conjugate, multiply
from hazard_ms.tasks.episode.situation import Situation

AROUND = 3  # nearest pieces of furniture that a walk observes
FAR = 10.0  # away, where what is no furniture counts as being [m]
BASE = ("ahead", "left", "up")


def hand(situation: Situation) -> Tensor:
    """Middle between the fingers in the frame of the base [m], [E, 3]."""
    world = situation.world
    return rewards.in_base(situation, situation.agent.gripper_pose()[0] - world.agent_position)


def fingers(situation: Situation) -> Tensor:
    """Direction of the fingers in the frame of the base, a unit vector, [E, 3]."""
    _, rotation = situation.agent.gripper_pose()
    ahead = torch.zeros_like(rotation)
    ahead[:, 1] = 1.0
    return rewards.in_base(situation, multiply(multiply(rotation, ahead), conjugate(rotation))[:, 1:])


def bag(situation: Situation) -> Tensor:
    """Mouth of the bag in the frame of the base [m], [E, 3]."""
    return rewards.in_base(situation, situation.agent.bag_position() - situation.world.agent_position)


def direction(situation: Situation) -> Tensor:
    """Direction of the thing over the floor in the frame of the base, a unit vector, [E, 2]."""
    there = rewards.thing_ahead(situation)[:, :2]
    return there / there.norm(dim=1, keepdim=True).clamp(min=1e-6)


def furniture(situation: Situation) -> Tensor:
    """Nearest points of the AROUND nearest pieces of furniture: ahead and left of each [m], nearest first, [E, 6]."""
    world = situation.world
    at = world.agent_position[:, None, :2]
    half = world.extent[..., :2] / 2
    off = torch.maximum(torch.minimum(at, world.position[..., :2] + half), world.position[..., :2] - half) - at
    fixed = world.exists & ~world.movable
    off = torch.where(fixed[..., None], off, FAR)
    order = off.norm(dim=-1).argsort(dim=1)[:, :AROUND, None].expand(-1, -1, 2)
    near = torch.cat([off.gather(1, order), torch.zeros_like(order[..., :1], dtype=off.dtype)], dim=-1)
    return rewards.in_base(situation, near)[..., :2].flatten(1)


HAND = Term("hand", hand, "middle between the fingers", (3,), "m", "base", entries=BASE)
FINGERS = Term("fingers", fingers, "where they point", (3,), "", "base", low=-1.0, high=1.0, entries=BASE)
SHUT = Term("shut", lambda s: s.episode.hand.closed[:, None], "the hand was commanded shut", (1,), low=0.0, high=1.0)
THING = Term("thing", rewards.thing_ahead, "middle of the thing", (3,), "m", "base", entries=BASE)
WALK_TO_TERMS = (
    THING,
    Term("direction", direction, "where it is", (2,), "", "base", low=-1.0, high=1.0, entries=BASE[:2]),
    Term(
        "furniture",
        furniture,
        "nearest points of the three nearest pieces of furniture",
        (2 * AROUND,),
        "m",
        "base",
        entries=tuple(f"{side} {i}" for i in range(AROUND) for side in BASE[:2]),
    ),
)
PICK_UP_TERMS = (
    THING,
    Term("thing_size", lambda s: rewards.beside(s, s.world.extent), "edges of its box", (3,), "m", low=0.0),
    HAND,
    Term(
        "from_hand",
        lambda s: rewards.thing_ahead(s) - hand(s),
        "the thing from the hand",
        (3,),
        "m",
        "base",
        entries=BASE,
    ),
    FINGERS,
    Term("gap", lambda s: rewards.gap(s)[:, None], "from the hand to the box of the thing", (1,), "m", low=0.0),
    SHUT,
)
STOW_TERMS = (
    *PICK_UP_TERMS,
    Term("holding", lambda s: rewards.holding(s)[:, None], "the thing is in the hand", (1,), low=0.0, high=1.0),
    Term("bag", bag, "mouth of the bag", (3,), "m", "base", entries=BASE),
)
FETCH_TERMS = (*WALK_TO_TERMS, *STOW_TERMS[1:])  # with the thing once
