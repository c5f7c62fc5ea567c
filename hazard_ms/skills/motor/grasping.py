"""The skill `pick_up`: the arm goes to the thing; within a hand's breadth the hand shuts and holds it."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from hazard_ms.episode.grasp import GRASP_REACH
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.arm import HOVER, REACH_FRAMES, fold, follow, go, lacking, posture_for, postures
from hazard_ms.skills.motor.kinematics import lifted
from hazard_ms.skills.motor.motion import drive, turn_to
from hazard_ms.skills.motor.navigation import LOW
from hazard_ms.skills.motor.routes import NEARLY, Leg, Route, Surface, place_of, quickest
from hazard_ms.skills.motor.walking import known, way_to

LIMIT = 2.5  # greatest distance from the shoulder to the thing at which a pick-up begins (docs/benchmark.md 3) [m]
GRASP = 0.8 * GRASP_REACH  # the hand shuts this close to the thing [m]
CLEAR = 0.05  # the hand aims this far off the thing, so that it does not push it away [m]
GETS_THERE = GRASP - CLEAR  # position error of a posture at which the hand gets close enough to the thing [m]
APPROACH_FRAMES = 120  # budget for coming near enough [frames]
STAND_OFF = 0.85  # share of the arm's span at which the base stands for a pick-up
SHUT_FRAMES = 4  # frames that the hand needs to shut or to open
OVER = 0.25  # the hand comes down from above on things higher than this [m]
FEW_HITS = 30  # points of a route that may lie in something: the map is coarse, and makes things wider [ours]
ASTRAY = 0.4  # the hand is led to a thing that moved if it is this close [m] [ours]
TRIES = 2  # number of postures that are tried
GIVE_UP = 20  # frames after which no other posture is tried [ours]


def pick_up(stage: Stage, index: int) -> Skill:
    """Take the thing `index` into the hand.

    Turn to it, come nearer if the arm is too short, reach, grasp, fold the arm back.
    """
    reason = _refusal(stage, index)
    if reason:
        return Result(False, reason)
    used = 0
    if not _within_span(stage, stage.position(index)):
        used += (yield from come_near(stage, stage.position(index))).frames
    used += (yield from turn_to(stage, stage.position(index)[:2])).frames
    taken = yield from _take(stage, index)
    return Result(taken.ok, taken.reason, used + taken.frames)


def _refusal(stage: Stage, index: int) -> str:
    """The reason why a pick-up cannot begin; empty if it can."""
    if stage.held >= 0:
        return failures.ALREADY_HOLDING
    if not bool(stage.world.target[0, index]):
        return failures.NOT_A_TARGET
    if bool(stage.world.safe[0, index]):
        return failures.ALREADY_RESCUED
    if not known(stage, index):
        return failures.UNKNOWN
    if float(np.linalg.norm(stage.position(index) - stage.robot.shoulder())) > LIMIT:
        return failures.TOO_FAR
    return ""


def _within_span(stage: Stage, thing: NDArray[np.float64]) -> bool:
    x, y, _ = stage.robot.base()
    nearest, farthest = stage.robot.build.span(float(thing[2]))
    return nearest <= float(np.hypot(thing[0] - x, thing[1] - y)) <= farthest


def come_near(stage: Stage, thing: NDArray[np.float64]) -> Skill:
    """Drive to where the arm is long enough for `thing`, [3] [m], world frame; not at all if it stays too short."""
    nearest, farthest = stage.robot.build.span(float(thing[2]))
    path = way_to(stage, (float(thing[0]), float(thing[1])), max(nearest, farthest * STAND_OFF))
    if path is None or not len(path.points) or path.short > farthest + GRASP_REACH:
        return Result(False, failures.NO_PATH)
    return (yield from drive(stage, path.points, APPROACH_FRAMES))


def aims(stage: Stage, index: int) -> list[NDArray[np.float64]]:
    """Points, [3] [m], for the hand: above the thing, and before it as seen from the shoulder; a little off its box."""
    middle = stage.position(index)
    half = stage.world.extent[0, index].cpu().numpy().astype(np.float64) / 2
    towards = stage.robot.shoulder() - middle
    towards = towards / max(float(np.linalg.norm(towards)), 1e-6)
    top = middle + np.array([0.0, 0.0, float(half.min() if half[2] > 0.2 else half[2]) + CLEAR])
    before = middle + towards * (float(half[:2].min()) + CLEAR)
    return [top, before]


def _take(stage: Stage, index: int) -> Skill:
    """Reach for the thing from where the base stands; the arm is folded at the end, with or without the thing."""
    place = place_of(stage, index)
    used, tried = 0, set[int]()
    while len(tried) < TRIES and used <= GIVE_UP:
        stage.robot.use_hand(stage.position(index), len(tried))
        way = _way(stage, index, tried)
        if way is None:
            break
        number, route = way
        tried.add(number)
        used += (yield from _grasp(stage, index, route)).frames
        if stage.held == index:
            break
    if used:
        used += (yield from fold(stage, place)).frames
    return Result(stage.held == index, "" if stage.held == index else failures.UNREACHABLE, used)


def _grasp(stage: Stage, index: int, route: Route) -> Skill:
    """Follow `route`, go on to the thing's middle if another target is nearer, and shut the hand on it."""

    def close() -> bool:
        return stage.gap(index) < GRASP and stage.would_take() == index

    moved = yield from follow(stage, route, close)
    used, arm = moved.frames, route.legs[-1].arm
    if stage.would_take() != index and stage.gap(index) < ASTRAY:
        goal = stage.position(index) if moved.ok else aims(stage, index)[0]
        arm = posture_for(stage, goal).arm
        if not moved.ok:  # it touched something, or the thing moved: once more from above
            used += (yield from go(stage, lifted(stage.robot, arm, HOVER), REACH_FRAMES, close, NEARLY)).frames
        used += (yield from go(stage, arm, REACH_FRAMES, close)).frames
    if stage.would_take() == index:
        used += (yield from _shut(stage, index, arm)).frames
    return Result(stage.held == index, frames=used)


