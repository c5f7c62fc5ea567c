"""Models read of mitigations, doors and tools where a task has them, and of nothing new where it has none."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from hazard_ms.agents.llm.choices import NEAREST, forced, menu
from hazard_ms.agents.llm.homes.rooms import Rooms
from hazard_ms.agents.llm.memory import Memory
from hazard_ms.agents.llm.prompt import system_text
from hazard_ms.agents.llm.rules import RULES, rows
from hazard_ms.agents.llm.scene_text import Block, block
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.decision import Action, Decision, Result, Tool
from tests.agents.llm.conftest import Ground
from tests.worlds.playground import brief

DOOR = KnownOpening("door_0", 0, "door", (3.0, 4.0, 1.0), 0.9, 0.5, False, 7)
SHUT, PICK = Action("shut", "door_0"), Action("pick_up", "shelf")
MITIGATES = dataclasses.replace(brief(), mitigations=("shut", "extinguish"), several_rooms=True, averted=True)


def decision(held: bool) -> Decision:
    """The shelf stands for an extinguisher."""
    ground = Ground(held="shelf" if held else None, sight=5.0)
    ground.frame = 10
    ground.look()
    made = ground.decision()
    tool = Tool("shelf", "fire_extinguisher", "powder", 0.75, held)
    more = (SHUT, *(() if held else (PICK,)))
    return dataclasses.replace(made, openings=(DOOR,), tools=(tool,), available=(*made.available, *more))


def told_of(at: Decision, memory: Memory | None = None) -> Block:
    return block(MITIGATES, at, memory or Memory(0), menu(at, {}, {}, 4, "macro", 20))


def test_mitigations_and_tools_are_on_offer() -> None:
    free, full = ([(c.move, c.thing) for c in menu(decision(h), {}, {}, 4, "macro", 20).choices] for h in (False, True))
    assert ("shut", "door_0") in free and ("fetch", "shelf") in free and ("put down", "shelf") not in free
    assert ("shut", "door_0") in full and ("put down", "shelf") in full and ("fetch", "shelf") not in full
    told = told_of(decision(False))
    assert told["doors"] == [["door", "metres", "percent_open", "joins", "frames_ago"], ["door_0", 5.0, 50, [], 3]]
    letter = next(key for key, text in told["options"].items() if text == "fetch shelf")
    header = ["option", "tool", "kind", "percent_left", "metres", "room"]
    assert told["tools"] == [header, [letter, "shelf", "powder", 75, 4.5, None]], "it stands at (4.5, 0.5)"
    assert "shut door_0" in told["options"].values()


def test_of_each_verb_the_nearest_few_are_offered_and_targets_keep_their_room() -> None:
    doors = tuple(dataclasses.replace(DOOR, name=f"door_{k}", position=(9.0 - k, 0.0, 1.0)) for k in range(9))
    at = decision(False)
    more = tuple(Action(verb, door.name) for verb in ("open", "shut") for door in doors)
    made = menu(dataclasses.replace(at, openings=doors, available=more), {}, {}, 4, "macro", 20).choices
    assert [c.thing for c in made if c.move == "shut"] == ["door_6", "door_7", "door_8"] and NEAREST == 3
    assert [c.thing for c in made if c.move == "fetch"] == ["mug", "book", "stone"]


def test_a_tool_in_the_hand_is_not_put_into_the_bag_by_itself() -> None:
    assert forced(decision(True)) is None
    arrived = dataclasses.replace(
        decision(False), last_action=Action("walk_to", "shelf"), last_result=Result(True, "", 10)
    )
    assert forced(arrived) == PICK


def test_the_task_names_its_mitigations_and_others_are_as_they_were() -> None:
    text = system_text(MITIGATES, True)
    assert text.startswith(system_text(brief(), True)) and '"extinguish" puts out' in text and '"open"' not in text
    assert "lost if nobody acted" in text and "lost if nobody acted" not in system_text(brief(), True)
    plain = Ground().decision()
    told = block(brief(), plain, Memory(0), menu(plain, {}, {}, 4, "macro", 20))
    assert not {"doors", "tools", "here", "hot"} & told.keys() and "room" not in told["targets"][0]


def test_what_is_hot_and_what_rises_is_told() -> None:
    """From 60 to 160 degrees in 50 frames is 200 in 100; what the robot stands on had 45 degrees."""
    at = decision(False)
    history = ((20, (60.0,)), (70, (160.0,)))
    near = Sighting(np.array([2.0, 0.0, 0.5], np.float32), 0.1, 0.6, 70, 50, (160.0,), history=history)
    at.map.objects = {**at.map.objects, 0: near}
    at.map.levels = np.full((1, *at.map.height.shape), np.nan, np.float32)
    y, x = np.floor((np.array([0.0, 0.5]) - at.map.origin[::-1]) / at.map.cell).astype(int)
    at.map.levels[0, y, x] = 45.0
    told = told_of(dataclasses.replace(at, frame=80))
    (mug,) = [row for row in rows(told["targets"]) if row["thing"] == "mug"]
    assert (mug["temperature_C"], mug["temperature_C_per_100_frames"]) == (160, 200)
    assert told["here"] == {"room": None, "temperature_C": 45}
    assert told["hot"][1:] == [[None, "mug", 2.0, 160, None, 10]]


# ---------------------------------------------------------------- rooms


def two_rooms(gap: int = 0, seen_to: float = 9.0) -> SemanticMap:
    """Floor from (-4, -3) to (6, 3) m that a wall at x = 1 divides, with a doorway of 0.9 m around y = 0.

    `gap`: cells of the wall that were not seen as such; the floor is explored as far east as `seen_to` [m].
    """
    made = SemanticMap((0.0, 0.0), np.ones(1, bool))
    y, x = np.mgrid[0 : made.height.shape[0], 0 : made.height.shape[1]]
    east, north = made.origin[0] + (x + 0.5) * made.cell, made.origin[1] + (y + 0.5) * made.cell
    floor = (east > -4.0) & (east < min(6.0, seen_to)) & (abs(north) < 3.0)
    wall = floor & (abs(east - 1.0) < 0.051) & (abs(north) > 0.45)
    if gap:
        wall &= ~((north > 2.0) & (north < 2.0 + gap * made.cell))
    rim = (east > -4.1) & (east < 6.1) & (abs(north) < 3.1) & ~((east > -4.0) & (east < 6.0) & (abs(north) < 3.0))
    made.explored = floor | rim
    made._firm[wall | rim] = 1.9
    return made


def opening(y: float = 0.0) -> KnownOpening:
    return KnownOpening("doorway_0", 0, "doorway", (1.0, y, 1.0), 0.9, 1.0, False, 0)


@pytest.mark.parametrize("gap", [0, 1, 2])
def test_walls_and_openings_divide_rooms_and_gaps_in_what_was_seen_do_not_join_them(gap: int) -> None:
    rooms = Rooms()
    assert rooms.at((0.0, 0.0)) is None
    rooms.see(two_rooms(gap), (opening(),))
    west, east = rooms.at((-2.0, 1.0)), rooms.at((4.0, -1.0))
    assert {west, east} == {"room_1", "room_2"} and rooms.at((-40.0, 0.0)) is None
    assert rooms.joined(opening()) == ["room_1", "room_2"]
    assert rooms.at((0.7, 2.5)) == west and rooms.at((1.3, 2.5)) == east
    undivided = Rooms()
    undivided.see(two_rooms(gap), ())
    assert undivided.at((-2.0, 1.0)) == undivided.at((4.0, -1.0)) == "room_1", "nobody has seen the doorway"


def test_rooms_keep_their_numbers_when_others_are_found() -> None:
    rooms = Rooms()
    rooms.see(two_rooms(seen_to=1.2), (opening(),))
    assert rooms.at((-2.0, 1.0)) == "room_1" and rooms.at((4.0, -1.0)) is None
    assert rooms.joined(opening()) == ["room_1"]
    rooms.see(two_rooms(), (opening(),))
    assert rooms.at((-2.0, 1.0)) == "room_1" and rooms.at((4.0, -1.0)) == "room_2"


# ---------------------------------------------------------------- the scripted model that mitigates

HOT = [["option", "thing", "metres", "temperature_C", "room", "frames_ago"], ["X", "rug", 3.0, 300, "room_2", 0]]
TOOLS = [["option", "tool", "kind", "percent_left", "metres", "room"], ["T", "spray", "powder", 100, 2.0, "room_1"]]
DOORS = [["door", "metres", "percent_open", "joins", "frames_ago"], ["door_0", 2.0, 100, ["room_1", "room_2"], 0]]
TARGETS = [["option", "thing", "value", "metres"], ["A", "mug", 5, 1.0]]


def answer(options: dict[str, str], done: list[list[Any]] | None = None, **told: Any) -> str:
    """What it does where `options` are on offer, after `done`; the rest of the block is as `told`."""
    made: Block = {
        "last_actions": [["action", "result", "frames"], ["look", "done", 60], *(done or [])],
        "held": None,
        "here": {"room": "room_1"},
        "targets": TARGETS,
        "places_to_search": [["option", "near", "metres", "unexplored_metres", "visits"]],
        "options": {**options, "Z": "stop"},
        **told,
    }
    letter = RULES["mitigates"](made)
    return str(made["options"][letter])


def test_it_fetches_an_extinguisher_puts_out_what_is_hot_and_puts_it_down() -> None:
    fetch = {"A": "fetch mug", "T": "fetch spray"}
    assert answer(fetch, hot=HOT, tools=TOOLS) == "fetch spray"
    assert answer(fetch, tools=TOOLS) == "fetch mug", "nothing is hot"
    assert answer(fetch, hot=HOT, tools=[TOOLS[0], ["T", "spray", "powder", 0, 2.0, "room_1"]]) == "fetch mug"
    held = {"X": "extinguish rug", "D": "put down spray"}
    failed = ["extinguish rug", "failed: no line of sight", 50]
    assert answer(held, held="spray", hot=HOT, tools=TOOLS) == "extinguish rug"
    assert answer(held, [failed, failed], held="spray", hot=HOT, tools=TOOLS) == "put down spray"
    assert answer(held, [["extinguish rug", "paused", 400]] * 3, held="spray", hot=HOT, tools=TOOLS) == "extinguish rug"
    assert answer(held, held="spray", tools=TOOLS) == "put down spray"


def test_it_shuts_the_door_of_a_room_that_burns_behind_itself_and_opens_others_at_last() -> None:
    shut = {"A": "fetch mug", "S": "shut door_0"}
    assert answer(shut, hot=HOT, doors=DOORS) == "shut door_0"
    assert answer(shut, hot=HOT, doors=DOORS, here={"room": "room_2"}) == "fetch mug", "it is in there"
    assert answer(shut, [["shut door_0", "failed: in the swing", 90]], hot=HOT, doors=DOORS) == "fetch mug"
    assert answer(shut, doors=DOORS, here={"room": "room_1", "water_level_m": 0.05}) == "shut door_0"
    closed = [DOORS[0], ["door_0", 2.0, 0, ["room_1"], 0]]
    assert answer({"O": "open door_0", "A": "fetch mug"}, doors=closed) == "fetch mug"
    assert answer({"O": "open door_0"}, doors=closed, targets=TARGETS[:1]) == "open door_0"


def test_it_pushes_a_cart_once() -> None:
    options = {"A": "fetch mug", "P": "push cart_1"}
    assert answer(options) == "push cart_1"
    assert answer(options, [["push cart_1", "paused", 400]]) == "push cart_1"
    assert answer(options, [["push cart_1", "done", 400]]) == "fetch mug"
