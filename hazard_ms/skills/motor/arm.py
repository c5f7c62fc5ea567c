"""Skills of the arm: `reach_for` a point, `fold`. What the map shows is in the way decides how the arm gets there."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.failures import BLOCKED, MAX_FRAMES, UNREACHABLE
from hazard_ms.skills.motor.kinematics import Posture, shifted, solve
from hazard_ms.skills.motor.motion import BACK_OFF, CLOSE, finite, turn_by, wrap
from hazard_ms.skills.motor.routes import Route, quickest
from hazard_ms.skills.motor.surface import Leg, Place, Surface

REACHED_ERROR = 0.05  # position error at which a posture counts as reaching its point [m]
CARRIED = 0.6  # the arm counts as folded when every joint is this close; it goes on to fold while the base drives [rad]
THERE = 0.06  # a posture is reached when every joint is this close [rad]
REACH_FRAMES = 60  # budget of one movement of the arm [frames]
STARTING = 20  # frames by which the base takes longer for a way than at full speed, at least [ours]
ADVANCE = 0.06  # least decrease of the joint gap that counts as progress, or of the way left by as many frames [rad]
STALLED_FRAMES = 4  # frames without progress after which something must be in the way
HOVER = 0.1  # height above a thing from which the hand comes down on it [m] [ours]
WITHDRAWN = 0.2  # distance before a thing in furniture from which the hand goes in to it [m] [ours]
SPARE = 0.1  # how much more room than that of its elbow an arm may need, as the map makes furniture wider [m] [ours]
# turns of the base [rad], and how far it draws back [m], where something holds up the arm that folds [ours]
AWAY = ((0.0, 0.0), (0.0, BACK_OFF), (np.deg2rad(45.0), BACK_OFF), (np.deg2rad(-90.0), BACK_OFF))
LEG_ROOM = 0.4  # lower furniture does not hinder the unfolding arm [m]


def postures(stage: Stage, point: NDArray[np.float64], inward: NDArray[np.float64] | None = None) -> Iterator[Posture]:
    """Postures with the hand at `point`, [3] [m], world frame: one for each direction that fingers may point in.

    They point away from the shoulder, or `inward`, [2].
    """
    level = point[:2] - stage.robot.shoulder()[:2] if inward is None else inward
    level = level / max(float(np.hypot(*level)), 1e-6)
    for down in stage.robot.pointing:
        yield solve(stage.robot, point, np.array([*(np.cos(down) * level), -np.sin(down)]))


def posture_for(stage: Stage, point: NDArray[np.float64], inward: NDArray[np.float64] | None = None) -> Posture:
    """A posture with the hand at `point`, [3] [m], world frame; `inward` as for `postures`.

    The fingers point in the first direction that works, else in that which brings the hand nearest.
    """
    best: Posture | None = None
    for found in postures(stage, point, inward):
        if best is None or found.error < best.error:
            best = found
        if best.error < REACHED_ERROR:
            break
    assert best is not None
    return best


def before(stage: Stage, arm: NDArray[np.float64], surface: Surface, height: float = HOVER) -> NDArray[np.float64]:
    """The joints [rad], [..., J], with the hand `height` [m] above where it is at `arm` [rad], [..., J].

    Where there is furniture around the place of `surface`, the hand is before it instead.
    """
    out = WITHDRAWN * surface.outward if surface.out.any() else np.array([0.0, 0.0, height])
    return shifted(stage.robot, arm, out)


def reach_for(stage: Stage, point: tuple[float, float, float] | NDArray[np.float64]) -> Skill:
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
    surface = Surface(stage, Place(goal, 0.0, 0.0, 0.0))
    return (yield from follow(stage, quickest(stage, [Leg(best.arm, 0.0)], surface, 0.0)))


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
    build = stage.robot.build
    best, since = np.inf, 0
    for used in range(frames):
        now_x, now_y, now = stage.robot.base()
        left = forward - ((now_x - x) * np.cos(heading) + (now_y - y) * np.sin(heading))
        left = 0.0 if abs(left) < CLOSE else left
        gap = stage.arm_gap(arm)
        if done() or (gap < close and left == 0.0):
            return Result(True, frames=used)
        to_go = gap + abs(left) * build.arm_step / build.forward_step
        best, since = (to_go, used) if to_go < best - ADVANCE else (best, since)
        if used - since > STALLED_FRAMES:  # a base that is held up does not matter once the arm is there
            return Result(gap < close, "" if gap < close else BLOCKED, used)
        step = float(np.clip(left, -build.forward_step, build.forward_step))
        yield stage.act(step, wrap(heading - now), arm)
    return Result(False, MAX_FRAMES, frames)


def follow(stage: Stage, route: Route, done: Callable[[], bool] = never, close: float = THERE) -> Skill:
    """Take the arm, and the base, along `route` until the arm is `close` [rad] to its end, or `done`."""
    used, at = 0, 0.0
    for leg in route.legs:
        last = leg is route.legs[-1]
        driven = abs(leg.ahead - at) / stage.robot.build.forward_step
        frames = max(REACH_FRAMES, math.ceil(driven) + STARTING)
        moved = yield from go(stage, leg.arm, frames, done, close if last else leg.near, leg.ahead - at)
        used, at = used + moved.frames, leg.ahead
        if last or not moved.ok or done():
            break
    return Result(moved.ok, moved.reason, used)


def fold(stage: Stage, place: Place) -> Skill:
    """Fold the arm beside the torso with what the hand holds, away from the thing that stood at `place`."""
    tucked, back = stage.robot.tucked, lacking(stage)
    goals = [Leg(tucked, ahead) for ahead in {0.0, -back}]
    surface = Surface(stage, place)
    route = quickest(stage, goals, surface, back, before(stage, stage.robot.arm(), surface), leaving=True)
    moved = yield from follow(stage, route, close=CARRIED)
    if moved.ok:
        return moved
    freed = yield from go(stage, tucked, REACH_FRAMES, close=CARRIED, forward=-BACK_OFF)
    return Result(freed.ok, freed.reason, moved.frames + freed.frames)


def fold_until(stage: Stage, done: Callable[[], bool]) -> Skill:
    """Fold the arm beside the torso until `done`; BLOCKED where it cannot.

    Where something holds it up, the base draws back, then turns to one side, and to the other.
    """
    used = 0
    for turn, back in AWAY:
        used += (yield from turn_by(stage, turn)).frames if turn else 0
        used += (yield from go(stage, stage.robot.tucked, REACH_FRAMES, done, forward=-back)).frames
        if done():
            return Result(True, frames=used)
    return Result(False, BLOCKED, used)


def lacking(stage: Stage, turn: float = 0.0) -> float:
    """Distance [m] by which the base may have to draw back so that the arm can fold or unfold before furniture.

    The base faces where it will when it has turned by `turn` [rad], anticlockwise.
    """
    room = stage.robot.build.elbow_room
    missing = room - stage.room_ahead(LEG_ROOM, room, turn)
    return missing + SPARE if missing > 0.0 else 0.0
