"""The six actions of the benchmark, and mitigations, as generators of low-level actions, by verb."""

from __future__ import annotations

from typing import cast

import numpy as np

from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_ONE_STEP, WALK_TO, Action, Result
from hazard_ms.skills.mitigations.approach import walk_into
from hazard_ms.skills.mitigations.putting import put_down
from hazard_ms.skills.motor.grasping import pick_up
from hazard_ms.skills.motor.motion import turn_by, wrap
from hazard_ms.skills.motor.stowing import drop
from hazard_ms.skills.motor.walking import WALK_FRAMES, walk_to
from hazard_ms.spec.registry import load
from hazard_ms.spec.registry.mitigations import MITIGATIONS

LOOKS = 12  # number of looks when looking around (docs/benchmark.md 3)


def explore(stage: Stage) -> Skill:
    """Turn once around in twelve turns of 30 degrees, with a look after each."""
    used = 0
    start = stage.robot.base()[2]
    for look in range(1, LOOKS + 1):
        left = start + look * 2.0 * np.pi / LOOKS - stage.robot.base()[2]
        used += (yield from turn_by(stage, wrap(left))).frames
        stage.look()
    return Result(True, frames=used)


def wait(stage: Stage, frames: int) -> Skill:
    """Stand still for a number of frames."""
    for _ in range(frames):
        yield stage.act()
    return Result(True, frames=frames)


def stop(stage: Stage) -> Skill:
    """Do nothing; the episode ends with it."""
    return Result(True)
    yield  # a generator, as every skill is


def skill(stage: Stage, action: Action) -> Skill:
    """The generator that does `action`. Raises ValueError if it names a thing that the scene does not have."""
    if action.verb in MITIGATIONS:
        return cast(Skill, load(MITIGATIONS[action.verb].skill)(stage, action.target))
    if action.verb == WALK_TO and (opening := stage.doors.find(str(action.target))) is not None:
        return walk_into(stage, opening)
    index = None if action.target is None else stage.labeller.index(action.target)
    if action.verb == EXPLORE:
        return explore(stage)
    if action.verb == STOP:
        return stop(stage)
    if action.verb == DROP:
        tools = stage.world.equipment
        if tools is not None and stage.held >= 0 and bool(tools.tool[0, stage.held]):
            return put_down(stage)
        if index is None and stage.on_ground:
            return put_down(stage)
        return drop(stage, index)
    assert index is not None  # Action sees to it
    if action.verb == PICK_UP:
        return pick_up(stage, index)
    assert action.verb in (WALK_TO, WALK_ONE_STEP)
    return walk_to(stage, index, WALK_FRAMES, whole=action.verb == WALK_TO)
