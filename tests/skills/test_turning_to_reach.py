"""A robot turns aside before it reaches where what it sees is in the way of its arm, in real physics."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.skills.motor import grasping, reaching
from hazard_ms.skills.motor.arm import posture_for
from hazard_ms.skills.motor.motion import turn_by, wrap
from hazard_ms.skills.motor.surface import Leg, Place, Surface, place_of
from tests.worlds.arena import Arena
from tests.worlds.skill_room import TABLE, walk

POSTS = ((0.21, 0.5), (-0.15, 0.64))  # how far to the left of where the robot faces [rad], and from it [m]
HIGH = 1.5  # [m]


def _post(arena: Arena, aside: float, far: float) -> None:
    """Let the robot believe that a post stands there: 0.2 m wide, as high as its head."""
    x, y, heading = arena.agent.base()
    seen = arena.stage.seen
    row, column = seen.cell_of((x + far * np.cos(heading + aside), y + far * np.sin(heading + aside)))
    height = np.zeros_like(seen.height)
    height[row - 1 : row + 1, column - 1 : column + 1] = HIGH
    seen.tell(height, np.zeros_like(seen.explored))


@pytest.mark.parametrize("turn", [-0.5, 0.4])
def test_what_is_in_the_way_of_a_turned_base_is_what_it_finds_when_it_has_turned(fresh: Arena, turn: float) -> None:
    assert walk(fresh, "mug")
    stage, index = fresh.stage, fresh.index("mug")
    place, arms = place_of(stage, index), (*fresh.agent.between, *fresh.agent.outstretched)
    now = Leg(fresh.agent.tucked, 0.0)
    foreseen = [Surface(stage, place, turn).hits([now, Leg(arm, 0.0)]) for arm in arms]
    assert fresh.run(turn_by(stage, turn)).ok
    assert foreseen == pytest.approx([Surface(stage, place).hits([now, Leg(arm, 0.0)]) for arm in arms], abs=2)
    assert max(foreseen) > 0


def test_an_arm_that_is_in_the_table_is_free_when_the_base_draws_back(fresh: Arena) -> None:
    assert walk(fresh, "mug")
    surface = Surface(fresh.stage, Place(np.zeros(3), 0.0, 0.0, 0.0))
    below = posture_for(fresh.stage, np.array([1.2, 0.0, TABLE - 0.2])).arm
    here, back = ([Leg(below, ahead), Leg(below, ahead)] for ahead in (0.0, -1.0))
    assert surface.hits(here) > 0 == surface.hits(back)


def test_the_base_turns_where_its_arm_would_meet_less(fresh: Arena, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grasping, "better_place", lambda *_: None)
    turned = []
    for post in POSTS:
        fresh.restart()
        assert walk(fresh, "mug")
        stage, index = fresh.stage, fresh.index("mug")
        _post(fresh, *post)
        fresh.agent.use_hand(stage.position(index))
        with monkeypatch.context() as patch:
            patch.setattr(reaching, "TURNS", (0.0,))
            straight = reaching.arm_way(stage, index, set(), stage.position(index))
        before = fresh.agent.base()[2]
        way = reaching.arm_way(stage, index, set(), stage.position(index))
        assert straight is not None and way is not None and straight.turn == 0.0
        assert way.cost <= straight.cost and way.cost == pytest.approx(way.frames + way.route.cost - way.route.frames)
        if way.turn:
            assert way.frames == pytest.approx(abs(way.turn) / fresh.agent.build.turn_step + way.route.frames)
            assert way.cost < straight.cost
            assert fresh.run(grasping.pick_up(stage, index)).ok
            turned.append(wrap(fresh.agent.base()[2] - before) * np.sign(way.turn))
    assert turned and min(turned) > 0.4  # the least turn that is tried is half a radian


def test_the_base_does_not_turn_aside_for_a_thing_that_moves(fresh: Arena) -> None:
    assert walk(fresh, "mug")
    stage, index = fresh.stage, fresh.index("mug")
    _post(fresh, *POSTS[0])
    fresh.agent.use_hand(stage.position(index))
    way = reaching.arm_way(stage, index, set(), stage.position(index), reaching.HURRY)
    assert way is not None and way.turn == 0.0
