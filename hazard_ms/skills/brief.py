"""The brief of an agent before an episode: all that the paper's agents know, and nothing that identifies the scene."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hazard_ms.sensing.detection.eyes import FAR
from hazard_ms.sensing.detection.labeller import Labeller
from hazard_ms.sensing.target_table import Target
from hazard_ms.skills.decision import DROP, PICK_UP, WALK_TO
from hazard_ms.spec.catalogue import DAMAGED_SHARE
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.registry.robots import robot_name

RANDOM_BYTES = 8  # size of an agent's random seed [bytes]


@dataclass(frozen=True)
class HazardBrief:
    """The part of a brief on one hazard of the task."""

    name: str  # "fire"
    title: str  # name of its level: "temperature"
    unit: str  # unit of its level: "°C"
    # whether a target is damaged at a level of the hazard and a height above the floor [m]
    threatens: Callable[[Target, float, float], bool]
    # pressure [m^2/s^2] from which the air moves each model of a category; empty where that loses nothing
    withstands: Callable[[str], tuple[float, ...]] = lambda category: ()


@dataclass(frozen=True)
class Brief:
    """Everything that an agent is told before an episode."""

    task: str  # id of the environment
    text: str  # the task in words
    targets: tuple[Target, ...]  # the things to rescue, as they are at the start
    containers: tuple[str, ...]  # carts if they are the safe place, else empty
    safe_place: str  # bag (carried by the robot) | cart (containers in the scene)
    hazards: tuple[HazardBrief, ...]  # in the order of `Sighting.levels`
    max_frames: int
    frame_seconds: float  # duration of a frame [s]
    robot: str  # name of the robot
    radius: float  # of the robot's base [m]
    random_seed: int  # seed of the agent's own randomness, derived one-way from that of the episode
    mitigations: tuple[str, ...] = ()  # verbs of the task beyond the six of the benchmark
    damaged_share: float = DAMAGED_SHARE  # of its value that a target counts when it is rescued damaged
    several_rooms: bool = False  # whether doors or doorways divide the place
    averted: bool = False  # whether it counts what is averted: what would be lost if nobody acted, and is not
    sight: float = FAR  # distance up to which a look tells most of what is there [m]
    # of the action that achieves the task's goal: walk_to, pick_up or drop for any one target, or one of `mitigations`;
    # "": all targets are to be rescued
    verb: str = ""
    looks: bool = False  # whether it can `look_at` things: a detector tells what there is

    @property
    def mitigation(self) -> str:
        """The verb that achieves the task's goal if that is a mitigation, else "": then targets count."""
        return self.verb if self.verb in self.mitigations else ""


def brief_of(base: Any, robot: Any, labeller: Labeller, max_frames: int, sight: float = FAR, number: int = 0) -> Brief:
    """The brief of the episode of `max_frames` that has begun in the HazardEnv `base`, in the words of `labeller`.

    `robot`: the agent's, which has this `number` in its team; `sight`: distance up to which a look tells most of what
    is there [m]. Raises ValueError for a goal of the task that no action of its agents achieves.
    """
    one_of(base.task.goal.verb, ("", WALK_TO, PICK_UP, DROP, *base.task.mitigations), "verb of the goal")
    return Brief(
        task=base.task.name,
        text=base.task_description,
        targets=labeller.targets(),
        containers=labeller.containers,
        safe_place=base.task.safe_place.name,
        hazards=tuple(
            HazardBrief(h.name, h.level.title, h.level.unit, h.threatens, h.withstands) for h in base.task.hazards
        ),
        max_frames=max_frames,
        frame_seconds=float(base.control_timestep),
        robot=robot_name(robot.uid),
        radius=robot.build.radius,
        random_seed=random_seed(int(base.world.chance.seed[0]), number),
        mitigations=base.task.mitigations,
        several_rooms=has_several_rooms(base),
        averted=base.task.averted,
        sight=sight,
        verb=base.task.goal.verb,
        looks=labeller.withheld,
    )


def has_several_rooms(base: Any) -> bool:
    """Whether doors or doorways divide the place of the episode in the HazardEnv `base`: a home, or a flat."""
    return bool(base.task.several_rooms or base.specs[0].room.partitions)


def random_seed(seed: int, number: int = 0) -> int:
    """The seed of an agent's randomness in the episode of `seed`: a hash, so that it does not reveal the scene.

    `number`: of its robot in a team.
    """
    digest = hashlib.sha256(f"hazard_ms agent {seed}{f' {number}' if number else ''}".encode()).digest()
    return int.from_bytes(digest[:RANDOM_BYTES], "big")
