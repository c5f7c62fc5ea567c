"""The skills `walk_to` and `walk_one_step`: walks over the map along a path that is planned again at every midpoint."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.failures import BLOCKED, MAX_FRAMES, NO_PATH, UNKNOWN
from hazard_ms.skills.motor.motion import drive, turn_to
from hazard_ms.skills.motor.navigation import AT_MOST, Path, plan
from hazard_ms.skills.sightlines import behind
from hazard_ms.spec.robot import GRASP_REACH

WALK_FRAMES = 100  # budget of one walk (docs/benchmark.md 3) [frames]
ARRIVED = 0.5  # distance from the seen edge of the thing at which a walk has arrived (docs/benchmark.md 3) [m]
MIDPOINT = 1.0  # length of a path after which it is planned again [m]
TRIES = 3  # number of times that a walk may run into something before it fails
SLACK = 0.05  # distance at which the nearest passable point counts as reached [m]


def known(stage: Stage, index: int) -> bool:
    """Whether the thing was ever seen and is still remembered."""
    return index in stage.seen.objects


def way_to(stage: Stage, goal: tuple[float, float], near: float, enough: float | None = None) -> Path | None:
    """A path to within `near` [m] of `goal` [m] over the map as it is now; `enough` [m] as for `plan`."""
    x, y, _ = stage.robot.base()
    seen, radius = stage.seen, stage.robot.build.radius
    return plan(stage.obstacles(), seen.explored, seen.cell, seen.origin, (x, y), goal, radius, near, enough)


def behind_wall(stage: Stage, goal: tuple[float, float] | NDArray[np.float64]) -> bool:
    """Whether a wall on the map stands between the base and `goal` [m], [2] or [3], world frame."""
    seen = stage.seen
    return bool(behind(seen.height, seen.cell, seen.origin, np.array([stage.robot.base()[:2]]), goal)[0])


def walk_to(stage: Stage, index: int, frames: int = WALK_FRAMES, whole: bool = True) -> Skill:
    """Walk to the thing `index`, then face it.

    The walk ends 0.5 m before it, or at the nearest passable point if that is at arm's length. Unless `whole`, it ends
    at the first midpoint of the path.
    """
    used, tries = 0, 0
    while True:
        if not known(stage, index):
            return Result(False, UNKNOWN, used)
        thing = stage.seen.objects[index]
        goal = (float(thing.position[0]), float(thing.position[1]))
        edge = min(thing.radius, stage.labeller.half_width(index))
        path = _path(stage, goal, edge, float(thing.position[2]))
        if path is None:
            return Result(False, NO_PATH, used)
        if path.length <= SLACK:
            return (yield from _face(stage, goal, used, frames))
        first = midpoint(path, stage.robot.base())
        step = yield from drive(stage, first, frames - used)
        used += step.frames
        if step.reason == BLOCKED:
            tries += 1
        if step.reason == MAX_FRAMES or (step.reason == BLOCKED and tries >= TRIES):
            return Result(False, step.reason, used)
        stage.look()
        if step.ok and not whole:
            return Result(True, frames=used)
        if step.ok and first is path.points:
            return (yield from _face(stage, goal, used, frames))


def _path(stage: Stage, goal: tuple[float, float], edge: float, height: float) -> Path | None:
    """A path that ends where the robot has arrived, without points if it already has.

    It also ends where no nearer point is passable, if the arm is long enough for a thing at that `height` [m].
    """
    x, y, _ = stage.robot.base()
    near = ARRIVED + edge
    if np.hypot(goal[0] - x, goal[1] - y) <= near and not behind_wall(stage, goal):
        return Path(np.zeros((0, 2)), 0.0, 0.0)
    arm = max(ARRIVED, stage.robot.build.span(height)[1]) + GRASP_REACH
    path = way_to(stage, goal, near, min(near + AT_MOST, arm + edge))
    return path if path is not None and path.short <= arm + edge else None


def _face(stage: Stage, goal: tuple[float, float], used: int, frames: int) -> Skill:
    turned = yield from turn_to(stage, goal, max(0, frames - used))
    stage.look()
    return Result(True, frames=used + turned.frames)


def midpoint(path: Path, base: tuple[float, float, float]) -> NDArray[np.float64]:
    """Points [m], [P, 2], of the first part of a path, MIDPOINT long; all of it if little would be left."""
    if path.length < MIDPOINT + SLACK:
        return path.points
    points, at, left = [], np.array(base[:2]), MIDPOINT
    for point in path.points:
        step = float(np.hypot(*(point - at)))
        if step >= left:
            points.append(at + (point - at) * left / max(step, 1e-9))
            break
        points.append(point)
        at, left = point, left - step
    return np.array(points)
