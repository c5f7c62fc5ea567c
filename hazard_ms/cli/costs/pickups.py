"""Measures what picking up and putting away cost, target by target, for `hazard-ms bench --pickups`.

Each target of the scenes is picked up once at the start of an episode, before its hazard moves anything much. The
robot is put where a walk to the target ends, and looks at it. What it got is then put away: into the bag, or over the
nearest cart. Frames do not depend on the machine.

A target counts as reachable if the arm's kinematics give a posture that brings the hand to it, with no part of the arm
in anything on the robot's map, from one of some places of the free floor within the arm's span. How the arm would get
into that posture is not asked. What moves must in addition be in reach of where the base can get to, driving straight
at full speed, in the time that an arm needs that moves straight: wind may have taken it away by then. What worked is
reachable, too.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import partial

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.evaluation.options import EnvOptions
from hazard_ms.scenes.floor import FLOOR_CELL, connected, free_floor
from hazard_ms.skills.context import Skill
from hazard_ms.skills.decision import DROP, PICK_UP, Action, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.motor.reaching import free_postures, reaching
from hazard_ms.skills.motor.walking import ARRIVED, known
from hazard_ms.spec.checks import whole

MOST = 10**5  # pick-ups [-] [ours]
MARGIN = 0.05  # room that walks keep besides the robot's radius, from the cells of their map [m] [ours]
LOOKS = 4  # looks that show everything around, with a field of view of 120 degrees [-]
MOVED = 0.1  # movement by which a thing does not lie still [m] [ours]
PLACES = 8  # places around a target from which reach is judged [-] [ours]


@dataclass(frozen=True)
class Handling:
    """One pick-up or drop."""

    robot: str
    verb: str
    env_id: str
    scene: str
    target: str
    height: float  # middle of the target above the floor [m]
    clearance: float  # horizontal distance from the target to the nearest floor that the robot can stand on [m]
    distance: float  # horizontal distance from the robot to the target, or to the cart, at the start [m]
    frames: int
    ok: bool
    reason: str
    reachable: bool  # see the module


def handlings(env_id: str, robot: str, count: int, seed: int) -> Iterator[Handling]:
    """Pick up `count` targets of training scenes with `robot`, put them away, and yield how each went.

    Raises ValueError for an unknown task or robot and for a `count` that is not positive.
    """
    EnvOptions(env_id, robot_uids=robot).check()
    whole(count, 1, MOST, "count")
    env = SkillEnv.make(env_id, robot_uids=robot, deterministic=False, effects="off")
    seen: set[str] = set()
    tried = 0
    try:
        for drawn in range(seed, seed + MOST):
            env.reset(seed=drawn)
            spec = env.base.specs[0]
            if spec.name in seen:
                continue
            seen.add(spec.name)
            floor = _floor(env)
            for number, body in enumerate(spec.targets):
                if tried == count:
                    return
                if number:
                    env.reset(seed=drawn)
                tried += 1
                yield from _handled(env, robot, body.name, floor, partial(env.reset, seed=drawn))
    finally:
        env.close()


def _handled(
    env: SkillEnv, robot: str, target: str, floor: NDArray[np.float64], again: Callable[[], object]
) -> Iterator[Handling]:
    """Pick `target` up, from where a walk over `floor` [m], [C, 2], ends, and put it away if that worked.

    `again` starts the episode once more.
    """
    index = env.base.world.index(0, target)
    place, clearance = env.stage.position(index), 0.0

    def told(verb: str, distance: float, frames: int, ok: bool, reason: str, reachable: bool) -> Handling:
        height, task = round(float(place[2]), 3), env.base.task.name
        near, far, scene = round(clearance, 3), round(distance, 3), env.base.specs[0].name
        return Handling(robot, verb, task, scene, target, height, near, far, frames, ok, reason, reachable)

    clearance = float(np.hypot(*(floor - place[:2]).T).min())
    spot = _end_of_walk(env, index, floor)
    if spot is None:
        yield told(PICK_UP, clearance, 0, False, "no_place", False)
        return
    for elsewhere in [*_around(env, index, floor), spot]:
        if elsewhere is spot or not known(env.stage, index):  # who walks to a thing has seen it from somewhere
            _stand(env, elsewhere, place)
    distance = float(np.hypot(*(env.stage.position(index)[:2] - spot)))
    result = env.step(Action(PICK_UP, target))[-1]["result"]
    reachable = result.ok or _reachable(env, index, floor, spot, again)
    yield told(PICK_UP, distance, result.frames, result.ok, result.reason, reachable)
    if not result.ok:
        return
    carts = env.brief().containers
    if not carts:
        dropped = env.step(Action(DROP))[-1]["result"]
        yield told(DROP, 0.0, dropped.frames, dropped.ok, dropped.reason, True)
        return
    here = np.array(env.stage.robot.base()[:2])
    cart = min(carts, key=lambda name: np.hypot(*(env.stage.position(env.base.world.index(0, name))[:2] - here)))
    number = env.base.world.index(0, cart)
    beside = _end_of_walk(env, number, floor)
    if beside is None:
        return
    _stand(env, beside, env.stage.position(number))
    distance = float(np.hypot(*(env.stage.position(number)[:2] - beside)))
    dropped = env.step(Action(DROP, cart))[-1]["result"]
    yield told(DROP, distance, dropped.frames, dropped.ok, dropped.reason, True)


def _floor(env: SkillEnv) -> NDArray[np.float64]:
    """Middles of the cells that the robot can get to, and where it can stand with MARGIN if possible [m], [C, 2]."""
    spec = env.base.specs[0]
    radius = env.stage.robot.build.radius
    free = connected(free_floor(spec, radius), spec.agent_start.position)
    roomy = free & free_floor(spec, radius + MARGIN)  # a walk may pass a gap in which it would not end
    return np.asarray((np.argwhere(roomy if roomy.any() else free) + 0.5) * FLOOR_CELL, dtype=np.float64)


def _end_of_walk(env: SkillEnv, index: int, floor: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """The place [m], [2], where a walk to the thing ends; None if none is within the arm's reach of it.

    Like `walk_to`, it is the first place from the start that is near enough, or else the nearest one.
    """
    thing = env.stage.position(index)
    edge = float(env.base.world.extent[0, index, :2].norm()) / 2
    far = np.hypot(*(floor - thing[:2]).T)
    if far.min() > max(ARRIVED, env.stage.robot.build.span(float(thing[2]))[1]) + edge:
        return None
    start = np.asarray(env.base.specs[0].agent_start.position)
    near = far <= ARRIVED + edge
    if not near.any():
        return np.asarray(floor[np.argmin(far)])
    return np.asarray(floor[near][np.argmin(np.hypot(*(floor[near] - start).T))])


def _stand(env: SkillEnv, spot: NDArray[np.float64], facing: NDArray[np.float64], looks: int = LOOKS) -> None:
    """Put the robot at `spot` [m], [2], facing the point `facing` [m], [3], after `looks` looks around from there."""
    heading = math.atan2(facing[1] - spot[1], facing[0] - spot[0])
    base = env.base
    for look in reversed(range(looks)):
        turned = torch.tensor([heading + look * 2.0 * math.pi / LOOKS])
        base.agent.place(torch.tensor([0]), torch.tensor(np.float32(spot))[None], turned)
        base.episode.freeze(base.agent.gripper_pose())  # what it holds comes along
        base.world.read()
        base.episode.see(base.agent)
        env.look()


def _around(env: SkillEnv, index: int, floor: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places [m], [P, 2], of the `floor` [m], [C, 2], within the arm's span of the thing: PLACES of them at most."""
    thing = env.stage.position(index)
    nearest, farthest = env.stage.robot.build.span(float(thing[2]))
    far = np.hypot(*(floor - thing[:2]).T)
    able = floor[(far >= nearest) & (far <= farthest)]
    return able[np.linspace(0, len(able) - 1, min(PLACES, len(able))).astype(int)]


