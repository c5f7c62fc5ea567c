"""Models read of mitigations, doors and tools where a task has them, and of nothing new where it has none."""

from __future__ import annotations

import dataclasses

from hazard_ms.agents.llm.choices import forced, menu
from hazard_ms.agents.llm.memory import Memory
from hazard_ms.agents.llm.prompt import system_text
from hazard_ms.agents.llm.scene_text import block
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.skills.decision import Action, Decision, Result, Tool
from tests.agents.llm.conftest import Ground
from tests.worlds.playground import brief

DOOR = KnownOpening("door_0", 0, "door", (3.0, 4.0, 1.0), 0.9, 0.5, False, 7)
SHUT, PICK = Action("shut", "door_0"), Action("pick_up", "shelf")
MITIGATES = dataclasses.replace(brief(), mitigations=("shut", "extinguish"))


def decision(held: bool) -> Decision:
    """The shelf stands for an extinguisher."""
    ground = Ground(held="shelf" if held else None)
    ground.look()
    made = ground.decision()
    tool = Tool("shelf", "fire_extinguisher", "powder", 0.75, held)
    more = (SHUT, *(() if held else (PICK,)))
    return dataclasses.replace(made, openings=(DOOR,), tools=(tool,), available=(*made.available, *more))


def test_mitigations_and_tools_are_on_offer() -> None:
    free, full = ([(c.move, c.thing) for c in menu(decision(h), {}, {}, 4, "macro", 20).choices] for h in (False, True))
    assert ("shut", "door_0") in free and ("fetch", "shelf") in free and ("put down", "shelf") not in free
    assert ("shut", "door_0") in full and ("put down", "shelf") in full and ("fetch", "shelf") not in full
    told = block(MITIGATES, decision(False), Memory(0), menu(decision(False), {}, {}, 4, "macro", 20))
    assert told["doors"] == [["door", "metres", "percent_open"], ["door_0", 5.0, 50]]
    letter = next(key for key, text in told["options"].items() if text == "fetch shelf")
    assert told["tools"] == [["option", "tool", "kind", "percent_left"], [letter, "shelf", "powder", 75]]
    assert "shut door_0" in told["options"].values()


def test_a_tool_in_the_hand_is_not_put_into_the_bag_by_itself() -> None:
    assert forced(decision(True)) is None
    arrived = dataclasses.replace(
        decision(False), last_action=Action("walk_to", "shelf"), last_result=Result(True, "", 10)
    )
    assert forced(arrived) == PICK


def test_the_task_names_its_mitigations_and_others_are_as_they_were() -> None:
    text = system_text(MITIGATES, True)
    assert text.startswith(system_text(brief(), True)) and '"extinguish" puts out' in text and '"open"' not in text
    plain = Ground().decision()
    told = block(brief(), plain, Memory(0), menu(plain, {}, {}, 4, "macro", 20))
    assert "doors" not in told and "tools" not in told
