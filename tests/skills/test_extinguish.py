"""Robots pick up extinguishers, aim at what burns until it is out, and say why they cannot, in the whole simulation."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms.hazards.fire.fire_state import BURNING
from hazard_ms.skills import failures
from hazard_ms.skills.decision import Action
from hazard_ms.skills.mitigations.extinguish import _covered, charge, hot_things
from hazard_ms.skills.mitigations.offers import offered, tools
from hazard_ms.spec import AgentStart, Body, Opening
from hazard_ms.spec.extinguishers import EXTINGUISHERS
from tests.worlds.two_rooms import DOOR, VERBS, TwoRooms, acted, spec, two_rooms

CLOCK = 4.5  # seconds of a realistic fire in a second [docs/physics.md 3.1]
START = AgentStart((1.0, 2.0), 0.0)
PUT_OUT = Action("extinguish", "box_0")
AT = (5.8, 1.0, 0.0)  # where the box stands, far from the robot


def bottle_of(name: str, mass: float) -> Body:
    return Body(name, "fire_extinguisher", "plain_box", (1.6, 1.6, 0.0), scale=(0.12, 0.12, 0.4), mass=mass)


def box(place: tuple[float, float, float] = AT, name: str = "box_0") -> Body:
    return Body(name, "box", "plain_box", place, scale=(0.4, 0.4, 0.4), mass=3.0)


def scene(kind: str = "powder_0", mass: float = 3.3, door: Opening | None = None, place: Any = AT) -> Any:
    return spec(door=door, start=START, bodies=(bottle_of(kind, mass), box(place)))


def armed(rooms: TwoRooms, name: str = "powder_0") -> None:
    """Take the extinguisher, and set the box on fire."""
    assert acted(rooms, Action("walk_to", name)).ok
    result = acted(rooms, Action("pick_up", name))
    assert result.ok, result
    ignite(rooms)


def ignite(rooms: TwoRooms, *others: str) -> None:
    state = rooms.base.episode.states["fire"]
    for name in ("box_0", *others):
        b = rooms.index(name)
        state.status[0, b], state.temperature[0, b] = BURNING, 600.0
        if hasattr(state, "burn_age"):  # a realistic fire grows: this one burns already
            state.burn_age[0, b] = 60.0
    rooms.base.advance(rooms.stage.act())
    rooms.look()


def burns(rooms: TwoRooms, name: str = "box_0") -> bool:
    return int(rooms.base.episode.states["fire"].status[0, rooms.index(name)]) == BURNING


@pytest.mark.parametrize("physics", ["paper", "realistic"])
def test_a_burning_thing_is_put_out_with_what_was_picked_up(physics: str) -> None:
    """From as far away as the jet carries; each second of discharge takes charge / seconds of the data sheet."""
    with two_rooms(scene(), physics=physics) as rooms:
        assert offered(rooms.stage, VERBS) == (Action("pick_up", "powder_0"),)
        armed(rooms)
        assert "box_0" in hot_things(rooms.stage) and PUT_OUT in offered(rooms.stage, VERBS)
        flowing, advance = [], rooms.base.advance

        def advanced(low_level: Any) -> Any:
            flowing.append(bool(rooms.world.jets[0].flowing[0]))
            if flowing[-1]:
                aim, b = rooms.world.jets[0].aim[0], rooms.index("box_0")
                way = rooms.world.position[0, b] - rooms.world.jets[0].place[0]
                assert float(way.norm()) <= EXTINGUISHERS["powder"].reach
                assert float(aim @ way / way.norm()) > math.cos(0.05)
            return advance(low_level)

        rooms.base.advance = advanced
        result = acted(rooms, PUT_OUT)
        del rooms.base.advance
        assert (result.ok, burns(rooms)) == (True, False)
        assert not bool(rooms.world.jets[0].flowing[0]) and 2 < sum(flowing)
        clock = CLOCK if physics == "realistic" else 1.0
        spent = sum(flowing) / 30.0 * clock * 2.0 / 12.0
        assert charge(rooms.stage) == pytest.approx(2.0 - spent, abs=1e-3)
        (row,) = tools(rooms.stage)
        assert (row.kind, row.held) == ("powder", True) and row.left == pytest.approx(charge(rooms.stage) / 2.0)


def test_an_empty_extinguisher_and_none_say_so_and_what_is_left_is_saved() -> None:
    with two_rooms(scene()) as rooms:
        ignite(rooms)
        assert acted(rooms, PUT_OUT).reason == failures.NO_EXTINGUISHER
        assert hot_things(rooms.stage) == ()
        armed(rooms)
        tool = rooms.index("powder_0")
        charges = rooms.world.equipment.state.charge
        charges[0, tool] = 0.5
        saved = rooms.base.get_state_dict()
        charges[0, tool] = 0.0
        assert acted(rooms, PUT_OUT).reason == failures.EMPTY and hot_things(rooms.stage) == ()
        rooms.base.set_state_dict(saved)
        assert charge(rooms.stage) == 0.5
        wrong = {**saved["hazard_ms"]["equipment"], "charge": saved["hazard_ms"]["equipment"]["charge"] - 1.0}
        with pytest.raises(ValueError, match=r"equipment\.charge must hold numbers from 0"):
            rooms.base.set_state_dict({**saved, "hazard_ms": {**saved["hazard_ms"], "equipment": wrong}})


def test_no_charge_puts_out_what_smoulders_on_and_the_jet_stops_when_it_is_spent() -> None:
    """Carbon dioxide smothers, and a solid burns on when it has gone: 9 s of a data sheet are 2 s of an episode."""
    with two_rooms(scene("co2_0", 5.0), physics="realistic") as rooms:
        armed(rooms, "co2_0")
        result = acted(rooms, PUT_OUT)
        assert (result.ok, result.reason) == (False, failures.EMPTY)
        assert burns(rooms) and charge(rooms.stage) == 0.0 and not bool(rooms.world.jets[0].flowing[0])


def test_a_wall_is_walked_around_and_a_shut_door_is_not() -> None:
    behind = (5.8, 3.4, 0.0)
    # before a shut door it looks for a way round through what it has not seen, until the box has burnt down
    shut = (failures.NO_LINE_OF_SIGHT, failures.NO_PATH, failures.MAX_FRAMES, failures.NOT_BURNING)
    for door, reason in ((DOOR, shut), (None, ("",))):
        with two_rooms(scene(door=door, place=behind)) as rooms:
            armed(rooms)
            assert acted(rooms, PUT_OUT).reason in reason


def test_all_that_burns_around_a_thing_is_put_out_and_nothing_behind_a_wall() -> None:
    """Two boxes 1.2 m apart, and a third as near to the first in the next room, behind a shut door."""
    boxes = (box((2.6, 0.8, 0.0)), box((2.6, 2.0, 0.0), "box_1"), box((4.0, 0.8, 0.0), "box_2"))
    with two_rooms(spec(start=START, bodies=(bottle_of("powder_0", 3.3), *boxes))) as rooms:
        armed(rooms)
        ignite(rooms, "box_1", "box_2")
        assert acted(rooms, PUT_OUT).ok
        assert [burns(rooms, f"box_{k}") for k in range(3)] == [False, False, True]


def test_where_nothing_burns_it_says_so_and_the_pin_is_pulled_once() -> None:
    """The pin takes two seconds, 60 frames; the jet of the second fight opens as soon as the robot has turned."""
    with two_rooms(scene()) as rooms:
        armed(rooms)
        flowing, advance = [], rooms.base.advance

        def advanced(low_level: Any) -> Any:
            flowing.append(bool(rooms.world.jets[0].flowing[0]))
            return advance(low_level)

        rooms.base.advance = advanced
        assert acted(rooms, PUT_OUT).ok and flowing.index(True) >= 60
        result = acted(rooms, PUT_OUT)
        assert (result.ok, result.reason, result.frames) == (False, failures.NOT_BURNING, 0)
        ignite(rooms)
        flowing.clear()
        assert acted(rooms, PUT_OUT).ok and flowing.index(True) < 30
        del rooms.base.advance


def test_what_is_too_heavy_for_the_arm_stays_and_tools_are_put_down_on_the_floor() -> None:
    """Fetch carries 6 kg: 6 litres of water weigh 10 kg with their bottle, 2 kg of powder 3.3 kg."""
    with two_rooms(scene("water_0", 10.0)) as rooms:
        assert offered(rooms.stage, VERBS) == ()
        acted(rooms, Action("walk_to", "water_0"))
        assert acted(rooms, Action("pick_up", "water_0")).reason == failures.TOO_HEAVY
    with two_rooms(scene()) as rooms:
        armed(rooms)
        result = acted(rooms, Action("drop"))
        assert result.ok and rooms.stage.held == -1
        for _ in range(30):
            rooms.base.advance(rooms.stage.act())
        b = rooms.index("powder_0")
        assert not bool(rooms.world.safe[0, b] | rooms.world.away[0, b])
        assert float(rooms.world.position[0, b, 2]) < 0.25
        gap = np.hypot(*(rooms.world.position[0, b, :2].numpy() - rooms.stage.robot.base()[:2]))
        assert rooms.stage.robot.build.radius < gap < 1.3


def test_extinguishers_are_told_apart_by_their_names() -> None:
    with two_rooms(spec(bodies=(bottle_of("small_powder_0", 2.0), bottle_of("red_one", 3.0), box()))) as rooms:
        assert [row.kind for row in tools(rooms.stage)] == ["small_powder", "powder"]
        assert rooms.world.equipment.full[0].tolist() == pytest.approx([0.0, 1.0, 2.0, 0.0])
        assert torch.equal(rooms.world.equipment.tool[0], torch.tensor([False, True, True, False]))


def test_the_heat_keeps_a_robot_away() -> None:
    with two_rooms(scene(), physics="realistic") as rooms:
        armed(rooms)
        rooms.base.episode.forbidden = lambda points: torch.ones(points.shape[:2], dtype=torch.bool)
        assert acted(rooms, PUT_OUT).reason == failures.TOO_HOT


def test_a_tool_that_is_let_go_over_the_bag_is_not_rescued() -> None:
    with two_rooms(scene()) as rooms:
        armed(rooms)
        for _ in range(60):
            rooms.base.advance(rooms.stage.act(shut=False))
        b = rooms.index("powder_0")
        assert rooms.stage.held == -1 and not bool(rooms.world.safe[0, b] | rooms.world.away[0, b])


def test_flames_in_sight_come_before_those_that_it_must_walk_to() -> None:
    """Two boxes burn in the next room: the nearer one is hidden, and the jet gets to the other through the door."""
    boxes = (box((4.6, 2.0, 0.0)), box((4.0, 0.9, 0.0), "box_1"))
    opened = replace(DOOR, open=1.0)
    with two_rooms(spec(door=opened, start=START, bodies=(bottle_of("powder_0", 3.3), *boxes))) as rooms:
        armed(rooms)
        ignite(rooms, "box_1")
        start, begun, advance = np.array(rooms.stage.robot.base()[:2]), list[float](), rooms.base.advance

        def advanced(low_level: Any) -> Any:
            if not begun and bool(rooms.world.jets[0].flowing[0]):
                begun.append(float(np.hypot(*(np.array(rooms.stage.robot.base()[:2]) - start))))
            return advance(low_level)

        rooms.base.advance = advanced
        assert acted(rooms, PUT_OUT).ok
        del rooms.base.advance
        assert begun[0] < 0.1 and not burns(rooms) and not burns(rooms, "box_1")


def test_it_aims_where_most_flames_are_in_the_jet() -> None:
    """Of three flames in a line across the jet it is the middle one."""
    with two_rooms(scene()) as rooms:
        armed(rooms)
        nozzle, row = np.array([0.0, 0.0, 0.8]), [np.array([3.0, y, 0.0]) for y in (-0.3, 0.0, 0.3)]
        covered = [_covered(rooms.stage, nozzle, flame, [*row, np.array([9.0, 0.0, -0.8])]) for flame in row]
        assert covered == [2, 3, 2]  # 0.3 m in 3.1 m are 0.097 of the 0.12 rad of powder; 9 m are beyond its reach
