"""How agents are found and made, what they are told, and that they cannot write to what they get."""

from __future__ import annotations

import dataclasses
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hazard_ms.agents.base import LONGEST_NOTE, Agent, agent, check_name, counters_of, note_of
from hazard_ms.agents.greedy import Greedy
from hazard_ms.hazards.presets import hazard
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sensing.target_table import Target
from hazard_ms.skills.brief import Brief, HazardBrief, random_seed
from hazard_ms.skills.decision import STOP, Action, Decision
from hazard_ms.spec.registry import AGENTS, HAZARDS
from tests.worlds.playground import Playground, brief

OWN = """
from hazard_ms import Action, Agent

class Mine(Agent):
    def reset(self, brief):
        self.brief = brief

    def act(self, decision):
        return Action("stop")
"""


class Tuned(Agent):
    """A third party's agent with parameters of every kind."""

    def __init__(self, depth: int = 1, share: float = 0.5, loud: bool = False, word: str = "", most: int | None = 3):
        self.given = (depth, share, loud, word, most)

    def reset(self, brief: Brief) -> None:
        return

    def act(self, decision: Decision) -> Action:
        return Action(STOP)


ME = f"{Tuned.__module__}:Tuned"


def test_agents_are_found_by_name() -> None:
    assert {type(agent(name)).__name__.lower() for name in AGENTS} >= {"greedy", "random"}
    assert type(agent(ME)).__name__ == "Tuned"
    assert agent("greedy") is not agent("greedy")


def test_an_agent_is_found_in_a_file(tmp_path: Path) -> None:
    (tmp_path / "own.py").write_text(OWN)
    made = agent(f"{tmp_path}/own.py:Mine")
    made.reset(brief())
    assert type(made).__name__ == "Mine" and made.act(Playground({}, {}).decision()) == Action(STOP)
    with pytest.raises(ValueError, match="own.py, got 'Yours'"):
        agent(f"{tmp_path}/own.py:Yours")


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("gready", "greedy"),
        ("no.such.module:X", "module"),
        ("no_such_file.py:X", "no_such_file.py"),
        ("math:sqrt", "subclass"),
        (f"{__name__}:Missing", "Missing"),
        (f"{__name__}:OWN", "subclass"),
    ],
)
def test_unknown_agents_are_refused(name: str, told: str) -> None:
    assert __name__ in sys.modules
    with pytest.raises(ValueError, match=told):
        agent(name)


def test_parameters_are_converted_as_they_are_annotated() -> None:
    made = agent(f"{ME}:depth=4,share=1e-3,loud=True,word=a b,most=none")
    assert made.given == (4, 0.001, True, "a b", None)  # type: ignore[attr-defined]
    assert [type(v) for v in made.given[:4]] == [int, float, bool, str]  # type: ignore[attr-defined]
    assert agent(f"{ME}:most=7").given == (1, 0.5, False, "", 7)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("greedy:giveup=3", "give_up=..., belief=..., got 'giveup=3'"),
        ("greedy:give_up=few", "give_up must be int, got 'few'"),
        ("greedy:give_up=0", "give_up must be at least 1, got 0"),
        ("random:seed=3", r"\(none\), got 'seed=3'"),
        (f"{ME}:loud=perhaps", "loud must be bool, got 'perhaps'"),
        (f"{ME}:depth=1,share", "got 'share'"),
    ],
)
def test_wrong_parameters_are_refused(text: str, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        agent(text)


@pytest.mark.parametrize(
    ("note", "shown"),
    [
        (None, ""),
        ("", ""),
        ("to the bag: 3 m, 20 °C", "to the bag: 3 m, 20 °C"),
        ("one\ntwo\tthree\r\0", "one two three  "),
        ("\x1b]0;title\x07 \ud800 \u202e", " ]0;title     "),
        ("y" * LONGEST_NOTE, "y" * LONGEST_NOTE),
        ("y" * (LONGEST_NOTE + 1), "y" * (LONGEST_NOTE - 1) + "…"),
        ("y" * 2_000_000, "y" * (LONGEST_NOTE - 1) + "…"),
    ],
    ids=lambda text: repr(text)[:20],
)
def test_of_a_note_that_is_shown_which_can_be(note: str | None, shown: str) -> None:
    player = Tuned()
    player.note = note
    assert note_of(player) == shown


@pytest.mark.parametrize("note", [object(), 3, b"bytes", ["a list"], float("nan")])
def test_a_note_that_is_no_text_is_refused(note: object) -> None:
    player = Tuned()
    player.note = note  # type: ignore[assignment]
    with pytest.raises(ValueError, match=f"note of Tuned must be a str or None, got a {type(note).__name__}"):
        note_of(player)


def test_an_agent_that_ends_the_process_while_it_is_made_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "at_import.py").write_text("import sys\nsys.exit(0)")
    with pytest.raises(RuntimeError, match=r"at_import.py:X must return or raise an error, got sys.exit\(0\)"):
        agent(f"{tmp_path}/at_import.py:X")


def test_names_are_checked_without_making_an_agent() -> None:
    for text in ("greedy", "greedy:give_up=3", "package.module:Class", "no/such/file.py:Class", "a:B:c=3"):
        check_name(text)
    for text in ("gready", "gready:give_up=3"):
        with pytest.raises(ValueError, match="did you mean 'greedy'"):
            check_name(text)


