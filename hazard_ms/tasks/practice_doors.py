"""Practice at a door: its rooms, where a robot stands before it, the goal, what is paid and what is observed.

The robot begins on the side into which the leaf turns, so that it has to pull. The door is open when what is open of
its width, seen along the wall's normal, is wider than the robot, for Fetch in a door of 0.9 m at 69 degrees: the skills
count it as one that the robot gets through then (hazard_ms.skills.mitigations.handles). A third of the hint of a frame
is for a hand near the handle, a third for holding it, and a third for how far the leaf has turned of that angle: who
lets go loses nothing of the last, and can take the handle again.
"""

from __future__ import annotations

import math

import numpy as np
import torch
from torch import Tensor

from hazard_ms.spec import AgentStart, Body, Fixture, Goal, Opening, Partition, Room, SceneSpec, Term, rounding
from hazard_ms.spec.robot import GRASP_REACH
from hazard_ms.tasks import practice_rewards as rewards
from hazard_ms.tasks import practice_terms as terms
from hazard_ms.tasks.episode.situation import Situation

ROOM = (7.0, 6.0)  # of both rooms together [m] [ours]
WALL = (3.0, 4.0)  # least and most distance of the wall from the west or the south, in which there is a door [m] [ours]
MARGIN = 1.6  # least distance of the middle of the door from both ends of the wall [m] [ours]
WIDTH, HEIGHT = (0.9, 1.0), 2.0  # of the door, least and most, and its height [m] [ours: as in homes]
STAND, THING = 0.4, (0.08, 0.08, 0.15)  # width of the two tables; edges of what lies on the far one [m] [ours]
CORNER = 0.7  # distance of the tables from two walls [m] [ours]
TOPS = (0.4, 0.85)  # least and most height of the tables [m]
BEYOND = 1.2  # of the start that `stand_before` replaces, so that films look from the robot's own side [m] [ours]
FIRES, FIRE_GAP = (
    2,
    (0.5, 0.9),
)  # with fire: places that burn at frame 0, so far before the middle of the door [m] [ours]
# where the robot begins: distance from the handle [m], and how far the way there is turned from the shut leaf towards
# its swing [rad]: within reach of Fetch, 1.09 m at this height, and mostly out of the swing [ours]
APART, ROUND = (0.9, 1.0), (math.radians(75), math.radians(95))
ASKEW = 0.3  # most that the robot looks past the handle [rad]
BERTH = 0.08  # clearance at the start from where the leaf comes, beside the robot's own radius [m]
DRAWS = 64  # places of which the first clear one is taken
FRAMES = 300  # of an episode [ours]


def room(number: str) -> SceneSpec:
    """The room "practice/NUMBER" for practice at a door, which divides it.

    It has a table on both sides, on the far one a thing, and floor that burns near the handle if the task has fire.
    """
    chance = np.random.default_rng([int(number.rpartition("/")[2]), 0x444F4F52])  # "DOOR": not those of other practice
    axis = "xy"[int(chance.integers(2))]
    at, wide = float(chance.uniform(*WALL)), float(chance.uniform(*WIDTH))
    if axis == "x":
        at -= (ROOM[0] - ROOM[1]) / 2
    length = ROOM["xy".index(axis)]
    middle = float(chance.uniform(MARGIN, length - MARGIN))
    door = Opening("door", "partition_1", middle, wide, HEIGHT)
    fixtures, places = list[Fixture](), list[tuple[float, float]]()
    for i, deep in enumerate((CORNER, ROOM[1 - "xy".index(axis)] - CORNER)):
        along = CORNER if middle > length / 2 else length - CORNER
        places.append((along, deep) if axis == "x" else (deep, along))
        top = float(chance.uniform(*TOPS))
        fixtures.append(Fixture(f"stand_{i}", "table", "plain_box", (*places[i], 0.0), scale=(STAND, STAND, top)))
    thing = Body("box_0", "box", "plain_box", (*places[1], top), scale=THING, mass=0.3)
    angles, gaps = chance.uniform(0.0, math.pi, FIRES), chance.uniform(*FIRE_GAP, FIRES)
    polar = zip(angles.tolist(), gaps.tolist(), strict=True)
    fires = [(middle + gap * math.cos(a), at - gap * math.sin(a)) for a, gap in polar]
    burning = tuple(fires if axis == "x" else [(y, x) for x, y in fires])
    whole = Room(ROOM, openings=(door,), partitions=(Partition("partition_1", axis, at),))
    beyond = (middle, at + BEYOND) if axis == "x" else (at + BEYOND, middle)
    return SceneSpec(number, whole, tuple(fixtures), (thing,), ("box",), burning, AgentStart(beyond))


