"""The skill `push`: the robot grips a cart and takes it near to a place. It pushes it, or draws it, driving backwards.

It uses at most 196 N (hazard_ms.simulation.mitigation.hitch), what a cart of 22 kg with 18 kg in it takes to slide at
a friction of 0.5, and stops where the cart lags behind. On a GPU furniture stands fast, and no cart moves.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.simulation.mitigation.hitch import GIVE, Hitch
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.motion import Watch, drive, move_by, turn_to, wrap
from hazard_ms.skills.motor.navigation import Path, Ways
from hazard_ms.skills.motor.walking import known, way_to

PUSH_FRAMES = 600  # budget of one push, the walk to the cart included [ours: 4 m of way and 4 m with the cart]
THERE = 0.25  # distance from where it should end at which the cart has arrived [m] [ours]
GAP = 0.06  # between cart and base at which the base grips it [m] [ours: more than the grip gives way]
STAND_OFF = 0.3  # gap between cart and base where the walk to it ends [m] [ours]
NEARLY = 0.15  # distance from there at which it has ended [m] [ours]
SLIPPED = 1.5 * GIVE  # lag behind the base at which the cart is held fast [m]
RAMP = 15  # frames in which the base comes up to speed: 1 m/s^2, 22 N more for a cart of 22 kg [ours]
MOST_TURN = np.deg2rad(2.0)  # that the base turns in a frame while it has a cart [rad] [ours]
WALKS = 4  # drives to the cart, with a look after each, at most [ours]
CART_RADIUS = 0.5  # of the floor that a cart needs around its middle: it is 0.55 m x 0.93 m [m] [ours]
OWN = 0.65  # around the middle of the cart, in which what the map shows is the cart [m] [ours]
STEP = 0.1  # between the points of a way of a cart [m] [ours]
SIGHT = 5  # points ahead of where it is for which the base makes [ours]
WINDOW = 8  # points ahead among which the cart is looked for: it cannot skip a bend [ours]
CLOSE = 0.05  # distance from the end of its way at which a cart is there [m] [ours]
STRAYED = 0.5  # distance from its way at which a cart no longer follows it [m] [ours]
DRAWS = 1.0  # by which the way to push may be shorter before it draws [m] [ours: it then is where the cart was to go]

Place = NDArray[np.float64]  # x, y [m], world frame


def push(stage: Stage, index: int, goal: tuple[float, float], near: float = 0.0, frames: int = PUSH_FRAMES) -> Skill:
    """Take the cart that the map knows as `index` until its middle is within `near` + THERE of `goal` [m], world frame.

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
    if _left(stage, cart, aim) <= near + THERE:
        return Result(True)
    (path,) = cart_ways(stage.seen, stage.position(cart)[:2], [aim], near)
    if path is None:
        return Result(False, failures.NO_PATH)
    way = _points(stage.position(cart)[:2].astype(np.float64), path)
    walked = yield from _get_there(stage, cart, way, frames)
    if not walked.ok:
        return walked
    sign = 1.0 if float((stage.position(cart)[:2] - stage.robot.base()[:2]) @ _ahead(way)) > 0.0 else -1.0
    _lift_off_maps(stage, cart)
    with gripped(stage, load) as grip:
        pushed = yield from _take(stage, cart, way, grip, sign, frames - walked.frames)
    back = yield from move_by(stage, -STAND_OFF)
    stage.look()
    arrived = _left(stage, cart, aim) <= near + THERE
    used = walked.frames + pushed.frames + back.frames
    return Result(arrived, "" if arrived else pushed.reason or failures.BLOCKED, used)


@contextmanager
def gripped(stage: Stage, load: object) -> Iterator[Hitch]:
    """A grip of the robot's base on a `load`, which ends with the block, however that ends."""
    grip = Hitch(stage.robot.base_body(), load)
    try:
        yield grip
    finally:
        grip.release()


def cart_ways(
    seen: SemanticMap, cart: NDArray[np.floating], goals: Sequence[NDArray[np.floating]], near: float
) -> list[Path | None]:
    """The ways of a cart at `cart` to within `near` of each of `goals` [m], [2] each, over the map; None where none is.

    They may end THERE farther away than `near`.
    """
    y, x = np.nonzero(seen.height > 0.0)
    own = np.hypot(*(seen.centre_of(y, x) - cart).T) <= OWN
    height = np.array(seen.height)
    height[y[own], x[own]] = 0.0
    start, ends = (float(cart[0]), float(cart[1])), [(float(goal[0]), float(goal[1])) for goal in goals]
    if not ends:
        return []
    ways = Ways(height, seen.explored, seen.cell, seen.origin, start, ends, CART_RADIUS)
    found = [ways.path(end, near, near + THERE) for end in ends]
    return [path if path and path.short <= near + THERE and path.length > 0.0 else None for path in found]


def _points(cart: Place, path: Path) -> Place:
    """Points every STEP along a `path` from `cart` on [m], [P, 2]."""
    corners = np.vstack([cart[None], path.points])
    steps = np.hypot(*np.diff(corners, axis=0).T)
    far = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.append(np.arange(0.0, far[-1], STEP), far[-1])
    return np.stack([np.interp(at, far, corners[:, axis]) for axis in (0, 1)], -1)


def _left(stage: Stage, cart: int, aim: Place) -> float:
    return float(np.hypot(*(aim - stage.position(cart)[:2])))


