"""The skills `open` and `shut`: the hand takes the handle, and the leaf turns, assisted as a grasp is.

The robot walks to where its arm is long enough for the handle and brings its hand there. Then it steps out of the
leaf's way, if it stands in it, and the leaf turns over its time; the hand follows as far as the arm gets.

Where the leaf needs more force at the handle (hazard_ms.simulation.mitigation.hinges) than the arm's pull
(Build.pull: 59 N for Fetch, 29 N for G1), it is held. Limits: latches are not locked; leaves of outer doors and
windows are not drawn open; the force is checked before and during the turn, but the leaf is not pressed back.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from hazard_ms.simulation.mitigation import hinges
from hazard_ms.simulation.openings import EVERY
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.mitigations.approach import approach
from hazard_ms.skills.mitigations.guiding import guide
from hazard_ms.skills.mitigations.handles import ASIDE, CLOSE, ENOUGH, Place, home_side, stand
from hazard_ms.skills.mitigations.leaf import Leaf
from hazard_ms.skills.motor.arm import REACH_FRAMES, fold, follow, go, lacking, never, posture_for
from hazard_ms.skills.motor.grasping import APPROACH_FRAMES
from hazard_ms.skills.motor.motion import drive, turn_to
from hazard_ms.skills.motor.navigation import Path, Ways
from hazard_ms.skills.motor.routes import quickest
from hazard_ms.skills.motor.surface import Leg, Surface
from hazard_ms.skills.motor.surface import Place as Around
from hazard_ms.spec.robot import GRASP_REACH

WINDOW_SHARE = 0.9  # how far a window opens: a pane that is wholly out is broken [ours]
STANDS = 3  # places at which it tries to take the handle [ours]
NEAR = 0.85  # share of the arm's span within which it walks where no place is known [ours]
OFF_FACE = 0.08  # of the place for the hand from the middle of the leaf [m] [ours]
SAG = 0.05  # by which a stretched arm hangs lower than it should [m] [ours: Fetch's 0.05 to 0.08]
TURNING = 0.5  # metres of way that it takes as long to turn and drive forwards as to back [ours]
STRAIGHT = 0.05  # of a way that leads straight back: distance from the line [m] [ours]
RINGS, DIRECTIONS = (0.3, 0.6, 0.9, 1.2, 1.6), 16  # where it looks for a place aside: distances [m], number of ways
FOLLOW_EVERY = 3  # frames from one posture of the hand at the handle to the next [ours]
AROUND = 0.25  # of the handle, within which the arm may come to the leaf [m] [ours]


def shut_ones(stage: Stage) -> tuple[str, ...]:
    """Names of the doors and windows that are known to be shut, or not wholly open."""
    rows = stage.doors.rows() if stage.held < 0 else ()
    return tuple(o.name for o in rows if o.kind != "doorway" and not o.broken and o.open < _most(o.kind))


def open_ones(stage: Stage) -> tuple[str, ...]:
    """Names of the doors and windows that are known to be open, at least a little."""
    rows = stage.doors.rows() if stage.held < 0 else ()
    return tuple(o.name for o in rows if o.kind != "doorway" and not o.broken and o.open > 0.0)


def open_door(stage: Stage, name: str) -> Skill:
    """Open the door or window called `name` as far as it goes."""
    return (yield from _turn(stage, name, True))


def shut_door(stage: Stage, name: str) -> Skill:
    """Shut the door or window called `name`."""
    return (yield from _turn(stage, name, False))


def _turn(stage: Stage, name: str, opening: bool) -> Skill:
    known = stage.doors.find(name)
    if known is None:
        return Result(False, failures.UNKNOWN)
    if stage.held >= 0:
        return Result(False, failures.ALREADY_HOLDING)
    if known.kind == "doorway":
        return Result(False, failures.NO_LEAF)
    leaf = Leaf(stage.world, known.number)
    goal = hinges.angle(_most(known.kind)) if opening else 0.0
    home = home_side(stage, leaf)
    taken = yield from _get_hold(stage, leaf, goal, home)
    reason, used = taken.reason, taken.frames
    if _settled(leaf, goal):
        return Result(not leaf.broken, failures.BROKEN if leaf.broken else "", used)
    if not reason and leaf.force(opening) > stage.robot.build.pull:
        reason = failures.HELD_SHUT if opening else failures.HELD_OPEN
    if not reason:
        by_hand = opening and stage.world.door_grip is not None
        turned = yield from (guide(stage, leaf, goal) if by_hand else _lead(stage, leaf, goal, opening, home))
        reason, used = turned.reason, used + turned.frames
        stage.doors.enter(known.number, stage.frame, stage.maps)
    if taken.ok:
        used += (yield from fold(stage, _around(leaf.handle()))).frames
    return Result(not reason, reason, used)


def _settled(leaf: Leaf, goal: float) -> bool:
    return leaf.broken or abs(leaf.angle - goal) < 1e-3


def _get_hold(stage: Stage, leaf: Leaf, goal: float, home: float) -> Skill:
    """Bring the hand to the handle from the best place, and from the next best ones where the arm does not get there.

    It ends early where the leaf turns out to be at the angle `goal` [rad] already, or broken.
    """
    handle, used, tried = leaf.handle(), 0, list[Place]()
    farthest = stage.robot.build.span(float(handle[2]))[1]
    for _ in range(STANDS):
        place = stand(stage, leaf, goal, home, tried)
        if place is None:  # not seen yet, or nowhere to stand: as near as it gets
            walked = yield from approach(stage, handle, NEAR * farthest, farthest + GRASP_REACH)
        else:
            walked = yield from approach(stage, np.array(place), CLOSE, ENOUGH, _at(stage, place))
        used += walked.frames
        if walked.reason in (failures.MAX_FRAMES, failures.NO_PATH):
            return Result(False, walked.reason, used)
        used += (yield from turn_to(stage, handle)).frames
        stage.doors.enter(leaf.number, stage.frame, stage.maps)  # it stands before it now
        if _settled(leaf, goal):
            return Result(False, frames=used)
        taken = yield from _take(stage, handle)
        used += taken.frames
        if taken.ok:
            return Result(True, frames=used)
        used += (yield from fold(stage, _around(handle))).frames
        tried += [stage.robot.base()[:2]] if place is None else [place, stage.robot.base()[:2]]
    return Result(False, failures.UNREACHABLE, used)


def _at(stage: Stage, place: Place) -> Callable[[], bool]:
    return lambda: float(np.hypot(*np.subtract(stage.robot.base()[:2], place))) < CLOSE


def _most(kind: str) -> float:
    return WINDOW_SHARE if kind == "window" else 1.0


def _around(handle: NDArray[np.float64]) -> Around:
    return Around(handle, AROUND, 0.0, float(handle[2]) + AROUND)


def _take(stage: Stage, handle: NDArray[np.float64]) -> Skill:
    """Bring the hand to the `handle`, [3] [m]; it fails where it does not get within a grasp's reach."""
    stage.robot.use_hand(handle)
    x, y, _ = stage.robot.base()
    towards = np.array([x - handle[0], y - handle[1], 0.0])
    aim = handle + OFF_FACE * towards / max(float(np.hypot(*towards[:2])), 1e-6) + (0.0, 0.0, SAG)

    def there() -> bool:
        return float(np.linalg.norm(stage.robot.hand() - handle)) < 0.9 * GRASP_REACH

    posture = posture_for(stage, aim)
    if posture.error > GRASP_REACH:
        return Result(False, failures.UNREACHABLE)
    route = quickest(stage, [Leg(posture.arm, 0.0)], Surface(stage, _around(handle)), lacking(stage))
    moved = yield from follow(stage, route, there)
    used = moved.frames
    if not there():
        used += (yield from go(stage, posture.arm, REACH_FRAMES, there)).frames
    return Result(there(), frames=used)


