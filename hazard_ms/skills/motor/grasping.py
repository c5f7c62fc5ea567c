"""The skill `pick_up`: the arm goes to the thing; within a hand's breadth the hand shuts and holds it."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills import failures
from hazard_ms.skills.context import LowLevel, Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.arm import before, fold, follow, go, posture_for
from hazard_ms.skills.motor.drift import DRIFT_FRAMES, Drift
from hazard_ms.skills.motor.motion import drive, turn_by, turn_to
from hazard_ms.skills.motor.navigation import Path
from hazard_ms.skills.motor.reaching import GRASP, STAND_OFF, Way, aims, arm_way_where_it_will_be
from hazard_ms.skills.motor.routes import CLOSELY
from hazard_ms.skills.motor.standing import better_place
from hazard_ms.skills.motor.surface import NEARLY, Surface, place_of
from hazard_ms.skills.motor.walking import behind_wall, known, way_to
from hazard_ms.tasks.episode.grasp import GRASP_REACH

LIMIT = 2.5  # greatest distance from the shoulder to the thing at which a pick-up begins (docs/benchmark.md 3) [m]
APPROACH_FRAMES = 120  # budget for coming near enough [frames]
SHUT_FRAMES = 4  # frames that the hand needs to shut or to open
ASTRAY = 0.4  # the hand is led to a thing that moved if it is this close [m] [ours]
NEAR = 0.35  # and if it is this close where the arm was stopped [m] [ours]
ONCE_MORE = 75  # frames after which it is not led to a thing again where the arm was stopped [ours]
FREE = 0.2  # height by which the hand is raised from what it touched [m] [ours]
AGAIN_FRAMES = 20  # budget of each movement by which the hand is led to a thing anew [frames] [ours]
CLEAN = 2  # checked points of a way that may lie in something: up to here no better place is looked for [ours]
PASSABLE = 5  # such points that are put up with at another place [ours]
HOPELESS = 10  # such points from which on it fails more often than not, so it is not tried [ours]
RISK = 12.0  # frames that each such point of a way that is not clean costs beyond what it takes [ours]
NO_WAY = 250.0  # cost of a pick-up to which there is no way: as that of one that fails, and of the next [frames] [ours]
TRIES = 2  # number of postures that are tried
GIVE_UP = 90  # frames after which no other posture is tried from the same place [ours]
ELSEWHERE = 60  # frames, those to a first better place included, after which nothing is tried from another one [ours]
APART = 0.15  # distance of that place from the first [m] [ours]
SLOWER = 0.7  # share of the base's speed up to which it drives after a thing that moves out of reach [-] [ours]
CHASES = 5  # number of times that the arm is led to where a moving thing will be [ours]
GIVE_UP_CHASE = 45  # frames after which neither that nor another way is tried [ours]
MISSED = 0.2  # distance between where a thing will be and where the hand goes at which the hand is led anew [m] [ours]


def pick_up(stage: Stage, index: int) -> Skill:
    """Take what lies where the map has the thing `index`: turn to it, come nearer, reach, grasp, fold the arm back."""
    thing = stage.labeller.reach_for(index)
    reason = _refusal(stage, index, thing)
    if reason == failures.UNREACHABLE:  # nothing lies there: it only turns to the place
        x, y, _ = stage.seen.objects[index].position.tolist()
        return Result(False, reason, (yield from turn_to(stage, (x, y))).frames)
    if reason:
        return Result(False, reason)
    place, drift = stage.position(thing), Drift(stage, thing)
    used = 0
    if not _within_span(stage, place):
        used = (yield from drift.while_there(come_near(stage, place), ASTRAY)).frames
    faced = (yield from turn_to(stage, stage.position(thing)[:2])).frames
    used += faced
    if faced:
        drift.note(faced)
    taken = yield from _take(stage, thing, drift)
    return Result(taken.ok, taken.reason, used + taken.frames)


def _refusal(stage: Stage, index: int, thing: int) -> str:
    """The reason why a pick-up of `index`, which is `thing` along B, cannot begin; empty if it can."""
    told = next((target for target in stage.labeller.targets() if target.index == index), None)
    tool = told is None and thing >= 0 and bool(stage.world.takeable[0, thing])
    if stage.held >= 0:
        return failures.ALREADY_HOLDING
    if told is None and not tool:
        return failures.NOT_A_TARGET
    if told is not None and told.rescued:
        return failures.ALREADY_RESCUED
    if tool and float(stage.world.mass[0, thing]) > stage.robot.build.payload:
        return failures.TOO_HEAVY
    if not known(stage, index):
        return failures.UNKNOWN
    place = stage.position(thing) if thing >= 0 else stage.seen.objects[index].position
    if not may_begin(stage, place):
        return failures.TOO_FAR
    if thing < 0:  # what really lies there is found out within reach alone
        return failures.UNREACHABLE
    if not bool(stage.world.takeable[0, thing]):
        return failures.NOT_A_TARGET
    return failures.ALREADY_RESCUED if bool(stage.world.safe[0, thing]) else ""


def may_begin(stage: Stage, place: NDArray[np.floating]) -> bool:
    """Whether `place` [m], [3], world frame, is near enough for a pick-up to begin."""
    return float(np.linalg.norm(place - stage.robot.shoulder())) <= LIMIT


def _within_span(stage: Stage, thing: NDArray[np.float64]) -> bool:
    x, y, _ = stage.robot.base()
    nearest, farthest = stage.robot.build.span(float(thing[2]))
    return nearest <= float(np.hypot(thing[0] - x, thing[1] - y)) <= farthest and not behind_wall(stage, thing)


def come_near(stage: Stage, thing: NDArray[np.float64]) -> Skill:
    """Drive to where the arm is long enough for `thing`, [3] [m], world frame.

    It does not drive at all if the arm stays too short, or if the way is too long.
    """
    nearest, farthest = stage.robot.build.span(float(thing[2]))
    path = way_to(stage, (float(thing[0]), float(thing[1])), max(nearest, farthest * STAND_OFF))
    if path is None or not len(path.points) or path.short > farthest + GRASP_REACH:
        return Result(False, failures.NO_PATH)
    if path.length > APPROACH_FRAMES * stage.robot.build.forward_step:
        return Result(False, failures.NO_PATH)
    return (yield from drive(stage, path.points, APPROACH_FRAMES))


def _catch_up(stage: Stage, index: int, drift: Drift) -> Generator[LowLevel, None, int]:
    """Drive after a thing that moves away more slowly than the base drives, and face it; the frames."""
    step, place = stage.robot.build.forward_step, stage.position(index)
    speed = float(np.linalg.norm(drift.ahead(1.0)))
    if not 0.0 < speed < SLOWER * step:
        return 0
    left = float(np.hypot(*(place[:2] - stage.robot.base()[:2]))) - STAND_OFF * stage.robot.build.span(place[2])[1]
    used = (yield from come_near(stage, place + drift.ahead(max(left, 0.0) / (step - speed)))).frames
    used += (yield from turn_to(stage, stage.position(index))).frames
    if used:
        drift.note(used)
    return used


def _take(stage: Stage, index: int, drift: Drift) -> Skill:
    """Reach for the thing from where the base stands; the arm is folded at the end, with or without the thing."""
    place = place_of(stage, index)
    used, chases, tried = 0, 0, set[int]()
    stage.robot.use_hand(stage.position(index))
    way, moved = yield from _first_way(stage, index, drift)
    while way is not None:
        used += (yield from turn_by(stage, way.turn)).frames if way.turn else 0
        used += (yield from _grasp(stage, index, way, drift)).frames
        if stage.held == index:
            break
        if chases < CHASES and float(np.linalg.norm(drift.ahead(1.0))) > 0.0:
            chases += 1
        else:
            tried.add(way.number)
            stage.robot.use_hand(stage.position(index), len(tried))
        if len(tried) == TRIES or used > (GIVE_UP if chases == 0 else GIVE_UP_CHASE):
            break
        if tried:  # away from what the arm touched
            freed = before(stage, stage.robot.arm(), Surface(stage, place_of(stage, index)), FREE)
            used += (yield from go(stage, freed, AGAIN_FRAMES, close=CLOSELY)).frames
        way = arm_way_where_it_will_be(stage, index, tried, drift)
        if way is None and chases < CHASES and drift.ahead(1.0).any():
            chases, used = chases + 1, used + (yield from _catch_up(stage, index, drift))
            way = arm_way_where_it_will_be(stage, index, tried, drift)
    again = stage.held != index and used > 0 and used + moved <= ELSEWHERE and not chases
    if used:
        used += (yield from fold(stage, place)).frames
    if again:
        used += yield from _from_elsewhere(stage, index, drift)
    return Result(stage.held == index, "" if stage.held == index else failures.UNREACHABLE, used + moved)


def _from_elsewhere(stage: Stage, index: int, drift: Drift) -> Generator[LowLevel, None, int]:
    """Try once more from another place, where something was in the way that the map did not show; the frames."""
    stage.look()
    path = better_place(stage, index, NO_WAY, PASSABLE, APART)
    if path is None:
        return 0
    place, used = place_of(stage, index), (yield from _go_to(stage, index, path))
    way = arm_way_where_it_will_be(stage, index, set(), drift)
    if way is None or way.route.hits > PASSABLE:
        return used
    used += (yield from turn_by(stage, way.turn)).frames if way.turn else 0
    used += (yield from _grasp(stage, index, way, drift)).frames
    return used + (yield from fold(stage, place)).frames


def _go_to(stage: Stage, index: int, path: Path) -> Generator[LowLevel, None, int]:
    """Go along the `path` to a better place, face the thing and look; the frames."""
    moved = (yield from drive(stage, path.points, APPROACH_FRAMES)).frames
    moved += (yield from turn_to(stage, stage.position(index))).frames
    stage.look()
    stage.robot.use_hand(stage.position(index))
    return moved


def _first_way(stage: Stage, index: int, drift: Drift) -> Generator[LowLevel, None, tuple[Way | None, int]]:
    """The arm's way to the thing, None if it would hardly get there, and the frames that went into standing well.

    Where the way is not clean, the base first goes to a better place, if there is one.
    """
    way, moved = arm_way_where_it_will_be(stage, index, set(), drift), 0
    if way is None and drift.ahead(1.0).any():
        moved = yield from _catch_up(stage, index, drift)
        way = arm_way_where_it_will_be(stage, index, set(), drift)
    if drift.ahead(1.0).any() or (way is not None and way.route.hits <= CLEAN):
        return way, moved
    path = better_place(stage, index, NO_WAY if way is None else way.cost + RISK * way.route.hits, PASSABLE)
    if path is not None:
        moved = yield from _go_to(stage, index, path)
        way = arm_way_where_it_will_be(stage, index, set(), drift)
    return (None if way is None or way.route.hits > HOPELESS else way), moved


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
        surface = Surface(stage, place_of(stage, index))
        goal = stage.position(index) if moved.ok else aims(stage, stage.position(index), index, surface.outward)[0]
        arm = posture_for(stage, goal, surface.inward).arm
        if not moved.ok:  # it touched something, or the thing moved: up, or out, and once more from there
            raised = before(stage, stage.robot.arm(), surface, FREE)
            used += (yield from go(stage, raised, AGAIN_FRAMES, close, CLOSELY)).frames
            used += (yield from go(stage, before(stage, arm, surface), AGAIN_FRAMES, close, NEARLY)).frames
        used += (yield from go(stage, arm, AGAIN_FRAMES, close)).frames
    if stage.would_take() == index:
        used += (yield from _shut(stage, index, arm)).frames
    return Result(stage.held == index, frames=used)


def _shut(stage: Stage, index: int, arm: NDArray[np.float64]) -> Skill:
    """Shut the hand at `arm` [rad], [J], which takes the nearest target: the thing `index` by now."""
    used = 0
    while used < SHUT_FRAMES and stage.held != index:
        yield stage.act(arm=arm, shut=True)
        used += 1
    return Result(stage.held == index, frames=used)
