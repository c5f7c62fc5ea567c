"""The skill `push`: the robot walks behind a cart, grips it and pushes it to a place.

It pushes with at most 196 N (hazard_ms.simulation.hitch), what a cart of 22 kg with 18 kg in it takes to slide at a
friction of 0.5, and stops where the cart lags behind. On a GPU furniture stands fast, and no cart moves.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from hazard_ms.simulation.hitch import GIVE, Hitch
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.motion import Watch, drive, move_by, turn_to, wrap
from hazard_ms.skills.motor.walking import known, way_to

PUSH_FRAMES = 400  # budget of one push, the walk behind the cart included [ours: 3 m of way and 2 m of push]
THERE = 0.25  # distance from the goal at which the cart has arrived [m] [ours]
BEHIND = 0.06  # gap between cart and base at which the base grips it [m] [ours: more than the grip gives way]
STAND_OFF = 0.3  # gap between cart and base where the walk behind it ends [m] [ours]
NEARLY = 0.15  # distance from there at which it has ended [m] [ours]
SLIPPED = 1.5 * GIVE  # lag behind the base at which the cart is held fast [m]
RAMP = 15  # frames in which the base comes up to speed: 1 m/s^2, 22 N more for a cart of 22 kg [ours]
MOST_TURN = np.deg2rad(2.0)  # that the base turns in a frame while it pushes [rad] [ours]
WALKS = 4  # drives behind the cart, with a look after each, at most [ours]


def push(stage: Stage, index: int, goal: tuple[float, float], frames: int = PUSH_FRAMES) -> Skill:
    """Push the cart that the map knows as `index` until its middle is within THERE of `goal` [m], world frame.

    Raises ValueError for a goal that is not finite.
    """
    if not np.isfinite(goal).all():
        raise ValueError(f"goal must be finite, got {goal!r}")
    if not known(stage, index):
        return Result(False, failures.UNKNOWN)
    cart = stage.labeller.thing(index)
    handles = stage.world.handles
    load = None if handles is None or cart < 0 else getattr(handles, "furniture", {}).get(cart)
    if load is None or not bool(stage.world.movable[0, cart]):
        return Result(False, failures.NOT_MOVABLE)
    aim = np.array(goal, np.float64)
    if _left(stage, cart, aim) <= THERE:
        return Result(True)
    walked = yield from _get_behind(stage, cart, aim, frames)
    if not walked.ok:
        return walked
    with gripped(stage, load) as grip:
        pushed = yield from _shove(stage, cart, aim, grip, frames - walked.frames)
    back = yield from move_by(stage, -STAND_OFF)
    stage.look()
    used = walked.frames + pushed.frames + back.frames
    arrived = _left(stage, cart, aim) <= THERE
    return Result(arrived, "" if arrived else pushed.reason or failures.BLOCKED, used)


@contextmanager
def gripped(stage: Stage, load: object) -> Iterator[Hitch]:
    """A grip of the robot's base on a `load`, which ends with the block, however that ends."""
    grip = Hitch(stage.robot.base_body(), load)
    try:
        yield grip
    finally:
        grip.release()


def _left(stage: Stage, cart: int, aim: NDArray[np.float64]) -> float:
    return float(np.hypot(*(aim - stage.position(cart)[:2])))


def _reach(stage: Stage, cart: int, along: NDArray[np.float64]) -> float:
    """Distance from the cart's middle to where the base's middle would touch it, against the unit vector `along`."""
    w, _, _, z = stage.world.rotation[0, cart].tolist()
    turn = 2.0 * np.arctan2(z, w)
    axes = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    half = stage.world.extent[0, cart, :2].cpu().numpy() / 2.0
    shares = np.abs(axes @ along)
    with np.errstate(divide="ignore"):
        edge = float(np.min(half / shares))  # where the line through the middle leaves the box
    return edge + stage.robot.build.radius


def _get_behind(stage: Stage, cart: int, aim: NDArray[np.float64], frames: int) -> Skill:
    """Walk to the side of the cart that lies away from `aim`, face the cart, and come up to it."""
    used, reason = 0, failures.NO_PATH
    for _ in range(WALKS):
        spot = _spot(stage, cart, aim)
        if np.hypot(*(spot - stage.robot.base()[:2])) <= NEARLY:
            break
        path = way_to(stage, (float(spot[0]), float(spot[1])), NEARLY / 2.0, NEARLY)
        if path is None or path.length < NEARLY:
            break
        walked = yield from drive(stage, path.points, frames - used)
        used, reason = used + walked.frames, walked.reason or reason
        if walked.reason == failures.MAX_FRAMES:
            return Result(False, failures.MAX_FRAMES, used)
        stage.look()  # from here it may see a way to go nearer
    if np.hypot(*(_spot(stage, cart, aim) - stage.robot.base()[:2])) > STAND_OFF:
        return Result(False, reason, used)
    middle = stage.position(cart)[:2]
    used += (yield from turn_to(stage, (float(middle[0]), float(middle[1])))).frames
    there = middle - stage.robot.base()[:2]
    far = float(np.hypot(*there))
    gap = far - _reach(stage, cart, there / max(far, 1e-6)) - BEHIND
    if gap > 0.0:
        used += (yield from move_by(stage, gap)).frames
    return Result(used < frames, "" if used < frames else failures.MAX_FRAMES, used)


def _spot(stage: Stage, cart: int, aim: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where the walk behind the cart should end [m], [2], world frame."""
    middle = stage.position(cart)[:2]
    along = (aim - middle) / max(float(np.hypot(*(aim - middle))), 1e-6)
    return np.asarray(middle - (_reach(stage, cart, along) + STAND_OFF) * along)


def _shove(stage: Stage, cart: int, aim: NDArray[np.float64], grip: Hitch, frames: int) -> Skill:
    """Drive on with the cart before the base until its middle is at `aim`, or no farther from it than it can get."""
    watch, best = Watch(), np.inf
    for used in range(max(0, frames)):
        x, y, heading = stage.robot.base()
        middle = stage.position(cart)[:2]
        left = float(np.hypot(*(aim - middle)))
        if left < 0.05 or left > best + THERE / 2.0:
            return Result(True, frames=used)
        best = min(best, left)
        if grip.slip() > SLIPPED:
            return Result(False, failures.BLOCKED, used)
        off = wrap(np.arctan2(aim[1] - y, aim[0] - x) - heading)
        forward = stage.robot.build.forward_step * min(1.0, (used + 1) / RAMP) * min(1.0, max(left, 0.1) / 0.3)
        if watch.stuck(x, y, forward):
            return Result(False, failures.BLOCKED, used)
        yield stage.act(forward, float(np.clip(off, -MOST_TURN, MOST_TURN)))
    return Result(False, failures.MAX_FRAMES, max(0, frames))