def _lift_off_maps(stage: Stage, cart: int) -> None:
    """Forget where the maps show the cart, which is about to go: looks after that show it where it is then."""
    y, x = np.mgrid[-OWN : OWN + STEP : STEP, -OWN : OWN + STEP : STEP]
    around = np.stack([x, y], -1)[np.hypot(y, x) <= OWN]
    for seen in stage.maps:
        seen.clear(stage.position(cart)[:2] + around)


def _reach(stage: Stage, cart: int, along: Place) -> float:
    """Distance from the cart's middle to where the base's middle would touch it, against the unit vector `along`."""
    w, _, _, z = stage.world.rotation[0, cart].tolist()
    turn = 2.0 * np.arctan2(z, w)
    axes = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    half = stage.world.extent[0, cart, :2].cpu().numpy() / 2.0
    shares = np.abs(axes @ along)
    with np.errstate(divide="ignore"):
        edge = float(np.min(half / shares))  # where the line through the middle leaves the box
    return edge + stage.robot.build.radius


def _ahead(way: Place) -> Place:
    """The direction in which a `way` [m], [P, 2], begins: a unit vector, [2]."""
    ahead = way[min(SIGHT, len(way) - 1)] - way[0]
    return np.asarray(ahead / max(float(np.hypot(*ahead)), 1e-6))


def _spots(stage: Stage, cart: int, way: Place) -> tuple[Place, Place]:
    """Where the walk to the cart should end, to draw it and to push it [m], [2] each."""
    along = _ahead(way)
    off = (_reach(stage, cart, along) + STAND_OFF) * along
    middle = stage.position(cart)[:2].astype(np.float64)
    return middle + off, middle - off


def _get_there(stage: Stage, cart: int, way: Place, frames: int) -> Skill:
    """Walk to the side of the cart from which it is drawn or pushed, face it, and come up to it."""
    draw, shove = _spots(stage, cart, way)
    here = np.array(stage.robot.base()[:2])
    order = [draw, shove]
    if np.hypot(*(draw - here)) > np.hypot(*(shove - here)) + DRAWS:
        order.reverse()
    used, reason = 0, failures.NO_PATH
    for spot in order:
        walked = yield from _walk(stage, spot, frames - used)
        used += walked.frames
        if walked.ok:
            break
        reason = walked.reason
        if reason == failures.MAX_FRAMES:
            return Result(False, reason, used)
    else:
        return Result(False, reason, used)
    middle = stage.position(cart)[:2]
    used += (yield from turn_to(stage, (float(middle[0]), float(middle[1])))).frames
    there = middle - stage.robot.base()[:2]
    far = float(np.hypot(*there))
    gap = far - _reach(stage, cart, there / max(far, 1e-6)) - GAP
    if gap > 0.0:
        used += (yield from move_by(stage, gap)).frames
    return Result(used < frames, "" if used < frames else failures.MAX_FRAMES, used)


def _walk(stage: Stage, spot: Place, frames: int) -> Skill:
    """Walk to within STAND_OFF of a `spot` [m]."""
    used, reason = 0, failures.NO_PATH
    for _ in range(WALKS):
        if np.hypot(*(spot - stage.robot.base()[:2])) <= NEARLY:
            break
        path = way_to(stage, (float(spot[0]), float(spot[1])), NEARLY / 2.0, NEARLY)
        if path is None or path.length < NEARLY or path.short > STAND_OFF:
            break
        walked = yield from drive(stage, path.points, frames - used)
        used, reason = used + walked.frames, walked.reason or reason
        if walked.reason == failures.MAX_FRAMES:
            return Result(False, failures.MAX_FRAMES, used)
        stage.look()  # from here it may see a way to go nearer
    arrived = bool(np.hypot(*(spot - stage.robot.base()[:2])) <= STAND_OFF)
    return Result(arrived, "" if arrived else reason, used)


def _take(stage: Stage, cart: int, way: Place, grip: Hitch, sign: float, frames: int) -> Skill:
    """Drive with the cart along the `way` of its middle, with the cart before the base, or, backwards, behind it."""
    watch, at, best = Watch(), 0, np.inf
    lead = np.diff(way[-2:], axis=0)[0] if len(way) > 1 else np.zeros(2)
    onward = way[-1] + lead / max(float(np.hypot(*lead)), 1e-6) * STEP * np.arange(1, 40)[:, None]
    whole = np.vstack([way, onward])
    for used in range(max(0, frames)):
        x, y, heading = stage.robot.base()
        middle = stage.position(cart)[:2]
        gaps = np.hypot(*(way[at : at + WINDOW] - middle).T)
        at += int(gaps.argmin())
        left = STEP * (len(way) - 1 - at) + float(np.hypot(*(way[-1] - middle))) * (at == len(way) - 1)
        if at == len(way) - 1 and (left < CLOSE or left > best):  # it is there, or as near as it gets
            return Result(True, frames=used)
        best = left if at == len(way) - 1 else np.inf
        if grip.slip() > SLIPPED or gaps.min() > STRAYED:
            return Result(False, failures.BLOCKED, used)
        between = round(float(np.hypot(middle[0] - x, middle[1] - y)) / STEP) if sign < 0.0 else 0
        to = whole[min(at + between + SIGHT, len(whole) - 1)]
        off = wrap(np.arctan2(to[1] - y, to[0] - x) - heading - (np.pi if sign < 0.0 else 0.0))
        forward = stage.robot.build.forward_step * min(1.0, (used + 1) / RAMP) * min(1.0, max(left, 0.1) / 0.3)
        if watch.stuck(x, y, forward):
            return Result(False, failures.BLOCKED, used)
        yield stage.act(sign * forward, float(np.clip(off, -MOST_TURN, MOST_TURN)))
    return Result(False, failures.MAX_FRAMES, max(0, frames))