def _way(stage: Stage, index: int, tried: set[int]) -> tuple[int, Route] | None:
    """The quickest route to the thing, by its frames and what it touches, and the number of its goal.

    Goals in `tried` are left out; None if the arm is too short for all others, or too much is in its way. Aims and
    places of the base are tried in turn, until there is a route that touches nothing.
    """
    surface, back = Surface(stage, place_of(stage, index)), lacking(stage)
    heading, high = stage.robot.base()[2], stage.position(index)[2] > OVER
    best: tuple[int, Route] | None = None
    sides = len(stage.robot.pointing)
    ends = itertools.product(standings(stage, stage.position(index)), aims(stage, index))
    for first, (ahead, aim) in enumerate(ends):
        moved = ahead * np.array([np.cos(heading), np.sin(heading), 0.0])
        for number, posture in enumerate(postures(stage, aim - moved), first * sides):
            if number in tried or posture.error > GETS_THERE:
                continue
            above = lifted(stage.robot, posture.arm, HOVER) if high else None
            route = quickest(stage, [Leg(posture.arm, ahead)], surface, back, above)
            if best is None or route.cost < best[1].cost:
                best = number, route
        if best is not None and best[1].hits == 0:
            break
    return None if best is None or best[1].hits > FEW_HITS else best


def standings(stage: Stage, thing: NDArray[np.float64]) -> list[float]:
    """The distances [m] by which the base may drive on to reach for `thing`, [3] [m]: 0, and more if there is room."""
    x, y, _ = stage.robot.base()
    far = float(np.hypot(thing[0] - x, thing[1] - y))
    nearer = far - STAND_OFF * stage.robot.build.span(float(thing[2]))[1]
    room = stage.room_ahead(LOW, far) - stage.robot.build.radius
    ahead = min(nearer, room)
    return [0.0, ahead] if ahead > 0.0 else [0.0]


def can_reach(stage: Stage, index: int) -> bool:
    """Whether the arm is long enough for the thing `index` from where the base stands, were nothing in its way."""
    return any(p.error < GETS_THERE for aim in aims(stage, index) for p in postures(stage, aim))


def _shut(stage: Stage, index: int, arm: NDArray[np.float64]) -> Skill:
    """Shut the hand at `arm` [rad], [J], which takes the nearest target: the thing `index` by now."""
    used = 0
    while used < SHUT_FRAMES and stage.held != index:
        yield stage.act(arm=arm, shut=True)
        used += 1
    return Result(stage.held == index, frames=used)
