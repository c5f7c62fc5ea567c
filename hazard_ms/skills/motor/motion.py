"""Skills of the base: move_by, turn_by, turn_to, drive.

Each has a budget of frames and notices when it is stuck.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.failures import BLOCKED, MAX_FRAMES

CLOSE = 0.02  # remaining distance at which a drive has arrived [m]
ALIGNED = np.deg2rad(2.0)  # remaining angle at which a turn is complete [rad]
ALONG = np.deg2rad(25.0)  # the base drives while its path lies within this angle, else it turns on the spot [rad]
PASSED = 0.10  # distance at which a point of a path counts as passed [m]
WATCH = 12  # frames over which progress is measured
STUCK = 0.25  # share of the commanded distance below which the base counts as stuck
BACK_OFF = 0.15  # distance by which the base backs off from what it ran into [m]


def wrap(angle: float) -> float:
    """`angle` [rad] between -pi and pi."""
    return float(np.arctan2(np.sin(angle), np.cos(angle)))


def turned(point: NDArray[np.float64], about: tuple[float, float], turn: float) -> NDArray[np.float64]:
    """`point` [m], [3], turned by `turn` [rad], anticlockwise, about the upright axis through `about` [m]."""
    x, y = point[:2] - about
    cos, sin = np.cos(turn), np.sin(turn)
    return np.array([about[0] + cos * x - sin * y, about[1] + sin * x + cos * y, point[2]])


def finite(number: float, name: str) -> float:
    """`number` as a float. Raises ValueError where it is not finite."""
    if not np.isfinite(number):
        raise ValueError(f"{name} must be finite, got {number!r}")
    return float(number)


def turn_by(stage: Stage, angle: float, frames: int | None = None) -> Skill:
    """Turn on the spot by `angle` [rad], anticlockwise, in at most `frames`; None: about twice the time it takes."""
    return (yield from _turn(stage, finite(angle, "angle"), frames))


def turn_to(stage: Stage, point: tuple[float, float] | NDArray[np.float64], frames: int | None = None) -> Skill:
    """Turn on the spot until facing `point`, [2] or [3] [m], world frame. Raises ValueError where it is not finite."""
    x, y, heading = stage.robot.base()
    angle = wrap(np.arctan2(finite(point[1], "point's y") - y, finite(point[0], "point's x") - x) - heading)
    return (yield from _turn(stage, angle, frames))


def _turn(stage: Stage, left: float, frames: int | None) -> Skill:
    limit = stage.robot.build.turn_step
    budget = frames if frames is not None else int(2 * abs(left) / limit) + 10
    before = stage.robot.base()[2]
    for used in range(budget):
        now = stage.robot.base()[2]
        left -= wrap(now - before)  # the simulator's heading jumps by whole turns
        before = now
        if abs(left) < ALIGNED:
            return Result(True, frames=used)
        yield stage.act(turn=float(np.clip(left, -limit, limit)))
    return Result(False, MAX_FRAMES, budget)


def move_by(stage: Stage, distance: float, frames: int | None = None) -> Skill:
    """Drive straight by `distance` [m], backwards if negative; it fails as BLOCKED if something stops the base."""
    x, y, heading = stage.robot.base()
    limit = stage.robot.build.forward_step
    budget = frames if frames is not None else int(2 * abs(finite(distance, "distance")) / limit) + 10
    watch = Watch()
    for used in range(budget):
        now_x, now_y, now = stage.robot.base()
        left = distance - ((now_x - x) * np.cos(heading) + (now_y - y) * np.sin(heading))
        if abs(left) < CLOSE:
            return Result(True, frames=used)
        forward = float(np.clip(left, -limit, limit))
        if watch.stuck(now_x, now_y, forward):
            return Result(False, BLOCKED, used)
        yield stage.act(forward, wrap(heading - now))
    return Result(False, MAX_FRAMES, budget)


class Watch:
    """Notices when a base that should drive makes no progress."""

    def __init__(self) -> None:
        self._track: list[tuple[float, float, float]] = []

    def stuck(self, x: float, y: float, forward: float) -> bool:
        """Whether the last frames brought much less than was commanded.

        It is called once a frame, with what is commanded next.
        """
        if forward == 0.0:
            self._track.clear()  # turning on the spot is not being stuck
        self._track.append((x, y, abs(forward)))
        if len(self._track) <= WATCH:
            return False
        old_x, old_y, _ = self._track.pop(0)
        commanded = sum(step for _, _, step in self._track[:-1])
        return bool(np.hypot(x - old_x, y - old_y) < STUCK * commanded)


def drive(stage: Stage, points: NDArray[np.float64], frames: int) -> Skill:
    """Drive through `points` [m], [P, 2], in turn.

    If the base runs into something, it backs off, remembers the place, and fails as BLOCKED.
    """
    watch, used = Watch(), 0
    for number, point in enumerate(points):
        last = number == len(points) - 1
        while True:
            x, y, heading = stage.robot.base()
            far = float(np.hypot(point[0] - x, point[1] - y))
            if far < (CLOSE if last else PASSED):
                break
            if used >= frames:
                return Result(False, MAX_FRAMES, used)
            off = wrap(np.arctan2(point[1] - y, point[0] - x) - heading)
            if last and far < 2 * CLOSE and abs(off) > ALONG:
                break  # just overshot: not worth turning round
            forward = min(far, stage.robot.build.forward_step) if abs(off) < ALONG else 0.0
            if watch.stuck(x, y, forward):
                stage.bump()
                back = yield from move_by(stage, -BACK_OFF, min(frames - used, 2 * WATCH))
                return Result(False, BLOCKED, used + back.frames)
            yield stage.act(forward, off)
            used += 1
    return Result(True, frames=used)
