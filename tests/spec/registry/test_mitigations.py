"""Mitigations are registered by verb; tasks that name none are as they were; one file from outside adds another."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hazard_ms
from hazard_ms.hazards.fire.fire_state import BURNING, BURNT, NORMAL
from hazard_ms.skills import failures
from hazard_ms.skills.actions import skill
from hazard_ms.skills.decision import PICK_UP, VERBS, WALK_TO, Action, Decision
from hazard_ms.skills.mitigations.offers import check, offered
from hazard_ms.spec import Body, registry
from hazard_ms.spec.registry.mitigations import (
    MITIGATIONS,
    PUBLISHED,
    register_mitigation,
    tools_of,
    unregister_mitigation,
)
from hazard_ms.tasks import task_of
from tests.worlds.registering import loaded
from tests.worlds.two_rooms import TwoRooms, spec, two_rooms

EXAMPLE = Path(__file__).parents[3] / "examples" / "own_tool.py"


@pytest.fixture
def example() -> Iterator[Any]:
    """The example is loaded, and what it registers is taken back."""
    with loaded(EXAMPLE) as module:
        yield module
        unregister_mitigation("cover")


def test_a_verb_is_registered_once_and_those_of_the_benchmark_are_taken() -> None:
    assert set(PUBLISHED) == set(VERBS)
    for verb in ("walk_to", "shut"):
        with pytest.raises(ValueError, match=f"a verb must be new, got '{verb}'"):
            register_mitigation(verb, "a:b", "a:b", "text")
    for verb in ("Shut", "two words", "", 3):
        with pytest.raises(ValueError, match="lower-case words joined by underscores"):
            register_mitigation(verb, "a:b", "a:b", "text")  # type: ignore[arg-type]
    assert tools_of(("shut", "extinguish")) == {"fire_extinguisher"}
    with pytest.raises(ValueError, match="mitigation must be one of .*, got 'fly'"):
        tools_of(("fly",))


@pytest.mark.parametrize("entry", MITIGATIONS.values(), ids=lambda entry: entry.verb)
def test_every_mitigation_can_be_loaded_and_says_what_it_does(entry: Any) -> None:
    assert callable(registry.load(entry.skill)) and callable(registry.load(entry.targets))
    codes = {value for name, value in vars(failures).items() if name.isupper() and isinstance(value, str)}
    assert len(entry.text) > 20 and set(entry.reasons) <= codes


def test_published_tasks_have_none_and_their_decisions_nothing_of_them() -> None:
    for name in ("HazardFire-v1", "HazardFlood-v1", "HazardWind-v1", "HazardCompound-v1"):
        assert task_of(name, "paper").mitigations == ()
    defaults = {field.name: field.default for field in fields(Decision)}
    assert defaults["openings"] == defaults["tools"] == ()


def test_without_mitigations_a_world_has_no_equipment_and_its_states_no_part_of_it() -> None:
    with two_rooms(spec(), verbs=()) as rooms:
        assert rooms.world.equipment is None and not rooms.world.jets
        assert rooms.world.takeable is rooms.world.target
        assert "equipment" not in rooms.base.get_state_dict()["hazard_ms"]
        with pytest.raises(ValueError, match="verb must be one of walk_to, .*, stop, got 'shut'"):
            check(Action("shut", "door_0"), rooms.stage, ())
        assert "equipment" not in rooms.base.episode.parts


def test_an_action_of_a_mitigation_names_something_that_the_scene_has() -> None:
    assert str(Action("shut", "door_0")) == "shut door_0"
    with pytest.raises(ValueError, match="the target of shut must be the name of a thing, got None"):
        Action("shut")
    with two_rooms(spec()) as rooms:
        check(Action("shut", "door_0"), rooms.stage, ("shut",))
        with pytest.raises(ValueError, match="the target of shut must be one of .*door_0, got 'door_7'"):
            check(Action("shut", "door_7"), rooms.stage, ("shut",))
        with pytest.raises(ValueError, match="verb must be one of .*, stop, shut, got 'open'"):
            check(Action("open", "door_0"), rooms.stage, ("shut",))


def acted(rooms: TwoRooms, action: Action) -> Any:
    for _ in range(6):
        result = rooms.run(skill(rooms.stage, action))
        rooms.look()
        if result.reason != failures.MAX_FRAMES:
            break
    return result


@pytest.mark.parametrize("physics", ["paper", "realistic"])
def test_a_file_from_outside_adds_a_fire_blanket(example: Any, physics: str) -> None:
    blanket = Body("bag_0", "bag", "plain_box", (2.4, 1.6, 0.0), scale=(0.2, 0.2, 0.2), mass=1.0)
    box = Body("box_0", "box", "plain_box", (5.0, 3.0, 0.0), scale=(0.3, 0.3, 0.3), mass=3.0)
    with two_rooms(spec(door=None, bodies=(blanket, box)), physics=physics, verbs=("cover",)) as rooms:
        assert offered(rooms.stage, ("cover",)) == (Action(PICK_UP, "bag_0"),)
        assert acted(rooms, Action("cover", "box_0")).reason == "no_blanket"
        assert acted(rooms, Action(WALK_TO, "bag_0")).ok and acted(rooms, Action(PICK_UP, "bag_0")).ok
        state, b = rooms.base.episode.states["fire"], rooms.index("box_0")
        state.status[0, b] = BURNING
        assert Action("cover", "box_0") in offered(rooms.stage, ("cover",))
        result = acted(rooms, Action("cover", "box_0"))
        assert result.ok, result
        assert int(state.status[0, b]) == (BURNT if physics == "realistic" else NORMAL) and rooms.stage.held == -1
        assert np.isfinite(rooms.world.position.numpy()).all()


def test_the_example_has_a_task_in_which_bags_are_no_targets(example: Any) -> None:
    task = task_of("HazardBlanket-v1", "paper")
    assert task.mitigations == ("cover",)
    made = task.build(task.scenes("train")[0])
    assert "bag" not in made.target_categories
    assert hazard_ms.register_mitigation is register_mitigation
