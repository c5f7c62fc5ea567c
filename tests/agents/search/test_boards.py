"""What planner and mcts know of flood boards: which can be set where, in what time, and that they set them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.agents.search.boards import DETOUR, SETTING, settings
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sketch.travel.ways import WALK
from hazard_ms.skills.decision import DROP, PICK_UP, Action, Decision, Tool
from tests.agents.search.test_mitigating import decision

PICK = 60.0
WEST = KnownOpening("door_1", 1, "door", (-4.0, 0.0, 1.0), 0.95, 1.0, False, 0, outer=True)
NORTH = KnownOpening("door_2", 2, "door", (0.0, 3.0, 1.0), 0.95, 1.0, False, 0, outer=True)
INNER = KnownOpening("door_3", 3, "door", (2.0, 0.0, 1.0), 0.95, 1.0, False, 0)
BOARDS = {"flood_board_1": (-3.0, 0.0), "flood_board_2": (0.0, 2.0)}


def given(held: str | None = None, **more: object) -> Decision:
    """From (0, 0), with both boards in the map but for the one in the hand."""
    made = decision()
    names = (*made.names, *BOARDS)
    rows = dict(made.map.objects)
    for name, place in BOARDS.items():
        if name != held:
            rows[names.index(name)] = Sighting(np.array([*place, 0.3], np.float32), 0.5, 0.6, 60, 50, (0.0,))
    made.map.objects = rows
    tools = tuple(Tool(name, "box", "", 1.0, held == name) for name in BOARDS)
    fields = {"names": names, "held": held, "tools": tools, "openings": (WEST, NORTH, INNER), **more}
    return replace(made, **fields)


def test_boards_go_into_outer_doors_one_by_one_and_both_in_either_order() -> None:
    made = settings(given(), {}, 2, PICK)
    assert [[door.name for door in one.doors] for one in made] == [
        ["door_1"],
        ["door_2"],
        ["door_1", "door_2"],
        ["door_2", "door_1"],
    ]
    assert [one.all for one in made] == [False, False, True, True]
    assert [one.action.target for one in made] == ["flood_board_1", "flood_board_2"] * 2
    assert {one.action.verb for one in made} == {PICK_UP}


def test_frames_are_those_of_picking_up_setting_and_the_ways_but_the_direct_one() -> None:
    """To the west: the board lies on the way. Then north: back 4 m to the board, 1 m on, 3 m of which are direct."""
    west, _, both, _ = settings(given(), {}, 2, PICK)
    assert west.frames == pytest.approx(PICK + SETTING) and west.place == (-4.0, 0.0)
    assert west.doors[0].boarded == round(60 + PICK + SETTING + DETOUR * WALK * 4.0)
    back = float(np.hypot(4.0, 2.0))
    assert both.frames == pytest.approx(2 * (PICK + SETTING) + DETOUR * WALK * (4.0 + back + 1.0 - 3.0))


def test_a_board_in_the_hand_is_set_and_one_that_stands_stays() -> None:
    west, *rest = settings(given(held="flood_board_1"), {}, 2, PICK)
    assert west.action == Action("block", "door_1") and west.frames == pytest.approx(SETTING)
    assert all(one.action.verb == "block" for one in rest)
    stands = given(openings=(replace(WEST, boarded=50, position=(-3.0, 0.0, 1.0)), NORTH))
    (north,) = settings(stands, {}, 2, PICK)
    assert north.action.target == "flood_board_2" and north.all


def test_nothing_is_set_with_another_thing_in_the_hand_or_after_failures() -> None:
    assert settings(given(held="book_1"), {}, 2, PICK) == []
    assert [one.doors[0].name for one in settings(given(), {"block door_1": 2}, 2, PICK)] == ["door_2"]
    assert settings(given(), dict.fromkeys(BOARDS, 2), 2, PICK) == []
    assert DROP not in {one.action.verb for one in settings(given(), {}, 2, PICK)}