def _lead(stage: Stage, leaf: Leaf, goal: float, opening: bool, home: float) -> Skill:
    """Step aside, and let the `leaf` turn to the angle `goal` [rad] over its time."""
    first = leaf.angle
    aside = yield from _step_aside(stage, leaf, goal, home)
    if not aside.ok:
        return aside
    used, tucked = aside.frames, aside.frames > 0
    rate = 1.0 / stage.env.control_timestep
    whole = hinges.OPENING_TIME if opening else hinges.SHUTTING_TIME
    steps = max(1, math.ceil(whole * rate * abs(goal - first) / (math.pi / 2)))
    arm = stage.robot.tucked if tucked else stage.robot.arm()
    for step in range(1, steps + 1):
        angle = first + (goal - first) * step / steps
        if leaf.broken:
            return Result(False, failures.BROKEN, used)
        if step % EVERY == 1 and leaf.force(opening) > stage.robot.build.pull:
            return Result(False, failures.HELD_SHUT if opening else failures.HELD_OPEN, used)
        if _obstructed(stage, leaf, leaf.angle, angle):
            return Result(False, failures.IN_THE_SWING, used)
        leaf.turn_to(angle)
        if not tucked and step % FOLLOW_EVERY == 0:
            posture = posture_for(stage, leaf.handle())
            arm = posture.arm if posture.error < GRASP_REACH else arm
        yield stage.act(arm=arm)
        used += 1
    return Result(True, frames=used)


