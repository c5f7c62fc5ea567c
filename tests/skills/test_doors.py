"""Robots open and shut doors: at the handle, in the time of doors, and not against more than they can pull."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import torch

from hazard_ms.registry import ROBOTS
from hazard_ms.simulation import hinges
from hazard_ms.skills import failures
from hazard_ms.skills.actions import skill
from hazard_ms.skills.decision import Action
from hazard_ms.skills.mitigations.doors import handle_force, open_ones, shut_ones
from hazard_ms.skills.motor.grasping import GRASP_REACH
from hazard_ms.spec import Body, Fixture, Opening
from tests.worlds.two_rooms import DOOR, FAR, HALL, HINGE, ONE, SIZE, TwoRooms, spec, two_rooms

OPEN, SHUT = Action("open", "door_0"), Action("shut", "door_0")
AJAR = dataclasses.replace(DOOR, open=1.0)
OPENING, SHUTTING = 120, 135  # frames of 4 s and 4.5 s [ANSI/BHMA A156.19]


def turning(rooms: TwoRooms, action: Action) -> tuple[object, list[float], float]:
    """The result of an action, the shares by which the door was open in each frame, and how near the hand came."""
    shares, nearest, advance = [], [math.inf], rooms.base.advance

    def advanced(low_level: object) -> object:
        made = advance(low_level)
        shares.append(rooms.share())
        if len(shares) < 2 or shares[-1] == shares[0]:  # the leaf has not moved yet
            handle = hinges.handle(rooms.base.specs[0].room, rooms.base.specs[0].room.openings[0], hinges.angle(shares[-1]))
            nearest.append(float(np.linalg.norm(rooms.stage.robot.hand() - handle)))
        return made

    rooms.base.advance = advanced
    try:
        for _ in range(6):  # walks of at most 100 frames
            result = rooms.run(skill(rooms.stage, action))
            if result.reason != failures.MAX_FRAMES:
                break
    finally:
        del rooms.base.advance
    return result, shares, min(nearest)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("start", [HALL, FAR])
def test_a_door_opens_and_shuts_from_either_side(robot: str, start: object) -> None:
    """The hand gets to the handle first; the leaf takes a quarter turn in 4 s, and back in 4.5 s."""
    with two_rooms(spec(start=start), robot=robot) as rooms:  # type: ignore[arg-type]
        stage, side = rooms.stage, np.sign(rooms.stage.robot.base()[0] - HINGE[0])
        assert (shut_ones(stage), open_ones(stage)) == (("door_0",), ())
        result, shares, nearest = turning(rooms, OPEN)
        assert (result.ok, result.reason) == (True, "")  # type: ignore[attr-defined]
        assert rooms.share() == 1.0 and nearest < GRASP_REACH
        moving = [k for k, share in enumerate(shares) if 0.0 < share < 1.0]
        assert len(moving) + 1 == OPENING == moving[-1] - moving[0] + 2
        angles = np.arccos(1.0 - np.array(shares)[moving])
        assert np.diff(angles) == pytest.approx(np.full(OPENING - 2, math.pi / 2 / OPENING), abs=2e-3)
        assert (shut_ones(stage), open_ones(stage)) == ((), ("door_0",))
        assert np.sign(stage.robot.base()[0] - HINGE[0]) == side
        result, shares, nearest = turning(rooms, SHUT)
        assert (result.ok, result.reason) == (True, "")  # type: ignore[attr-defined]
        assert rooms.share() == 0.0 and nearest < GRASP_REACH
        assert sum(0.0 < share < 1.0 for share in shares) + 1 == SHUTTING