def _reachable(
    env: SkillEnv, index: int, floor: NDArray[np.float64], spot: NDArray[np.float64], again: Callable[[], object]
) -> bool:
    """Whether the thing is reachable for a robot that starts at `spot` [m], [2]: see the module."""
    again()
    start = env.stage.position(index)
    _stand(env, spot, start)
    frames = _quickest(env, index)
    for _ in range(math.ceil(frames)):
        env.run(_wait(env))
    if float(np.linalg.norm(env.stage.position(index) - start)) > MOVED:
        able = np.hypot(*(floor - spot).T) <= frames * env.stage.robot.build.forward_step + FLOOR_CELL
        floor = floor[able]
    for place in [spot, *_around(env, index, floor)]:
        _stand(env, place, env.stage.position(index), looks=1)
        env.stage.robot.use_hand(env.stage.position(index))
        if free_postures(env.stage, index):
            return True
    return False


def _quickest(env: SkillEnv, index: int) -> float:
    """The least frames that the arm needs to the thing from where the base stands; 0 if it is too short."""
    stage = env.stage
    stage.robot.use_hand(stage.position(index))
    gaps = [stage.arm_gap(p.arm) for p in reaching(stage, index)]
    return min(gaps, default=0.0) / stage.robot.build.arm_step


def _wait(env: SkillEnv) -> Skill:
    yield env.stage.act()
    return Result(True, frames=1)


def report(made: Sequence[Handling]) -> str:
    """The table of `made`: how often each verb works, how many frames it takes, and what failures cost by reason."""
    lines = []
    for robot, verb in sorted({(h.robot, h.verb) for h in made}, reverse=True):
        rows = [h for h in made if (h.robot, h.verb) == (robot, verb)]
        able = [h for h in rows if h.reachable]
        worked = [h.frames for h in rows if h.ok]
        share = f"{len(worked)} of {len(able)} reachable worked ({len(worked) / max(len(able), 1):.1%})"
        lines.append(f"{robot} {verb}: {len(rows)} tried, {share}; frames {_frames(worked)}")
        for reason, number in Counter(h.reason for h in rows if not h.ok).most_common():
            failed = [h for h in rows if h.reason == reason]
            able_too = sum(h.reachable for h in failed)
            lines.append(f"  {reason}: {number}, {able_too} reachable; frames {_frames([h.frames for h in failed])}")
    return "\n".join(lines)


def _frames(frames: Sequence[int]) -> str:
    if not frames:
        return "-"
    return f"median {np.median(frames):.0f}, mean {np.mean(frames):.0f}, most {max(frames)}"


def lines(made: Sequence[Handling]) -> str:
    """The text of a file of `made`, one JSON object a line."""
    return "".join(json.dumps(asdict(h)) + "\n" for h in made)