def _step_aside(stage: Stage, leaf: Leaf, goal: float, home: float) -> Skill:
    """Drive to the nearest place out of the way of the `leaf`, on the side `home`; not at all if it is out already."""
    x, y, heading = stage.robot.base()
    radius = np.array([stage.robot.build.radius + ASIDE])
    if not leaf.meets(leaf.angle, goal, np.array([[x, y]]), radius):
        return Result(True)
    around = heading + np.pi + np.arange(DIRECTIONS) * 2.0 * np.pi / DIRECTIONS
    spots = [np.array([x + far * np.cos(a), y + far * np.sin(a)]) for far in RINGS for a in around]
    free = [
        (float(at[0]), float(at[1]))
        for at in spots
        if leaf.side(*at) * home > 0.0 and not leaf.meets(leaf.angle, goal, at[None], radius)
    ]
    if not free:
        return Result(False, failures.IN_THE_SWING)
    seen = stage.seen
    ways = Ways(stage.obstacles(), seen.explored, seen.cell, seen.origin, (x, y), free, float(radius[0]) - ASIDE)
    paths = [ways.path(goal_at, 0.0, seen.cell) for goal_at in free]
    reached = [path for path in paths if path is not None and path.short <= seen.cell and len(path.points)]
    if not reached:
        return Result(False, failures.IN_THE_SWING)
    best = min(reached, key=lambda path: path.length + TURNING * (_behind(path, (x, y, heading)) is None))
    back = _behind(best, (x, y, heading))
    if back is not None:
        moved: Result = yield from go(stage, stage.robot.tucked, REACH_FRAMES, never, 0.3, -back)
        return moved
    folded = yield from go(stage, stage.robot.tucked, REACH_FRAMES, never, 0.3)
    moved = yield from drive(stage, best.points, APPROACH_FRAMES)
    return Result(moved.ok, moved.reason, folded.frames + moved.frames)


def _behind(path: Path, base: tuple[float, float, float]) -> float | None:
    """Length [m] of a path that leads straight back from the `base`; None for others."""
    x, y, heading = base
    ahead = (path.points - (x, y)) @ np.array(
        [[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]]
    ).T
    return float(-ahead[-1, 0]) if (np.abs(ahead[:, 1]) < STRAIGHT).all() and ahead[-1, 0] < 0.0 else None


def _obstructed(stage: Stage, leaf: Leaf, first: float, last: float) -> bool:
    """Whether a robot, furniture, or a body too heavy to be pushed aside is in the way from `first` to `last`."""
    if not leaf.inner:
        return False
    world = stage.world
    robots = (stage.robot, *stage.others)
    bases, radii = [robot.base()[:2] for robot in robots], [robot.build.radius for robot in robots]
    if leaf.meets(first, last, np.array(bases), np.array(radii)):
        return True
    pushed = (stage.robot.build.pull - hinges.REST_FORCE) / (
        world.robot.friction * 9.81
    )  # mass that the leaf pushes [kg]
    there = world.exists[0] & ~world.away[0] & ~world.held[0] & (~world.movable[0] | (world.mass[0] > pushed))
    low = world.position[0, :, 2] - world.extent[0, :, 2] / 2
    there &= (low < leaf.o.sill + leaf.o.height) & (world.extent[0, :, 2] + low > leaf.o.sill + 0.02)
    rows = there.nonzero()[:, 0]
    points = world.position[0, rows, :2].cpu().numpy().astype(np.float64)
    half = world.extent[0, rows, :2].amin(1).cpu().numpy().astype(np.float64) / 2
    return len(points) > 0 and leaf.meets(first, last, points, half)