def stand_before(situation: Situation, rows: Tensor) -> None:
    """Put the robots of the environments `rows`, [R], before the handle of the door, out of the way of its leaf."""
    world, grip = situation.world, situation.grip
    draw = world.chance.uniform("practice start", DRAWS, 3)
    places = (grip.handles()[..., :2], grip.hinge, grip.along, grip.out)
    handle, hinge, along, out = (at(situation, of)[:, None].float() for of in places)
    far, turned = (low + draw[..., k] * (high - low) for k, (low, high) in enumerate((APART, ROUND)))
    there = handle + far[..., None] * (rounding.cos(turned)[..., None] * along + rounding.sin(turned)[..., None] * out)
    swing = at(situation, grip.width[..., None])
    first = ((there - hinge).norm(dim=-1) > swing + world.robot.radius + BERTH).int().argmax(dim=1)
    e = torch.arange(world.num_envs, device=world.device)
    place, askew = there[e, first], ASKEW * (2.0 * draw[e, first, 2] - 1.0)
    x, y = (handle[:, 0] - place).unbind(-1)
    heading = torch.atan2(y.double(), x.double()).float() + askew
    situation.agent.place(rows, place[rows], heading[rows])


def at(situation: Situation, values: Tensor) -> Tensor:
    """The numbers of `values`, [E, O, ...], that belong to the door of each room, [E, ...]."""
    door = situation.grip.doors.int().argmax(dim=1)
    return values[torch.arange(len(values), device=values.device), door]


def angle(situation: Situation) -> Tensor:
    """Angle by which the door is open [rad], [E]."""
    return at(situation, situation.grip.angle).float()


def wide_enough(situation: Situation) -> Tensor:
    """Angle at which what is open of the door is as wide as the robot [rad], [E]."""
    passing = 2.0 * situation.world.robot.radius / at(situation, situation.grip.width)
    return rounding.acos(1.0 - passing)


def opened(situation: Situation) -> Tensor:
    """Whether the robot gets through the door, whose leaf is not broken, bool [E]."""
    return (angle(situation) > wide_enough(situation)) & ~broken(situation)


def broken(situation: Situation) -> Tensor:
    """Whether the leaf is gone, bool [E]."""
    return at(situation, situation.world.openings.state.broken)


def handle(situation: Situation) -> Tensor:
    """Middle of the handle [m], [E, 3], world frame."""
    return at(situation, situation.grip.handles())


def from_hand(situation: Situation) -> Tensor:
    """The way from the hand to the middle of the handle [m], [E, 3], world frame."""
    return handle(situation) - situation.agent.gripper_pose()[0]


def gap(situation: Situation) -> Tensor:
    """Distance [m] from the hand to the middle of the handle, [E]."""
    return from_hand(situation).norm(dim=-1)


def holding(situation: Situation) -> Tensor:
    """Whether the hand holds the handle, bool [E]."""
    return at(situation, situation.grip.state.holds)


def hint(situation: Situation) -> Tensor:
    """Hint on the way to an open door, [E], 0 to 1: of nearness to the handle, its hold, and the turn of the leaf."""
    near = rewards.nearness(gap(situation), GRASP_REACH)
    turned = (angle(situation) / wide_enough(situation)).clamp(max=1.0)
    return (near + holding(situation).float() + turned) / 3.0


def dense(situation: Situation) -> Tensor:
    """Dense reward, [E]: 1 for an open door; each frame up to 1/FRAMES on the way there."""
    return opened(situation).float() + hint(situation) / FRAMES


def hinge(situation: Situation) -> Tensor:
    """The hinge at the height of the handle in the frame of the base: ahead, left, up [m], [E, 3]."""
    over = at(situation, situation.grip.hinge).float()
    place = torch.cat([over, handle(situation)[:, 2:]], dim=-1)
    return rewards.in_base(situation, place - situation.world.agent_position)


OPEN_DOOR = Goal(
    success=opened,
    dense=dense,
    sparse=lambda s: opened(s).float(),
    largest=1.0 + 1.0 / FRAMES,
    fail=broken,
    info=(
        Term("angle", angle, "angle by which the door is open", unit="rad", low=0.0, high=1.6),
        Term("gap", gap, "from the hand to the handle", unit="m", low=0.0),
    ),
    done="door open",
    verb="open",
)
OPEN_DOOR_TERMS = (
    Term(
        "handle",
        lambda s: rewards.in_base(s, handle(s) - s.world.agent_position),
        "middle of the handle",
        (3,),
        "m",
        "base",
        entries=terms.BASE,
    ),
    Term("hinge", hinge, "hinge at the height of the handle", (3,), "m", "base", entries=terms.BASE),
    terms.HAND,
    Term(
        "from_hand",
        lambda s: rewards.in_base(s, from_hand(s)),
        "the handle from the hand",
        (3,),
        "m",
        "base",
        entries=terms.BASE,
    ),
    terms.FINGERS,
    terms.SHUT,
    Term("holding", lambda s: holding(s)[:, None], "the hand holds the handle", (1,), low=0.0, high=1.0),
    Term("angle", lambda s: angle(s)[:, None], "angle by which the door is open", (1,), "rad", low=0.0, high=1.6),
)
