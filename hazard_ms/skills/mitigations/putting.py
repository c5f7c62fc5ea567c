"""Puts down a tool that the hand holds: on the floor before the robot."""

from __future__ import annotations

import numpy as np

from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.arm import REACH_FRAMES, fold, follow, posture_for
from hazard_ms.skills.motor.grasping import SHUT_FRAMES
from hazard_ms.skills.motor.routes import quickest
from hazard_ms.skills.motor.surface import Leg, Place, Surface

BEFORE = 0.35  # of the place on the floor from the rim of the base [m] [ours]
LET_FALL = 0.05  # height above the floor at which the hand opens [m] [ours]


def put_down(stage: Stage) -> Skill:
    """Put what the hand holds on the floor before the base, or let it fall there if the arm is too short."""
    held = stage.held
    if held < 0:
        return Result(False, failures.NOT_HOLDING)
    x, y, heading = stage.robot.base()
    ahead = stage.robot.build.radius + BEFORE
    half = float(stage.world.extent[0, held].max()) / 2
    goal = np.array([x + ahead * np.cos(heading), y + ahead * np.sin(heading), half + LET_FALL])
    place = Place(goal, half, 0.0, 2.0 * half)
    route = quickest(stage, [Leg(posture_for(stage, goal).arm, 0.0)], Surface(stage, place), 0.0)
    used = (yield from follow(stage, route)).frames
    arm, opened = stage.robot.arm(), 0
    while opened < REACH_FRAMES and (opened < SHUT_FRAMES or stage.held >= 0):
        yield stage.act(arm=arm, shut=False)
        opened += 1
    used += opened + (yield from fold(stage, place)).frames
    return Result(stage.held < 0, "" if stage.held < 0 else failures.UNREACHABLE, used)
