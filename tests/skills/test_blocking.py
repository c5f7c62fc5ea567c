"""A flood board in a door keeps the water out up to its own height, in the whole simulation."""

from __future__ import annotations

from typing import Any

import pytest

from hazard_ms.skills import failures
from hazard_ms.skills.actions import skill
from hazard_ms.skills.decision import Action
from hazard_ms.skills.mitigations.blocking import gaps
from hazard_ms.skills.mitigations.offers import offered
from hazard_ms.spec import AgentStart, Body, Opening
from tests.worlds.two_rooms import TwoRooms, acted, spec, two_rooms

DOOR = Opening("door", "east", 2.0, 0.9, 2.05)
BLOCK = Action("block", "door_0")


def board(height: float = 0.6, mass: float = 5.0) -> Body:
    return Body("flood_board_0", "box", "plain_box", (5.6, 2.2, 0.0), scale=(0.95, 0.04, height), mass=mass)


def scene(**more: Any) -> Any:
    return spec(door=None, openings=(DOOR,), start=AgentStart((4.6, 2.2), 0.0), bodies=(board(**more),))


def dry(rooms: TwoRooms) -> None:
    """The water waits until the board is in the hand."""
    rooms.base.episode.states["flood"].depth[:] = 0.0


def volume(rooms: TwoRooms) -> float:
    return float(rooms.base.episode.states["flood"].depth.sum()) * 0.01


def came_in(height: float, blocked: bool) -> tuple[float, str]:
    """Water [m^3] that comes in within 10 s of when the board stands, or would; and how the skill ended."""
    with two_rooms(scene(height=height), ("flood",), "realistic", verbs=("block",)) as rooms:
        reason = ""
        if blocked:
            rooms.world.openings.set_open(rooms.world.openings.state.open.new_zeros(1).long(), 0, 0.0)
            assert offered(rooms.stage, ("block",)) == (Action("pick_up", "flood_board_0"),)
            assert acted(rooms, Action("pick_up", "flood_board_0")).ok
            dry(rooms)
            assert gaps(rooms.stage) == ("door_0",)
            reason = acted(rooms, BLOCK).reason
        dry(rooms)
        rooms.world.openings.set_open(rooms.world.openings.state.open.new_zeros(1).long(), 0, 1.0)
        for _ in range(300):
            rooms.base.advance(rooms.stage.act())
        if blocked and not reason:
            place = rooms.world.position[0, rooms.index("flood_board_0")].tolist()
            assert place == pytest.approx([7.0 + 0.03 - 0.06, 2.0, height / 2], abs=0.01)
            saved = rooms.base.get_state_dict()
            rooms.base.set_state_dict(saved)
            assert rooms.world.equipment.placed[0].tolist() == [False, True]
        return volume(rooms), reason


def test_a_board_holds_what_is_lower_than_it_and_deeper_water_passes() -> None:
    """0.5 m outside: a weir of 0.56 m^3/s for 10 s; 0.611 x 0.9 m x 0.2 mm x sqrt(2 g 0.5 m) under the board."""
    free, _ = came_in(0.6, False)
    held, reason = came_in(0.6, True)
    low, _ = came_in(0.4, True)
    assert reason == "" and free > 3.0
    assert held == pytest.approx(10.0 * 0.611 * 0.9 * 0.0002 * (2 * 9.81 * 0.5) ** 0.5, rel=0.2)
    assert low == pytest.approx(free, rel=0.05)


def test_a_board_is_not_let_down_into_deep_water_and_must_be_long_enough() -> None:
    with two_rooms(scene(), ("flood",), "realistic", verbs=("block",)) as rooms:
        assert rooms.run(skill(rooms.stage, BLOCK)).reason == failures.NO_BOARD
        assert acted(rooms, Action("pick_up", "flood_board_0")).ok
        for _ in range(150):  # 0.2 m presses with 177 N, and Fetch with 59 N
            rooms.base.advance(rooms.stage.act())
        assert acted(rooms, BLOCK).reason == failures.TOO_DEEP
        rooms.world.extent[0, rooms.index("flood_board_0"), 0] = 0.5
        assert gaps(rooms.stage) == ()
    with two_rooms(scene(), ("flood",), "paper", verbs=("block",)) as rooms:
        assert acted(rooms, Action("pick_up", "flood_board_0")).ok
        assert gaps(rooms.stage) == ()


def test_in_homes_of_paper_a_board_stands_in_the_outer_door_and_holds_the_water_as_it_is() -> None:
    """Inner doors have no rails there, and water presses on nothing: 0.2 m would press with 177 N, Fetch with 59 N."""
    inner = Opening("door", "middle", 2.0, 0.9, 2.05, open=1.0)
    made = spec(door=inner, openings=(DOOR,), start=AgentStart((4.6, 2.2), 0.0), bodies=(board(height=0.6),))
    with two_rooms(made, ("flood",), "paper", verbs=("block",), through_doors=True) as rooms:
        assert offered(rooms.stage, ("block",)) == (Action("pick_up", "flood_board_0"),)
        assert acted(rooms, Action("pick_up", "flood_board_0")).ok
        for _ in range(max(0, 200 - rooms.stage.frame)):
            rooms.base.advance(rooms.stage.act())
        assert gaps(rooms.stage) == ("door_1",)
        assert acted(rooms, Action("block", "door_0")).reason == failures.NO_RAILS
        assert acted(rooms, Action("block", "door_1")).ok
        image = rooms.base.task.hazards[0].image
        place, state = rooms.world.position.new_tensor([[[7.0, 2.0, 0.0]]]), rooms.base.episode.states["flood"]
        before = float(image(state, rooms.world, place))
        for _ in range(100):
            rooms.base.advance(rooms.stage.act())
        assert before > 0.2 and float(image(state, rooms.world, place)) == pytest.approx(before, abs=1e-3)
        assert float(state.level) > before + 0.09
