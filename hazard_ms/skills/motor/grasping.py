"""The skill `pick_up`: the arm goes to the thing; within a hand's breadth the hand shuts and holds it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hazard_ms.episode.grasp import GRASP_REACH
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.arm import HOVER, fold, follow, go, lacking, posture_for, postures
from hazard_ms.skills.motor.drift import DRIFT_FRAMES, Drift
from hazard_ms.skills.motor.kinematics import Posture, lifted
from hazard_ms.skills.motor.motion import drive, turn_by, turn_to, turned
from hazard_ms.skills.motor.navigation import LOW
from hazard_ms.skills.motor.routes import CLOSELY, HIT_COST, Route, quickest
from hazard_ms.skills.motor.surface import NEARLY, Leg, Surface, place_of
from hazard_ms.skills.motor.walking import known, way_to

LIMIT = 2.5  # greatest distance from the shoulder to the thing at which a pick-up begins (docs/benchmark.md 3) [m]
GRASP = 0.8 * GRASP_REACH  # the hand shuts this close to the thing [m]
CLEAR = 0.05  # the hand aims this far off the thing, so that it does not push it away [m]
GETS_THERE = GRASP - CLEAR  # position error of a posture at which the hand gets close enough to the thing [m]
APPROACH_FRAMES = 120  # budget for coming near enough [frames]
STAND_OFF = 0.85  # share of the arm's span at which the base stands for a pick-up
SHUT_FRAMES = 4  # frames that the hand needs to shut or to open
OVER = 0.25  # the hand comes down from above on things higher than this [m]
TURNS = tuple(np.deg2rad([0.0, 30.0, -30.0, 60.0, -60.0]).tolist())  # of the base before it reaches [rad] [ours]
LEAST = 25.0  # a route that is at most this much longer than what it takes to turn is not bettered [frames] [ours]
FEW_HITS = 30  # points of a route that may lie in something: the map is coarse, and makes things wider [ours]
ASTRAY = 0.4  # the hand is led to a thing that moved if it is this close [m] [ours]
NEAR = 0.35  # and if it is this close where the arm was stopped [m] [ours]
ONCE_MORE = 75  # frames after which it is not led to a thing again where the arm was stopped [ours]
FREE = 0.2  # height by which the hand is raised from what it touched [m] [ours]
AGAIN_FRAMES = 20  # budget of each movement by which the hand is led to a thing anew [frames] [ours]
TRIES = 2  # number of postures that are tried
GIVE_UP = 20  # frames after which no other posture is tried [ours]
CHASES = 5  # number of times that the arm is led to where a moving thing will be [ours]
GIVE_UP_CHASE = 45  # frames after which neither that nor another way is tried [ours]
CHASE_FRAMES = 15  # first guess of how long the hand takes to a moving thing [frames] [ours]
HURRY = 3.0  # what a point that lies in something counts as much as, while a thing moves away [frames] [ours]
MISSED = 0.2  # distance between where a thing will be and where the hand goes at which the hand is led anew [m] [ours]


@dataclass(frozen=True)
class Way:
    """A way to a thing: the base turns, then the arm follows a route."""

    number: int  # of the posture
    turn: float  # of the base, anticlockwise [rad]
    route: Route
    meets: NDArray[np.float64]  # the thing's middle when the hand gets there, [3] [m], world frame
    frames: float  # that it takes at least
    cost: float  # these, and what touching things is likely to cost [frames]


def pick_up(stage: Stage, index: int) -> Skill:
    """Take what lies where the map has the thing `index`: turn to it, come nearer, reach, grasp, fold the arm back."""
    thing = stage.labeller.thing(index)
    reason = _refusal(stage, index, thing)
    if reason == failures.UNREACHABLE:  # nothing lies there: it only turns to the place
        x, y, _ = stage.seen.objects[index].position.tolist()
        return Result(False, reason, (yield from turn_to(stage, (x, y))).frames)
    if reason:
        return Result(False, reason)
    place = stage.position(thing)
    used = 0 if _within_span(stage, place) else (yield from come_near(stage, place)).frames
    used += (yield from turn_to(stage, stage.position(thing)[:2])).frames
    taken = yield from _take(stage, thing)
    return Result(taken.ok, taken.reason, used + taken.frames)


def _refusal(stage: Stage, index: int, thing: int) -> str:
    """The reason why a pick-up of `index`, which is `thing` along B, cannot begin; empty if it can."""
    told = next((target for target in stage.labeller.targets() if target.index == index), None)
    if stage.held >= 0:
        return failures.ALREADY_HOLDING
    if told is None:
        return failures.NOT_A_TARGET
    if told.rescued:
        return failures.ALREADY_RESCUED
    if not known(stage, index):
        return failures.UNKNOWN
    place = stage.position(thing) if thing >= 0 else stage.seen.objects[index].position
    if float(np.linalg.norm(place - stage.robot.shoulder())) > LIMIT:
        return failures.TOO_FAR
    if thing < 0:  # what really lies there is found out within reach alone
        return failures.UNREACHABLE
    if not bool(stage.world.target[0, thing]):
        return failures.NOT_A_TARGET
    return failures.ALREADY_RESCUED if bool(stage.world.safe[0, thing]) else ""


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


def aims(stage: Stage, middle: NDArray[np.float64], index: int) -> list[NDArray[np.float64]]:
    """Points, [3] [m], for the hand if the middle of the thing `index` were at `middle` [m], [3], world frame.

    Above the thing, and before it as seen from the shoulder; a little off its box.
    """
    half = stage.world.extent[0, index].cpu().numpy().astype(np.float64) / 2
    towards = stage.robot.shoulder() - middle
    towards = towards / max(float(np.linalg.norm(towards)), 1e-6)
    top = middle + np.array([0.0, 0.0, float(half.min() if half[2] > 0.2 else half[2]) + CLEAR])
    before = middle + towards * (float(half[:2].min()) + CLEAR)
    return [top, before]


def _take(stage: Stage, index: int) -> Skill:
    """Reach for the thing from where the base stands; the arm is folded at the end, with or without the thing."""
    place, drift = place_of(stage, index), Drift(stage, index)
    used, chases, tried = 0, 0, set[int]()
    stage.robot.use_hand(stage.position(index))
    while len(tried) < TRIES and used <= (GIVE_UP if chases == 0 else GIVE_UP_CHASE):
        way = _way_to_where_it_will_be(stage, index, tried, drift)
        if way is None:
            break
        used += (yield from turn_by(stage, way.turn)).frames if way.turn else 0
        used += (yield from _grasp(stage, index, way, drift)).frames
        if stage.held == index:
            break
        if chases < CHASES and float(np.linalg.norm(drift.ahead(1.0))) > 0.0:
            chases += 1
        else:
            tried.add(way.number)
            stage.robot.use_hand(stage.position(index), len(tried))
    if used:
        used += (yield from fold(stage, place)).frames
    return Result(stage.held == index, "" if stage.held == index else failures.UNREACHABLE, used)


def _grasp(stage: Stage, index: int, way: Way, drift: Drift) -> Skill:
    """Follow the `way`, go on to the thing's middle if another target is nearer, and shut the hand on it.

    It ends early if the thing will not be where the way leads.
    """
    arm, began = way.route.legs[-1].arm, stage.frame

    def astray() -> bool:
        if stage.frame - began < DRIFT_FRAMES:
            return False
        left = stage.arm_gap(arm) / stage.robot.build.arm_step
        meets = stage.position(index) + drift.ahead(left) - way.meets
        return bool(np.linalg.norm(meets[:2]) > MISSED)

    def close() -> bool:
        return stage.gap(index) < GRASP and stage.would_take() == index

    def done() -> bool:
        drift.note()
        return close() or astray()

    moved = yield from follow(stage, way.route, done)
    used = moved.frames
    near = stage.gap(index) < (ASTRAY if moved.ok else NEAR)
    if stage.would_take() != index and near and (moved.ok or used <= ONCE_MORE):
        goal = stage.position(index) if moved.ok else aims(stage, stage.position(index), index)[0]
        arm = posture_for(stage, goal).arm
        if not moved.ok:  # it touched something, or the thing moved: up, and once more from above
            raised = lifted(stage.robot, stage.robot.arm(), FREE)
            used += (yield from go(stage, raised, AGAIN_FRAMES, close, CLOSELY)).frames
            used += (yield from go(stage, lifted(stage.robot, arm, HOVER), AGAIN_FRAMES, close, NEARLY)).frames
        used += (yield from go(stage, arm, AGAIN_FRAMES, close)).frames
    if stage.would_take() == index:
        used += (yield from _shut(stage, index, arm)).frames
    return Result(stage.held == index, frames=used)


def _way_to_where_it_will_be(stage: Stage, index: int, tried: set[int], drift: Drift) -> Way | None:
    """The quickest way to the thing, or to where a thing that moves will be when the hand gets there."""
    if not drift.ahead(1.0).any():
        return _way(stage, index, tried, stage.position(index))
    way = _way(stage, index, tried, stage.position(index) + drift.ahead(CHASE_FRAMES), HURRY)
    return way and _way(stage, index, tried, stage.position(index) + drift.ahead(way.route.frames), HURRY)


def _way(
    stage: Stage, index: int, tried: set[int], middle: NDArray[np.float64], hit_cost: float = HIT_COST
) -> Way | None:
    """The quickest way to the thing at `middle` [m], [3], by its frames and what it touches.

    Goals in `tried` are left out; None if the arm is too short for all others, or too much is in its way. The base may
    turn first, or draw back meanwhile, unless the thing moves; that is tried until nothing better can be found.
    """
    place, best, number = replace(place_of(stage, index), middle=middle), None, 0
    for turn in TURNS if hit_cost == HIT_COST else TURNS[:1]:
        surface, back = Surface(stage, place, turn), lacking(stage, turn)
        x, y, heading = stage.robot.base()
        seen = turned(middle, (x, y), -turn)  # where the thing would be before a base that did not turn
        turning = abs(turn) / stage.robot.build.turn_step
        for ahead in standings(stage, middle) if turn == 0.0 else [0.0]:
            moved = ahead * np.array([np.cos(heading), np.sin(heading), 0.0])
            for aim in aims(stage, seen, index):
                if best is not None and best.route.hits == 0 and best.frames <= turning + LEAST:
                    return best
                for posture in postures(stage, aim - moved):
                    number += 1
                    if number in tried or posture.error > GETS_THERE:
                        continue
                    above = lifted(stage.robot, posture.arm, HOVER) if middle[2] > OVER else None
                    route = quickest(stage, [Leg(posture.arm, ahead)], surface, back, above, hit_cost=hit_cost)
                    if best is None or turning + route.cost < best.cost:
                        best = Way(number, turn, route, middle, turning + route.frames, turning + route.cost)
    return None if best is None or best.route.hits > FEW_HITS else best


def standings(stage: Stage, thing: NDArray[np.float64]) -> list[float]:
    """The distances [m] by which the base may drive on to reach for `thing`, [3] [m]: 0, and more if there is room."""
    x, y, _ = stage.robot.base()
    far = float(np.hypot(thing[0] - x, thing[1] - y))
    nearer = far - STAND_OFF * stage.robot.build.span(float(thing[2]))[1]
    ahead = min(nearer, stage.room_ahead(LOW, far) - stage.robot.build.radius)
    return [0.0, ahead] if ahead > 0.0 else [0.0]


def reaching(stage: Stage, index: int) -> list[Posture]:
    """The postures that bring the hand to the thing `index` from where the base stands, were nothing in its way."""
    found = (p for aim in aims(stage, stage.position(index), index) for p in postures(stage, aim))
    return [posture for posture in found if posture.error < GETS_THERE]


def free_postures(stage: Stage, index: int) -> list[Posture]:
    """The postures of `reaching` in which no part of the arm lies in anything on the map."""
    surface = Surface(stage, place_of(stage, index))
    return [p for p in reaching(stage, index) if surface.hits([Leg(p.arm, 0.0), Leg(p.arm, 0.0)]) == 0]


def _shut(stage: Stage, index: int, arm: NDArray[np.float64]) -> Skill:
    """Shut the hand at `arm` [rad], [J], which takes the nearest target: the thing `index` by now."""
    used = 0
    while used < SHUT_FRAMES and stage.held != index:
        yield stage.act(arm=arm, shut=True)
        used += 1
    return Result(stage.held == index, frames=used)
