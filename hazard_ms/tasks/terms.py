"""Entries of observations that most tasks share: the agent, its hand, the time and the targets."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from functools import partial
from typing import Any

import torch
from torch import Tensor

from hazard_ms.hazards.base import Hazard
from hazard_ms.spec import Term
from hazard_ms.spec.catalogue import HIGH_VALUE, LIMITS
from hazard_ms.tasks.episode.situation import Situation

PROPERTIES = ("flammable", "waterproof", "ignition_temperature")  # attributes of the catalogue; the last [C]
HOTTEST = float(LIMITS["ignition_temperature"][1])  # highest ignition temperature [C]
TURN = 2.0 * math.pi  # a heading lies between -TURN and TURN, as PhysX wraps the base's joint [rad]


def agent_pose(situation: Situation) -> Tensor:
    """Pose of the agent's base: x, y [m] and heading [rad], world frame, [E, 3]."""
    world = situation.world
    return torch.cat([world.agent_position[:, :2], world.agent_heading[:, None]], dim=1)


def properties(situation: Situation) -> Tensor:
    """`PROPERTIES` of all things, which decide whether a hazard damages them, [E, B, 3]; the last in [C]."""
    return torch.stack([situation.world.lookup(name) for name in PROPERTIES], dim=-1)


def level(hazard: Hazard, situation: Situation) -> Tensor:
    """Level of `hazard` at the middle of every target, in the hazard's unit ([C], [m] or [m/s]), [E, B].

    What is no target has none of its own; it is 0, or in a scene without targets that of the first thing.
    """
    world = situation.world
    index = world.targets
    points = world.position.gather(1, index[..., None].expand(-1, -1, 3))
    levels = hazard.image(situation.episode.states[hazard.name], world, points)
    return torch.zeros_like(world.value).scatter_(1, index, levels)


def _target(name: str, of: Any, meaning: str, **more: Any) -> Term:
    return Term(f"target_{name}", of, meaning, per_target=True, **more)


AGENT_TERMS = (
    Term(
        "agent_pose",
        agent_pose,
        "place of the agent's base and its heading, anticlockwise from +x",
        (3,),
        "m, m, rad",
        "world",
        low=(-math.inf, -math.inf, -TURN),
        high=(math.inf, math.inf, TURN),
        entries=("x", "y", "heading"),
    ),
    Term(
        "gripper",
        lambda s: s.agent.gripper_pose()[0],
        "middle between the fingers",
        (3,),
        "m",
        "world",
        entries=("x", "y", "z"),
    ),
    Term("held", lambda s: s.world.held.any(1, True), "the hand holds something", (1,), low=0.0, high=1.0),
    Term("frame", lambda s: s.world.frame[:, None], "frames since the start of the episode", (1,), "frame", low=0.0),
)
TARGET_TERMS = (
    _target("value", lambda s: s.world.value, "what it is worth", low=0.0, high=float(HIGH_VALUE), constant=True),
    _target(
        "properties",
        properties,
        "what decides whether a hazard damages it",
        shape=(3,),
        unit="-, -, °C",
        low=0.0,
        high=(1.0, 1.0, HOTTEST),
        entries=PROPERTIES,
        constant=True,
    ),
    _target("held", lambda s: s.world.held, "it is in the hand", low=0.0, high=1.0),
    _target("rescued", lambda s: s.world.safe, "it is safe", low=0.0, high=1.0),
    _target(
        "position",
        lambda s: s.world.position,
        "middle of its box; in the bag 10 m below the floor",
        shape=(3,),
        unit="m",
        frame="world",
        hidden=True,
        entries=("x", "y", "z"),
    ),
    _target("damaged", lambda s: s.episode.damage.damaged, "it was damaged", low=0.0, high=1.0, hidden=True),
)


def terms(hazards: Sequence[Hazard], most_value: float = HIGH_VALUE) -> tuple[Term, ...]:
    """The entries about the agent and the targets, and the level of each of `hazards` at the targets.

    `most_value`: highest value of a target (docs/benchmark.md 1).
    """
    value, *others = TARGET_TERMS
    levels = (
        _target(
            h.name,
            partial(level, h),
            f"{h.level.title} at its middle",
            unit=h.level.unit,
            low=min(h.level.least, 0.0),  # empty rows hold 0
            hidden=True,
        )
        for h in hazards
    )
    return (*AGENT_TERMS, dataclasses.replace(value, high=float(most_value)), *others, *levels)
