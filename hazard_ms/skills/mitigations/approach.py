"""Walks to a place within reach of something that is not on the map as a thing: a handle, flames, or a doorway."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.arm import never
from hazard_ms.skills.motor.motion import drive, turn_to
from hazard_ms.skills.motor.walking import SLACK, TRIES, WALK_FRAMES, midpoint, way_to

INSIDE = 0.3  # distance from the middle of an opening at which a walk into it has arrived [m] [ours]
BEFORE = 1.0  # the same where that is not passable: before a door that is shut [m] [ours]


def walk_into(stage: Stage, opening: KnownOpening) -> Skill:
    """Walk into an `opening`, or to before it where it is shut."""
    walked = yield from approach(stage, np.array(opening.position), INSIDE, BEFORE)
    stage.look()
    return Result(walked.ok, walked.reason, walked.frames)


def approach(
    stage: Stage,
    goal: NDArray[np.float64],
    near: float,
    most: float,
    done: Callable[[], bool] = never,
    frames: int = WALK_FRAMES,
) -> Skill:
    """Walk to within `near` [m] of `goal`, [3] [m], world frame, and face it; `done` ends the walk early.

    Where it cannot get so near, at most `most` [m] are near enough. As other walks, it lasts `frames` at most.
    """
    used, tries = 0, 0
    while True:
        x, y, _ = stage.robot.base()
        if done():
            return Result(True, frames=used)
        path = None
        if float(np.hypot(goal[0] - x, goal[1] - y)) > near:
            path = way_to(stage, (float(goal[0]), float(goal[1])), near, max(near, most))
            if path is None or path.short > most:
                return Result(False, failures.NO_PATH, used)
        if path is None or path.length <= SLACK:
            turned = yield from turn_to(stage, goal, max(0, frames - used))
            return Result(turned.ok, turned.reason, used + turned.frames)
        step = yield from drive(stage, midpoint(path, stage.robot.base()), frames - used)
        used += step.frames
        tries += step.reason == failures.BLOCKED
        if step.reason == failures.MAX_FRAMES or (step.reason == failures.BLOCKED and tries >= TRIES):
            return Result(False, step.reason, used)
        stage.look()
