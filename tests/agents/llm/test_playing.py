"""A model that follows a rule plays as the rule does: what it is told, and how it is read, lose nothing."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hazard_ms.agents.base import agent
from hazard_ms.agents.llm.prompt import PICTURE, VERSIONS
from hazard_ms.agents.llm.rules import RULES, block_in
from hazard_ms.agents.llm.scripted import ScriptedServer
from hazard_ms.skills.decision import Action, Images
from tests.agents.llm.conftest import Ground, Made
from tests.worlds.playground import brief, play


def rows(folder: Path) -> list[dict[str, Any]]:
    """The lines of all traces in a folder."""
    return [json.loads(line) for path in sorted(folder.glob("*.jsonl")) for line in path.read_text().splitlines()]


@pytest.mark.parametrize("way", ["json", "letter", "logprob", "think"])
@pytest.mark.parametrize("rule", ["first", "greedy"])
def test_over_the_network_a_rule_takes_what_it_takes_of_the_text(
    llm: Made, tmp_path: Path, way: str, rule: str
) -> None:
    player = llm(rule, way=way, trace=str(tmp_path))
    taken = play(player, Ground(), most=25)
    asked = rows(tmp_path)
    assert len(asked) == player.counters["decisions"] >= 3
    for row in asked:
        letter = RULES[rule](block_in(row["asked"][-1]["content"]))
        assert row["letter"] == letter and letter in row["options"]
    in_order = iter(map(str, taken))
    assert all(row["action"] in in_order for row in asked), "each is done, in this order"
    faults = ("invalid", "repaired", "fallbacks", "refused", "truncated", "lost", "retries", "cached")
    assert [player.counters[name] for name in faults] == [0] * len(faults)


@pytest.mark.parametrize("version", [version for version in VERSIONS if version != "llm-2-image"])
def test_all_versions_save_what_can_be_saved(llm: Made, version: str) -> None:
    ground = Ground()
    taken = play(llm(version=version), ground)
    assert ground.rescued == {"mug", "book", "far"}
    assert taken[0] == Action("explore") and taken[-1] == Action("stop")


def test_ways_differ_in_nothing_but_the_calls(llm: Made) -> None:
    taken, calls = {}, {}
    for way in ("json", "letter", "logprob", "think"):
        player = llm(way=way)
        taken[way], calls[way] = play(player, Ground()), player.counters["calls"]
    assert taken["json"] == taken["letter"] == taken["logprob"] == taken["think"]
    assert calls["think"] == 2 * calls["json"] and calls["letter"] == calls["logprob"] == calls["json"]


def test_in_full_moves_the_model_picks_up_and_puts_away(llm: Made) -> None:
    ground = Ground()
    player = llm(moves="full", options=20)
    taken = play(player, ground)
    assert ground.rescued >= {"mug", "book"}
    assert player.counters["decisions"] == len(taken), "nothing is done without asking"
    alone = llm()
    assert alone.counters == {} and len(play(alone, Ground())) > alone.counters["decisions"]


def test_with_carts_the_model_chooses_the_cart(llm: Made) -> None:
    places = {"mug": (2.0, 0.0), "cart_1": (0.0, 2.0), "cart_2": (2.0, 1.5)}
    ground = Ground(places, {"mug": 1.0}, frozenset(), carts=("cart_1", "cart_2"))
    taken = play(llm(), ground)
    assert ground.rescued == {"mug"}
    assert Action("walk_to", "cart_2") in taken and Action("drop", "cart_2") in taken


def test_a_picture_goes_to_models_that_see(llm: Made) -> None:
    """The scripted model "sees" refuses prompts without exactly one JPEG that is small enough."""
    rgb = np.random.default_rng(0).integers(0, 255, (600, 900, 3), dtype=np.uint8)
    images = Images(rgb, np.zeros((600, 900), np.float32), None, np.zeros((1, 16, 16), np.float32))
    shown = dataclasses.replace(Ground().decision(), images=images)
    player = llm("sees", version="llm-2-image")
    player.reset(brief())
    assert player.act(shown) == Action("explore") and not player.fallback
    assert max(rgb.shape) > PICTURE
    blind = llm("sees", version="llm-2")
    blind.reset(brief())
    with pytest.raises(RuntimeError, match="one picture"):
        blind.act(shown)


def test_an_episode_begins_afresh(llm: Made) -> None:
    player = llm()
    first, counted = play(player, Ground()), dict(player.counters)
    again = play(player, Ground())
    assert again == first
    seconds = counted.pop("seconds")
    assert seconds > 0 and counted.items() <= player.counters.items()


def test_the_agent_is_named_with_its_address(server: ScriptedServer) -> None:
    """An address holds colons, which part names from parameters elsewhere."""
    made = agent(f"llm:base_url={server.address},model=greedy,version=llm-2,top_p=none")
    assert (made.base_url, made.model, made.version) == (server.address, "greedy", "llm-2")  # type: ignore[attr-defined]
    assert made.top_p is None  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        ({"version": "llm-9"}, "version must be one of"),
        ({"way": "shout"}, "way must be one of"),
        ({"moves": "some"}, "moves must be one of"),
        ({"stand_in": "planner"}, "stand_in must be one of"),
        ({"options": 21}, "options must be a whole number from 6 to 20, got 21"),
        ({"deadline": 0.0}, "deadline must be more than 0"),
        ({"replay": True}, "cache must name a file"),
        ({"most_cost": 1.0}, "price_in or price_out must be above 0"),
        ({"most_calls": -1}, "calls must be at least 0, got -1"),
    ],
)
def test_wrong_parameters_are_refused(llm: Made, parameters: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        llm(**parameters)
