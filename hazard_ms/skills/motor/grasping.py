"""The skill `pick_up`: the arm goes to the thing; within a hand's breadth the hand shuts and holds it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.episode.grasp import GRASP_REACH
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.arm import (
    HOVER,
    NEARLY,
    OVER,
    REACH_FRAMES,
    THERE,
    go,
    posture_for,
    ready,
    retract,
    unfold,
)
from hazard_ms.skills.motor.kinematics import Posture
from hazard_ms.skills.motor.motion import drive, turn_to
from hazard_ms.skills.motor.walking import known, way_to

LIMIT = 2.5  # greatest distance from the shoulder to the thing at which a pick-up begins (docs/benchmark.md 3) [m]
GRASP = 0.8 * GRASP_REACH  # the hand shuts this close to the thing [m]
CLEAR = 0.05  # the hand aims this far off the thing, so that it does not push it away [m]
APPROACH_FRAMES = 120  # budget for coming near enough [frames]
ATTEMPTS = 2  # number of attempts, the second from nearer than the first
PICK_FRAMES = 100  # frames after which no further attempt is begun
LEG_ROOM = 0.4  # lower furniture does not hinder the unfolding arm [m]
POSTURES = 2  # number of postures that are tried from one place
STAND_OFF = 0.85  # share of the arm's span at which the base stands for a pick-up
SHUT_FRAMES = 4  # frames that the hand needs to shut or to open


def pick_up(stage: Stage, index: int, frames: int = PICK_FRAMES) -> Skill:
    """Take the thing `index` into the hand.

    Turn to it, come nearer if the arm is too short, reach, grasp, fold the arm back. No further attempt is begun after
    `frames`.
    """
    reason = _refusal(stage, index)
    if reason:
        return Result(False, reason)
    used = 0
    for attempt in range(ATTEMPTS):
        if attempt or not _within_span(stage, stage.position(index)):
            near = yield from come_near(stage, stage.position(index), attempt)
            used += near.frames
            if not near.ok and attempt:
                break
        stage.robot.use_hand(stage.position(index), attempt)
        turned = yield from turn_to(stage, stage.position(index)[:2])
        taken = yield from _take(stage, index)
        used += turned.frames + taken.frames
        if stage.held == index:
            return Result(True, frames=used)
        if used >= frames:
            break
    return Result(False, failures.UNREACHABLE, used)


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


def come_near(stage: Stage, thing: NDArray[np.float64], attempt: int) -> Skill:
    """Drive to where the arm is long enough for `thing`, [3] [m], world frame; nearer at every further attempt."""
    nearest, farthest = stage.robot.build.span(float(thing[2]))
    stand = max(nearest, farthest * STAND_OFF - 0.1 * attempt)
    path = way_to(stage, (float(thing[0]), float(thing[1])), stand)
    if path is None or not len(path.points):
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
    """Try the best postures from where the base stands; the arm is folded at the end, with or without the thing."""
    used, height = 0, float(stage.position(index)[2])
    over = None if height < OVER else height + HOVER
    if over is not None:
        used += (yield from unfold(stage, over, -lacking(stage))).frames
        used += (yield from close_in(stage, stage.position(index), over)).frames
    for aim in _reachable(stage, index)[:POSTURES]:
        used += (yield from _grasp(stage, index, aim)).frames
        if stage.held == index:
            break
    back = yield from retract(stage, over, 0.0 if over is None else -lacking(stage))
    return Result(stage.held == index, "" if stage.held == index else failures.UNREACHABLE, used + back.frames)


def _grasp(stage: Stage, index: int, aim: NDArray[np.float64]) -> Skill:
    """Hover above `aim` [m], come down, to its middle if another target is nearer, and shut the hand on it."""
    used = 0
    for goal, close in ((aim + np.array([0.0, 0.0, HOVER]), NEARLY), (aim, THERE), (stage.position(index), THERE)):
        posture = posture_for(stage, goal)
        moved = yield from go(
            stage, posture.arm, REACH_FRAMES, lambda: stage.gap(index) < GRASP and stage.would_take() == index, close
        )
        used += moved.frames
        if close == THERE and stage.would_take() == index:
            used += (yield from _shut(stage, index, posture)).frames
            break
    return Result(stage.held == index, frames=used)


def lacking(stage: Stage) -> float:
    """Distance [m] by which the base must draw back so that the arm can fold or unfold before furniture."""
    room = stage.robot.build.elbow_room
    return room - stage.room_ahead(LEG_ROOM, room)


def close_in(stage: Stage, thing: NDArray[np.float64], over: float) -> Skill:
    """Drive straight on, the hand held out at height `over` [m], where the arm is too short for `thing`, [3] [m]."""
    x, y, _ = stage.robot.base()
    farthest = stage.robot.build.span(float(thing[2]))[1]
    missing = float(np.hypot(thing[0] - x, thing[1] - y)) - STAND_OFF * farthest
    if missing <= 0.0:
        return Result(True)
    return (yield from go(stage, ready(stage, over), REACH_FRAMES, close=NEARLY, forward=missing))


def _reachable(stage: Stage, index: int) -> list[NDArray[np.float64]]:
    """The aims that the hand gets near enough to, best first."""
    errors = [(posture_for(stage, aim).error, number, aim) for number, aim in enumerate(aims(stage, index))]
    return [aim for error, number, aim in sorted(errors, key=lambda e: (round(e[0], 2), e[1])) if error < GRASP_REACH]


def _shut(stage: Stage, index: int, posture: Posture) -> Skill:
    """Shut the hand, which takes the nearest target: the thing `index` by now."""
    used = 0
    while used < SHUT_FRAMES and stage.held != index:
        yield stage.act(arm=posture.arm, shut=True)
        used += 1
    return Result(stage.held == index, frames=used)
