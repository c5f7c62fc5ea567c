"""Problems that scenes pose to planners: ways round walls in rooms, meetings with what moves in the open."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.sketch.rescue_problem import Outset, RescueScene
from hazard_ms.spec import Opening, Partition, SceneSpec
from tests.worlds.halls import future, hall

HERE = Outset((1.0, 3.0), 0.0, 0)
SPEED = 0.002  # of what floats [m/frame]: 0.6 m in the 300 frames of a timeline


def met(spec: SceneSpec, speed: float) -> float:
    """Frames until the first box can be met."""
    scene = RescueScene(spec, "fetch", HazardFetch.build.radius, 300)
    problem = scene.problem(future(spec, speed), np.array([0]), np.ones(1), np.zeros(0, np.int64), HERE)
    ((frame, _),) = problem.travel.meetings(problem.travel.start, 0.0, [0])
    return frame


def test_the_next_walk_begins_where_the_one_before_it_ended() -> None:
    """Boxes 4 m, 8 m and 1 m ahead: the robot stands 0.6 m before the first one and faces it.

    To the second one it goes 4 m, past the first, and to the third one it turns round, 30 frames, and goes 1.8 m.
    """
    spec = hall(4.0, 8.0, 1.0)
    scene = RescueScene(spec, "fetch", HazardFetch.build.radius, 1500)
    problem = scene.problem(future(spec), np.arange(3), np.ones(3), np.zeros(0, np.int64), HERE)
    ahead, behind = (frame for frame, _ in problem.travel.meetings((0, 0), 0.0, [1, 2]))
    assert ahead == pytest.approx(62 * 4.0 + 3, abs=13)
    assert behind == pytest.approx(30 + 62 * 1.8 + 3, abs=13)


@pytest.mark.parametrize("speed", [0.0, SPEED])
def test_what_floats_in_a_room_is_reached_round_walls(speed: float) -> None:
    """The box is 3 m from the start behind a wall whose doorway begins 1.9 m to the side: at least 4.8 m of way."""
    spec = hall(3.0)
    doorway = Opening("doorway", "wall", 5.35, 0.9, 2.0)
    room = dataclasses.replace(spec.room, partitions=(Partition("wall", "y", 2.5),), openings=(doorway,))
    walled = dataclasses.replace(spec, room=room)
    aside = 2 * np.hypot(1.5, 5.35 - 0.45 - 3.0)  # through the near end of the doorway [m]
    assert met(spec, 0.0) == pytest.approx(62 * 2.5, abs=20)
    assert 62 * (aside - 0.5) < met(walled, speed) < 62 * (aside + 1.5)


def test_what_is_blown_about_in_the_open_is_met_where_it_will_be() -> None:
    """A robot drives 1 / 62 m in a frame; ways in the open are a tenth longer than straight lines."""
    spec = hall(2.0)
    street = dataclasses.replace(spec, room=dataclasses.replace(spec.room, open_air=True))
    away, back = met(street, SPEED), met(street, -SPEED)
    assert back < 2.0 * 1.1 * 62 < away
    for frame, speed in ((away, SPEED), (back, -SPEED)):
        assert frame == pytest.approx((2.0 + speed * frame) * 1.1 * 62, abs=12)  # a record holds every tenth frame
