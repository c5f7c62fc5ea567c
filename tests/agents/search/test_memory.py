"""What is remembered: which failures count, where things were seen, and what a second try is worth."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hazard_ms.agents.search.memory import DRIFTED, LEGS, SAME_AGAIN, Memory
from hazard_ms.skills.decision import EXPLORE, PICK_UP, WALK_TO, Action, Decision, Result
from hazard_ms.skills.failures import TOO_FAR
from tests.worlds.playground import Playground


def looked() -> Playground:
    ground = Playground({"a": (2.0, 0.0), "b": (0.0, 2.0)}, {"a": 1.0, "b": 5.0})
    ground.look()
    return ground


def after(ground: Playground, action: Action, ok: bool, at: tuple[float, float] = (0.0, 0.0)) -> Decision:
    """The decision after an action that began at the origin and ended at a place [m]."""
    return replace(ground.decision(), last_action=action, last_result=Result(ok, "", 10), agent_position=at)


def test_a_walk_that_came_further_is_no_failure_but_many_are() -> None:
    ground, memory, walk = looked(), Memory(0), Action(WALK_TO, "a")
    for number in range(1, LEGS + 1):
        memory.chose(ground.decision(), walk)
        memory.note(after(ground, walk, False, (0.5, 0.0)))
        assert memory.failures == ({"a": 1} if number == LEGS else {})
    memory.chose(ground.decision(), walk)
    memory.note(after(ground, walk, False, (0.1, 0.0)))
    assert memory.failures == {"a": 2}, "it hardly moved"


def test_what_works_is_no_failure() -> None:
    ground, memory = looked(), Memory(0)
    for action in (Action(WALK_TO, "a"), Action(PICK_UP, "a"), Action(EXPLORE)):
        memory.chose(ground.decision(), action)
        memory.note(after(ground, action, True))
    assert memory.failures == {} and memory.chance(ground.decision(), "a") == 1.0


def test_it_knows_from_where_it_looked_around() -> None:
    ground, memory = looked(), Memory(0)
    for action in (Action(EXPLORE), Action(WALK_TO, "a"), Action(EXPLORE)):
        memory.chose(ground.decision(), action)
        memory.note(after(ground, action, True))
        ground.at = (1.0, 0.5)
    assert memory.looks == [(0.0, 0.0), (1.0, 0.5)]


def test_a_second_try_is_worth_half_from_elsewhere_and_hardly_any_from_there() -> None:
    ground, memory, pick = looked(), Memory(0), Action(PICK_UP, "a")
    memory.chose(ground.decision(), pick)
    memory.note(after(ground, pick, False))
    assert memory.chance(ground.decision(), "a") == pytest.approx(SAME_AGAIN / 2)
    assert memory.chance(replace(ground.decision(), agent_position=(3.0, 1.0)), "a") == pytest.approx(1 / 2)
    assert memory.chance(ground.decision(), "b") == 1.0


def test_a_third_try_hardly_ever_works() -> None:
    """A tenth at most, measured: 2 of 46, where of first ones 91 % worked."""
    ground, memory, pick = looked(), Memory(0), Action(PICK_UP, "a")
    for chance in (1 / 2, 1 / 10, 1 / 10):
        memory.chose(ground.decision(), pick)
        memory.note(after(ground, pick, False))
        assert memory.chance(replace(ground.decision(), agent_position=(3.0, 1.0)), "a") == pytest.approx(chance)


@pytest.mark.parametrize(("drift", "chance"), [(0.9 * DRIFTED, SAME_AGAIN / 2), (1.1 * DRIFTED, 1 / 2)])
def test_a_second_try_is_worth_half_from_there_too_where_the_thing_has_drifted(drift: float, chance: float) -> None:
    ground, memory, pick = looked(), Memory(0), Action(PICK_UP, "a")
    memory.chose(ground.decision(), pick)
    ground.places["a"] = (2.0, drift)
    ground.look()
    memory.note(after(ground, pick, False))
    assert memory.chance(ground.decision(), "a") == pytest.approx(chance)


def test_a_thing_that_went_away_is_as_easy_to_pick_up_as_before() -> None:
    ground, memory, pick = looked(), Memory(0), Action(PICK_UP, "a")
    memory.chose(ground.decision(), pick)
    memory.note(replace(after(ground, pick, False), last_result=Result(False, TOO_FAR, 0)))
    assert memory.failures == {"a": 1} and memory.chance(ground.decision(), "a") == 1.0


def test_a_track_grows_with_every_sighting() -> None:
    ground, memory = looked(), Memory(0)
    memory.note(ground.decision())
    memory.note(ground.decision())
    ground.frame, ground.places["a"] = 50, (2.0, 0.5)
    ground.look()
    memory.note(ground.decision())
    assert memory.tracks["a"] == [(0, (2.0, 0.0)), (50, (2.0, 0.5))]
