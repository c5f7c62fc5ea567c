"""Skills of the base in real physics: turning, driving, looking around and walking, their costs and their failures.

Numbers are those of the benchmark's rules.
"""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.skills import failures
from hazard_ms.skills.actions import explore, stop
from hazard_ms.skills.motor.motion import drive, move_by, turn_by, turn_to
from hazard_ms.skills.motor.walking import walk_to
from tests.worlds.arena import Arena
from tests.worlds.skill_room import BOXES, horizontal, walk

# half the width of what meets furniture of a robot, at its narrowest (Fetch's URDF: 0.264; G1's feet: 0.15) [m]
HALF = {"fetch": 0.26, "g1": 0.19}


@pytest.mark.parametrize("angle", [0.0, 0.3, -2.0, np.pi, 7.0])
def test_turn_by_turns_by_that_angle(fresh: Arena, angle: float) -> None:
    result = fresh.run(turn_by(fresh.stage, angle))
    assert result.ok and np.cos(fresh.agent.base()[2] - angle) > np.cos(np.deg2rad(3.0))
    assert abs(angle) / np.deg2rad(6.0) - 1 <= result.frames <= abs(angle) / np.deg2rad(6.0) + 4


def test_turn_to_faces_the_point_the_short_way(fresh: Arena) -> None:
    assert fresh.run(turn_to(fresh.stage, (-1.0, -1.0))).frames <= 27
    assert fresh.agent.base()[2] == pytest.approx(-0.75 * np.pi, abs=np.deg2rad(3.0))


@pytest.mark.parametrize("distance", [0.5, -0.4, 0.0])
def test_move_by_moves_by_that_distance(fresh: Arena, distance: float) -> None:
    result = fresh.run(move_by(fresh.stage, distance))
    assert result.ok
    x, y, heading = fresh.agent.base()
    assert (x, y, heading) == pytest.approx((distance, 0.0, 0.0), abs=0.03)
    assert result.frames <= abs(distance) * 62 + 6


def test_move_by_tells_that_it_is_blocked(fresh: Arena) -> None:
    result = fresh.run(move_by(fresh.stage, 2.0))
    assert result.reason == failures.BLOCKED and result.frames < 100
    assert fresh.agent.base()[0] < 1.1 - HALF[fresh.robot]


def test_a_budget_is_never_exceeded(fresh: Arena) -> None:
    assert fresh.run(move_by(fresh.stage, 0.9, frames=10)) == type(fresh.run(stop(fresh.stage)))(
        False, failures.MAX_FRAMES, 10
    )
    assert fresh.run(turn_by(fresh.stage, 3.0, frames=5)).frames == 5
    assert fresh.run(walk_to(fresh.stage, fresh.index("far"), frames=30)).frames == 30


def test_drive_backs_off_and_remembers_what_it_ran_into(fresh: Arena) -> None:
    fresh.map._firm[:] = 0.0  # the table is not on the map
    result = fresh.run(drive(fresh.stage, np.array([[2.5, 0.0]]), 200))
    assert result.reason == failures.BLOCKED and result.frames < 130
    assert fresh.agent.base()[0] < 1.1 - HALF[fresh.robot] - 0.1  # it backs off by 0.15 m
    bump = fresh.stage.bumps[-1]
    assert 0.9 < bump[0] < 1.4 and abs(bump[1]) < 0.2
    assert fresh.stage.obstacles().max() == 1.0


def test_explore_looks_twelve_times_around(fresh: Arena) -> None:
    result = fresh.run(explore(fresh.stage))
    assert result.ok and 58 <= result.frames <= 75  # about 60 (docs/benchmark.md 1)
    assert fresh.looks == 12
    assert np.cos(fresh.agent.base()[2]) > np.cos(np.deg2rad(3.0))  # it faces where it faced


@pytest.mark.parametrize("name", ["bowl", "pen", "pack"])
def test_walk_to_arrives_half_a_metre_before_the_thing(fresh: Arena, name: str) -> None:
    assert walk(fresh, name)
    size = BOXES[[b.name for b in BOXES].index(name)].size
    assert horizontal(fresh, name) <= 0.5 + np.hypot(size[0], size[1]) / 2 + 0.05
    x, y, heading = fresh.agent.base()
    place = fresh.world.position[0, fresh.index(name)]
    assert np.cos(np.arctan2(float(place[1]) - y, float(place[0]) - x) - heading) > np.cos(np.deg2rad(5.0))


def test_walk_to_gives_up_after_100_frames(fresh: Arena) -> None:
    result = fresh.run(walk_to(fresh.stage, fresh.index("far")))
    assert (result.ok, result.reason, result.frames) == (False, failures.MAX_FRAMES, 100)
    x, y, _ = fresh.agent.base()
    assert 1.0 < np.hypot(x, y) <= 100 / 62 + 0.01


def test_walk_one_step_goes_only_to_the_first_midpoint(fresh: Arena) -> None:
    result = fresh.run(walk_to(fresh.stage, fresh.index("far"), whole=False))
    assert result.ok and result.frames < 100
    x, y, _ = fresh.agent.base()
    assert 0.7 < np.hypot(x, y) < 1.1


def test_walk_to_what_was_never_seen_fails_at_once(arena: Arena) -> None:
    arena.restart(known=False)
    result = arena.run(walk_to(arena.stage, arena.index("bowl")))
    assert (result.ok, result.reason, result.frames) == (False, failures.UNKNOWN, 0)


def test_walk_to_what_is_walled_in_finds_no_path(fresh: Arena) -> None:
    for _ in range(4):
        result = fresh.run(walk_to(fresh.stage, fresh.index("walled")))
        if result.reason != failures.MAX_FRAMES:
            break
    assert result.reason == failures.NO_PATH
