"""The arm's ways in real physics: past furniture that was seen, within the speeds of the joints, and back in time."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.skills import failures
from hazard_ms.skills.context import LowLevel, Skill
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.grasping import pick_up
from hazard_ms.skills.motor.routes import quickest
from hazard_ms.skills.motor.stowing import drop
from hazard_ms.skills.motor.surface import Leg, Place, Surface
from tests.worlds.arena import Arena
from tests.worlds.skill_room import TABLE, walk

FLAT = Place(np.zeros(3), 0.0, 0.0, 0.0)  # nothing that the hand may come down to
FAILED_FRAMES = 60  # most that a pick-up that fails may cost where the robot need not drive
PLAY = 1.5  # how much faster than commanded a joint may be while it catches up


class Recorder:
    """Runs a skill and keeps the arm's joints, its places and the base of every frame."""

    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        self.arms: list[np.ndarray] = [arena.agent.arm()]
        self.places: list[np.ndarray] = []
        self.bases: list[tuple[float, float, float]] = [arena.agent.base()]
        self._step = arena.step

    def run(self, doing: Skill) -> Result:
        def step(action: LowLevel) -> None:
            self._step(action)
            self.arms.append(self.arena.agent.arm())
            self.places.append(self.arena.agent.arm_places(self.arms[-1]))
            self.bases.append(self.arena.agent.base())

        self.arena.step = step  # type: ignore[method-assign]
        try:
            return self.arena.run(doing)
        finally:
            del self.arena.step


@pytest.mark.parametrize("name", ["mug", "deep"])
def test_the_arm_keeps_out_of_the_table_and_within_the_speed_of_its_joints(fresh: Arena, name: str) -> None:
    assert walk(fresh, name)
    recorder = Recorder(fresh)
    assert recorder.run(pick_up(fresh.stage, fresh.index(name))).ok
    places = np.concatenate(recorder.places)
    inside = (np.abs(places[:, 0] - 1.5) < 0.4) & (np.abs(places[:, 1]) < 0.6) & (places[:, 2] < TABLE)
    assert not inside.any()
    build = fresh.agent.build
    assert np.abs(np.diff(recorder.arms, axis=0)).max() < PLAY * build.arm_step
    assert np.hypot(*np.diff(recorder.bases, axis=0)[:, :2].T).max() < PLAY * build.forward_step


def test_a_straight_way_through_the_table_is_seen_and_avoided(arena: Arena) -> None:
    arena.restart(0.7, 0.0)
    below = Leg(_posture(arena, np.array([1.2, 0.0, TABLE - 0.2])), 0.0)  # the hand would be in the table
    now = Leg(arena.agent.arm(), 0.0)
    surface = Surface(arena.stage, FLAT)
    assert surface.hits([now, below]) > 0 and surface.hits([now, now]) == 0
    over = np.array([1.25, 0.0, TABLE + 0.2])
    above = Leg(_posture(arena, over), 0.0)
    route = quickest(arena.stage, [above], surface, 0.4)
    assert route.hits < surface.hits([now, above]) and route.legs[-1] is above
    arena.restart(0.7, 0.0, known=False)
    free = quickest(arena.stage, [above], Surface(arena.stage, FLAT), 0.0)
    assert len(free.legs) == 1 and free.frames <= route.frames  # where nothing was seen it goes straight


def _posture(arena: Arena, point: np.ndarray) -> np.ndarray:
    from hazard_ms.skills.motor.arm import REACHED_ERROR, posture_for

    found = posture_for(arena.stage, point)
    assert found.error < REACHED_ERROR
    return found.arm


def test_what_is_out_of_reach_is_given_up_before_the_arm_moves(arena: Arena) -> None:
    arena.restart(1.4, 2.5)
    recorder = Recorder(arena)
    result = recorder.run(pick_up(arena.stage, arena.index("walled")))
    assert result.reason == failures.UNREACHABLE and result.frames <= FAILED_FRAMES
    assert arena.stage.arm_gap(arena.agent.tucked) < 0.5


def test_a_thing_on_a_table_is_soon_in_the_bag(fresh: Arena) -> None:
    """The careful way there and back with the elbow always held high took more than 100 frames."""
    assert walk(fresh, "mug")
    picked = fresh.run(pick_up(fresh.stage, fresh.index("mug")))
    dropped = fresh.run(drop(fresh.stage))
    assert picked.ok and dropped.ok and picked.frames + dropped.frames <= 100
