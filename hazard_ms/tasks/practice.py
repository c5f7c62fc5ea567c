"""Practice, from one motion to one rescue: walk to a thing, pick it up, put it into the bag, fetch it; open a door.

Rooms are calm unless `hazards` are asked for, as by `gym.make("hazard_ms.tasks.practice:HazardFetch-v1",
hazards=["fire"])`: so it can be seen what a hazard costs a policy. Not part of the benchmark: the tasks are registered
when this module is imported.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from functools import partial

import numpy as np
import torch
from torch import Tensor

from hazard_ms.hazards.presets import PRESETS
from hazard_ms.spec import AgentStart, Body, Fixture, Goal, Room, SceneSpec, Task, Term, rounding
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.registry import register_task
from hazard_ms.spec.severity import USUAL
from hazard_ms.tasks import practice_doors as doors
from hazard_ms.tasks import practice_rewards as rewards
from hazard_ms.tasks import words
from hazard_ms.tasks.compound import acting
from hazard_ms.tasks.episode.safe_places import BAG
from hazard_ms.tasks.episode.situation import Situation
from hazard_ms.tasks.practice_terms import FETCH_TERMS, PICK_UP_TERMS, STOW_TERMS, WALK_TO_TERMS

ROOM = (7.0, 6.0)  # of a practice room [m] [ours]
COLUMNS, ROWS = (1.4, 3.5, 5.6), (1.5, 4.5)  # about where its six stands are, along x and y [m]: no arm reaches two
SHIFT = 0.2  # most that a stand is off there [m]
STAND_WIDTH, STAND_HEIGHT = (0.25, 0.4), (0.2, 0.85)  # least and most [m]; tables and low shelves are as high
ON_FLOOR = 1 / 6  # chance that a thing lies on the floor instead, where it is hard to reach
WIDTH, HEIGHT, MASS = (0.04, 0.12), (0.05, 0.25), 0.3  # of things, least and most [m]; [kg]
SCENES = {"train": range(100), "test": range(100, 125)}  # numbers of rooms
NEAR, FAR = 0.6, 0.85  # distance at which walks to a thing end, and pick-ups begin [m] (skills/motor/walking.py)
ASKEW = 0.3  # most that the robot looks past a thing when a pick-up begins [rad]
WALL = 0.2  # least distance of a fire from a wall [m] [ours]
DISTANT = 2.0  # least distance at which a walk begins [m]
BERTH = 0.15  # clearance at the start of a walk, beside the robot's own radius [m]
DRAWS = 64  # places of which the first clear one is taken
FIRES, FIRE_GAP = (
    2,
    (0.5, 0.9),
)  # with fire: places that burn at frame 0, so far from the stand of one target [m] [ours]


def scene(number: str, walking: bool) -> SceneSpec:
    """The practice room "practice/NUMBER": six stands with a thing on each, or on one of them if it is for walking.

    Floor burns beside the stand of one of these things if the task has fire.

    Raises ValueError for another name.
    """
    check(number)
    chance = np.random.default_rng(int(number.rpartition("/")[2]))
    fixtures, bodies, places = list[Fixture](), list[Body](), list[tuple[float, float]]()
    goal = int(chance.integers(len(COLUMNS) * len(ROWS)))
    for i, (x, y) in enumerate((x, y) for x in COLUMNS for y in ROWS):
        at = (x + chance.uniform(-SHIFT, SHIFT), y + chance.uniform(-SHIFT, SHIFT))
        places.append(at)
        top, wide = float(chance.uniform(*STAND_HEIGHT)), float(chance.uniform(*STAND_WIDTH))
        size = (*chance.uniform(*WIDTH, size=2).tolist(), float(chance.uniform(*HEIGHT)))
        if chance.random() < ON_FLOOR and not walking:
            top = 0.0
        else:
            fixtures.append(Fixture(f"stand_{i}", "table", "plain_box", (*at, 0.0), scale=(wide, wide, top)))
        if i == goal or not walking:
            bodies.append(Body(f"box_{i}", "box", "plain_box", (*at, top), scale=size, mass=MASS))
    angles = chance.uniform(0.0, 2.0 * math.pi, FIRES)
    gaps = chance.uniform(*FIRE_GAP, FIRES)
    middle = places[goal]
    around = [middle + gap * np.array([math.cos(a), math.sin(a)]) for a, gap in zip(angles, gaps, strict=True)]
    fires = tuple((float(x), float(y)) for x, y in np.clip(around, WALL, np.array(ROOM) - WALL))
    return SceneSpec(number, Room(ROOM), tuple(fixtures), tuple(bodies), ("box",), fires, AgentStart((2.4, 3.0)))


def door_room(number: str) -> SceneSpec:
    """The practice room "practice/NUMBER" with a door in a wall, as `practice_doors.room` says.

    Raises ValueError for another name.
    """
    check(number)
    return doors.room(number)


def check(number: str) -> None:
    """Raises ValueError unless `number` is the name of a practice room."""
    one_of(number, [name for split in SCENES for name in names(split)], "scene")


def names(split: str) -> tuple[str, ...]:
    """Names of the rooms of a split."""
    return tuple(f"practice/{number}" for number in SCENES[split])


def stand_near(situation: Situation, rows: Tensor) -> None:
    """Put the robots of the environments `rows`, [R], where a walk to one of the targets ends, roughly facing it."""
    world = situation.world
    draw = world.chance.uniform("practice start", 4)
    every = world.target.float().cumsum(dim=1)  # numbers of the targets from 1
    chosen = 1.0 + (draw[:, 0] * every[:, -1]).floor()
    thing = (every >= chosen[:, None]).int().argmax(dim=1)
    at = world.position[torch.arange(world.num_envs, device=world.device), thing, :2]
    angle, distance = 2.0 * math.pi * draw[:, 1], NEAR + (FAR - NEAR) * draw[:, 2]
    place = at - distance[:, None] * torch.stack([rounding.cos(angle), rounding.sin(angle)], dim=-1)
    heading = angle + ASKEW * (2.0 * draw[:, 3] - 1.0)
    situation.agent.place(rows, place[rows], heading[rows])


def stand_far(situation: Situation, rows: Tensor) -> None:
    """Put the robots of the environments `rows`, [R], anywhere clear that is not close to a target."""
    world = situation.world
    draw = world.chance.uniform("practice start", DRAWS, 3)
    margin = world.robot.radius + BERTH
    points = margin + draw[..., :2] * (world.room[:, None] - 2.0 * margin)  # [E, DRAWS, 2]
    gaps = rewards.gaps(situation, points)
    away = torch.where(world.target[:, None], rewards.apart(situation, points), torch.inf).amin(dim=-1)
    clear = (torch.where(world.exists[:, None], gaps, torch.inf).amin(dim=-1) > margin) & (away > DISTANT)
    first = clear.int().argmax(dim=1)
    e = torch.arange(world.num_envs, device=world.device)
    situation.agent.place(rows, points[e, first][rows], (2.0 * math.pi * draw[e, first, 2])[rows])


def practice(
    goal: Goal,
    terms: tuple[Term, ...],
    walking: bool,
    text: str,
    physics: str = "paper",
    hazards: Sequence[str] = (),
    severity: str = USUAL,
) -> Task:
    """A task of practice: its goal, its observations, whether it begins with a walk, and the task in words.

    `hazards` act from frame 0 on with the `physics` of a preset; without any it is calm.

    Raises ValueError for unknown names, hazards of the open air, and a severity without hazards.
    """
    one_of(physics, PRESETS, "physics")
    found = acting(hazards, physics, severity)
    if open_air := [hazard.name for hazard in found if hazard.open_air]:
        raise ValueError(f"hazards for practice must be ones that act indoors, got {', '.join(open_air)}")
    if severity != USUAL and not found:
        raise ValueError(f"severity must be {USUAL!r} without hazards, got {severity!r}")
    return Task(
        scenes=names,
        build=partial(scene, walking=walking),
        hazards=found,
        goal=goal,
        safe_place=BAG,
        observations=terms,
        arrange=stand_far if walking else stand_near,
        text=text,
        rewordings=words.PRACTICE.get(text, ()),
    )


def walk_to(physics: str = "paper", hazards: Sequence[str] = (), severity: str = USUAL) -> Task:
    """The task HazardWalkTo-v1. Raises ValueError as `practice` does."""
    text = "Walk to the thing and face it."
    return practice(rewards.WALK_TO, WALK_TO_TERMS, True, text, physics, hazards, severity)


def pick_up(physics: str = "paper", hazards: Sequence[str] = (), severity: str = USUAL) -> Task:
    """The task HazardPickUp-v1. Raises ValueError as `practice` does."""
    text = "Take the thing before you into your hand."
    return practice(rewards.PICK_UP, PICK_UP_TERMS, False, text, physics, hazards, severity)


def stow(physics: str = "paper", hazards: Sequence[str] = (), severity: str = USUAL) -> Task:
    """The task HazardStow-v1. Raises ValueError as `practice` does."""
    text = "Take the thing before you, and put it into your bag."
    return practice(rewards.STOW, STOW_TERMS, False, text, physics, hazards, severity)


def fetch(physics: str = "paper", hazards: Sequence[str] = (), severity: str = USUAL) -> Task:
    """The task HazardFetch-v1. Raises ValueError as `practice` does."""
    text = "Walk to the thing, take it, and put it into your bag."
    return practice(rewards.FETCH, FETCH_TERMS, True, text, physics, hazards, severity)


def open_door(physics: str = "paper", hazards: Sequence[str] = (), severity: str = USUAL) -> Task:
    """The task HazardOpenDoor-v1. Raises ValueError as `practice` does."""
    text = "Open the door before you."
    made = practice(doors.OPEN_DOOR, doors.OPEN_DOOR_TERMS, False, text, physics, hazards, severity)
    made = dataclasses.replace(made, build=door_room, arrange=doors.stand_before, several_rooms=True)
    return dataclasses.replace(made, mitigations=("open",), doors_by_hand=True)


register_task("HazardWalkTo-v1", walk_to, rewards.WALK_FRAMES)
register_task("HazardPickUp-v1", pick_up, rewards.PICK_UP_FRAMES)
register_task("HazardStow-v1", stow, rewards.STOW_FRAMES)
register_task("HazardFetch-v1", fetch, rewards.FETCH_FRAMES)
register_task("HazardOpenDoor-v1", open_door, doors.FRAMES)