def test_greedy_gives_up_when_it_is_told_to() -> None:
    """With give_up=1 a target is tried once."""
    ground = Playground({"bad": (0.5, 0.0)}, {"bad": 5.0}, slippery=frozenset({"bad"}))
    player = agent("greedy:give_up=1")
    player.reset(brief())
    taken = []
    while not taken or (taken[-1].verb != STOP and len(taken) < 50):
        taken.append(player.act(ground.decision()))
        ground.do(taken[-1])
    assert [a.verb for a in taken].count("pick_up") == 1


def test_the_brief_gives_no_way_to_the_scene() -> None:
    """No field holds a scene's name, the task's functions or the episode's seed."""
    told = {f.name for f in dataclasses.fields(Brief)}
    assert not told & {"scene", "seed", "spec", "world", "split"}
    drawn = {random_seed(seed) for seed in range(1000)}
    assert len(drawn) == 1000 and min(drawn) > 1000 and random_seed(7) == random_seed(7)
    assert random_seed(0) == 0x5C0FE9F99BD73B12  # printf 'hazard_ms agent 0' | sha256sum


@pytest.mark.parametrize("name", sorted(HAZARDS))
def test_every_hazard_says_what_it_threatens(name: str) -> None:
    made = hazard(name, "paper")
    told = HazardBrief(made.name, made.level.title, made.level.unit, made.threatens)
    thing = Target(0, "cup_1", "cup", 1.0, True, False, 200.0)
    found = [bool(told.threatens(thing, level, 0.5)) for level in (-1e3, 0.0, 0.6, 250.0, 1e9)]
    assert found == sorted(found), "a higher level is no safer"


def test_the_table_of_threats() -> None:
    """Fire: flammable things from their ignition temperature; water: what is not waterproof, up to its middle."""
    fire, flood, wind = (hazard(name, "paper") for name in ("fire", "flood", "wind"))
    paper = Target(0, "paper_1", "book", 1.0, True, False, 230.0)
    duck = Target(1, "duck_1", "ball", 1.0, False, True, 400.0)
    assert [fire.threatens(t, level, 0.5) for t in (paper, duck) for level in (229.0, 230.0)] == [0, 1, 0, 0]
    assert [flood.threatens(t, level, 0.5) for t in (paper, duck) for level in (0.49, 0.5)] == [0, 1, 0, 0]
    assert not wind.threatens(paper, 100.0, 0.5)


def test_greedy_knows_hazards_by_what_they_threaten_alone() -> None:
    """A hazard of a third party, the second of two, that harms what is near the floor."""
    ground = Playground({"low": (2.0, 0.0), "high": (-2.4, 0.0)}, {"low": 5.0, "high": 5.0})
    harmless = HazardBrief("rain", "rain", "mm", lambda target, level, height: False)
    quake = HazardBrief("quake", "shaking", "g", lambda target, level, height: level > 1.0 and height < 0.3)
    player = Greedy()
    player.reset(dataclasses.replace(brief(), hazards=(harmless, quake)))
    ground.do(player.act(ground.decision()))
    low = ground.map.objects[0]
    low = dataclasses.replace(low, position=low.position * np.float32([1, 1, 0.2]), levels=(0.0, 2.0))
    ground.remember(0, dataclasses.replace(low, history=((0, (0.0, 2.0)),)))
    assert player.act(ground.decision()).target == "high"
    ground.remember(0, dataclasses.replace(low, levels=(2.0, 0.0), history=((0, (2.0, 0.0)),)))
    assert player.act(ground.decision()).target == "low"


def seen_map() -> SemanticMap:
    made = SemanticMap((0.0, 0.0), np.ones(2, bool), hazards=2)
    made.explored[3, 4] = True
    made.objects = {1: Sighting(np.zeros(3, np.float32), 0.1, 0.3, 0, 40)}
    return made


@pytest.mark.parametrize("name", ["height", "explored", "object_id", "hazard", "levels", "origin", "loose"])
def test_arrays_of_the_map_cannot_be_written(name: str) -> None:
    array = getattr(seen_map().frozen(), name)
    with pytest.raises(ValueError, match="read-only"):
        array[...] = 0


def test_the_memory_of_the_map_cannot_be_written() -> None:
    live = seen_map()
    seen = live.frozen()
    with pytest.raises(TypeError):
        seen.objects[0] = seen.objects[1]  # type: ignore[index]
    with pytest.raises(AttributeError):
        seen.objects.pop(1)  # type: ignore[attr-defined]
    with pytest.raises(AttributeError, match="read-only"):
        seen.explored = live.explored
    with pytest.raises(ValueError, match="read-only"):
        seen.mark_free((0.0, 0.0), 0.3)
    live.forget(1)
    live.explored[3, 4] = False
    assert 1 in seen.objects and seen.explored[3, 4], "a decision keeps what was known when it was taken"


@pytest.mark.parametrize("wrong", [{"a": math.nan}, {"a": math.inf}, {"a": "x"}, {5: 1.0}, {"a" * 3000: 1.0}])
def test_counters_are_finite_numbers_with_short_names(wrong: dict[Any, Any]) -> None:
    player = agent("random")
    assert counters_of(player) == {}
    player.counters = {"asked": 3, "cost": 0.5}
    assert counters_of(player) == {"asked": 3, "cost": 0.5}
    player.counters = wrong
    with pytest.raises(ValueError, match="Random must be"):
        counters_of(player)
