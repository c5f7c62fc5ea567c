"""Skills of the arm: `reach_for` a point, `retract`. For things on furniture the arm unfolds above it first."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.failures import BLOCKED, MAX_FRAMES, UNREACHABLE
from hazard_ms.skills.motor.kinematics import Posture, solve
from hazard_ms.skills.motor.motion import CLOSE, finite, wrap

REACHED_ERROR = 0.05  # position error at which a posture counts as reaching its point [m]
OVER = 0.25  # the hand reaches things higher than this from above, with the arm unfolded first [m]
NEARLY = 0.35  # a posture on the way is passed when every joint is this close [rad]
THERE = 0.06  # a posture is reached when every joint is this close [rad]
REACH_FRAMES = 60  # budget of one movement of the arm [frames]
HOVER = 0.2  # height above a thing from which the hand comes down on it [m]
READY = 0.75  # share of the arm's span at which the hand is held out
ADVANCE = 0.02  # least decrease of the joint gap that counts as progress [rad]
STALLED_FRAMES = 10  # frames without progress after which something must be in the way


def posture_for(stage: Stage, point: NDArray[np.float64]) -> Posture:
    """A posture with the hand at `point`, [3] [m], world frame.

    The fingers point in the first direction that works, else in that which brings the hand nearest.
    """
    shoulder = stage.robot.shoulder()
    level = point[:2] - shoulder[:2]
    level = level / max(float(np.hypot(*level)), 1e-6)
    best: Posture | None = None
    for down in stage.robot.pointing:
        found = solve(stage.robot, point, np.array([*(np.cos(down) * level), -np.sin(down)]))
        if best is None or found.error < best.error:
            best = found
        if best.error < REACHED_ERROR:
            break
    assert best is not None
    return best


def reach_for(
    stage: Stage, point: tuple[float, float, float] | NDArray[np.float64], frames: int = REACH_FRAMES
) -> Skill:
    """Bring the hand to `point`, [3] [m], world frame, and leave it there; UNREACHABLE where the arm is too short.

    Raises ValueError for anything but three finite coordinates.
    """
    goal = np.array([finite(c, "coordinate of the point") for c in point])
    if goal.shape != (3,):
        raise ValueError(f"point must have 3 coordinates, got {tuple(goal)}")
    stage.robot.use_hand(goal)
    best = posture_for(stage, goal)
    if best.error > REACHED_ERROR:
        return Result(False, UNREACHABLE)
    used = 0
    if goal[2] > OVER:
        used += (yield from unfold(stage, goal[2] + HOVER)).frames
    there = yield from go(stage, best.arm, frames)
    return Result(there.ok, there.reason, used + there.frames)


def ready(stage: Stage, height: float) -> NDArray[np.float64]:
    """Arm joints, [..., J] [rad], with the hand straight before the shoulder, `height` [m] above the floor.

    The fingers slant down.
    """
    heading, build = stage.robot.base()[2], stage.robot.build
    ahead = READY * build.span(height)[1] - build.shoulder[0]
    level = np.array([np.cos(heading), np.sin(heading)])
    point = np.array([*(stage.robot.shoulder()[:2] + ahead * level), height])
    down = stage.robot.pointing[0]
    return solve(stage.robot, point, np.array([*(np.cos(down) * level), -np.sin(down)])).arm


def never() -> bool:
    """False, so that a movement goes on to its end."""
    return False


def go(
    stage: Stage,
    arm: NDArray[np.float64],
    frames: int,
    done: Callable[[], bool] = never,
    close: float = THERE,
    forward: float = 0.0,
) -> Skill:
    """Bring the arm to `arm`, [..., J] [rad], until every joint is `close` or `done`; drive by `forward` [m] meanwhile.

    It fails as BLOCKED if neither the arm nor the base gets any further.
    """
    x, y, heading = stage.robot.base()
    limit = stage.robot.build.forward_step
    best, since = np.inf, 0
    for used in range(frames):
        now_x, now_y, now = stage.robot.base()
        left = forward - ((now_x - x) * np.cos(heading) + (now_y - y) * np.sin(heading))
        driven = abs(left) < CLOSE or used > 2 * abs(forward) / limit  # a base that is held up must not hold up the arm
        gap = stage.arm_gap(arm)
        if done() or (gap < close and driven):
            return Result(True, frames=used)
        best, since = (gap, used) if gap < best - ADVANCE or not driven else (best, since)
        if used - since > STALLED_FRAMES:
            return Result(False, BLOCKED, used)
        yield stage.act(0.0 if driven else float(np.clip(left, -limit, limit)), wrap(heading - now), arm)
    return Result(False, MAX_FRAMES, frames)


def unfold(stage: Stage, height: float, forward: float = 0.0) -> Skill:
    """Bring the hand before the shoulder at `height` [m], upper arm first; drive by `forward` [m] meanwhile."""
    first = yield from go(stage, stage.robot.folded, REACH_FRAMES, close=NEARLY, forward=forward)
    then = yield from go(stage, ready(stage, height), REACH_FRAMES, close=NEARLY)
    return Result(then.ok, then.reason, first.frames + then.frames)


def retract(stage: Stage, over: float | None = None, forward: float = 0.0) -> Skill:
    """Fold the arm back beside the torso with what the hand holds, over the height `over` [m] or directly.

    The base drives by `forward` [m] before the elbow comes down.
    """
    used = 0
    if over is not None:
        used += (yield from go(stage, ready(stage, over), REACH_FRAMES, close=NEARLY)).frames
        used += (yield from go(stage, stage.robot.folded, REACH_FRAMES, close=NEARLY, forward=forward)).frames
    last = yield from go(stage, stage.robot.tucked, REACH_FRAMES, close=NEARLY)
    return Result(last.ok, last.reason, used + last.frames)
