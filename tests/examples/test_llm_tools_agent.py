"""The example of an agent with tools: what a model calls is done, and what it says instead ends no episode."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.agents.base import Agent, agent
from hazard_ms.agents.llm import scripted
from hazard_ms.agents.llm.network.faults import RefusedError
from hazard_ms.agents.llm.prompt import text_of
from hazard_ms.agents.llm.rules import RULES, block_in
from hazard_ms.agents.llm.scripted import ScriptedServer
from hazard_ms.cli.__main__ import main
from hazard_ms.skills.decision import STOP, Action
from tests.worlds.playground import Playground, brief, play

EXAMPLE = Path(__file__).parents[2] / "examples" / "llm_tools_agent.py"
PLACES = {"red mug": (2.0, 0.0), "book": (0.0, 2.5), "far": (6.0, 0.0), "shelf": (4.5, 0.5)}
VALUES = {"red mug": 1.0, "book": 5.0, "far": 1.0}

Answer = Callable[[dict[str, Any]], Any]  # the `message` of the answer to a request


@pytest.fixture
def server() -> Iterator[ScriptedServer]:
    running = ScriptedServer().start()
    yield running
    running.stop()


@pytest.fixture
def player(server: ScriptedServer, monkeypatch: pytest.MonkeyPatch) -> Callable[[Answer], Agent]:
    """Makes the agent of the example, with a server whose model answers as a function does."""

    def made(answer: Answer) -> Agent:
        said = lambda request, model: {"choices": [{"message": answer(request)}]}  # noqa: E731
        monkeypatch.setattr(scripted, "completion", said)
        return agent(f"{EXAMPLE}:ToolsAgent:base_url={server.address},model=greedy")

    return made


def call(name: Any, **arguments: Any) -> dict[str, Any]:
    """A message that calls one function."""
    function = {"name": name, "arguments": json.dumps(arguments)}
    return {"role": "assistant", "content": None, "tool_calls": [{"id": "1", "type": "function", "function": function}]}


def greedily(request: dict[str, Any]) -> dict[str, Any]:
    """Calls the function for the option that the rule greedy takes, if it is among the tools of the request."""
    block = block_in(text_of(request["messages"]))
    words = block["options"][RULES["greedy"](block)]
    for tool in (tool["function"] for tool in request["tools"]):
        move, thing = tool["name"].replace("_", " "), tool["parameters"]["properties"].get("thing", {"enum": [None]})
        for name in thing["enum"]:
            if words == move + (f" {name}" if name else ""):
                return call(tool["name"], **({"thing": name} if name else {}))
    raise AssertionError(f"no tool for {words!r} among {request['tools']}")


def test_what_the_model_calls_is_done(player: Callable[[Answer], Agent]) -> None:
    ground = Playground(dict(PLACES), dict(VALUES))
    taken = play(player(greedily), ground)
    assert ground.rescued == set(VALUES) and taken[-1] == Action(STOP)


def test_in_wind_it_brings_things_to_carts(player: Callable[[Answer], Agent]) -> None:
    ground = Playground({"book": (2.0, 0.0), "cart_1": (0.0, 2.0)}, {"book": 1.0}, carts=("cart_1",))
    asked = player(greedily)
    assert Action("drop", "cart_1") in play(asked, ground, most=30) and ground.rescued == {"book"}


@pytest.mark.parametrize(
    "message",
    [
        {"role": "assistant", "content": "I would rather talk about the weather."},
        {"role": "assistant", "content": "", "tool_calls": []},
        {"role": "assistant", "content": "", "tool_calls": [{"function": {"name": "look", "arguments": "{"}}]},
        call("fly_to", thing="book"),
        call("fetch", thing="moon"),
        call("fetch", thing=["book"]),
        call(["look"]),
        call(None),
        {"tool_calls": [{"function": {"name": "look", "arguments": "[" * 100_000}}]},
        [3],
        None,
    ],
)
def test_an_unusable_answer_is_replaced_and_ends_no_episode(player: Callable[[Answer], Agent], message: Any) -> None:
    """The first option is to look around while nothing is known."""
    ground = Playground(dict(PLACES), dict(VALUES))
    asked = player(lambda request: message)
    asked.reset(brief())
    assert asked.act(ground.decision()) == Action("explore") and asked.fallback
    assert asked.note and asked.note.startswith("no function on offer was called")


def test_a_call_without_arguments_is_taken(player: Callable[[Answer], Agent]) -> None:
    """Some servers send an empty text in place of {}."""
    asked = player(lambda r: {"tool_calls": [{"function": {"name": "stop", "arguments": ""}}]})
    asked.reset(brief())
    assert asked.act(Playground(dict(PLACES), dict(VALUES)).decision()) == Action(STOP) and not asked.fallback


def test_a_wrong_key_ends_the_episode(server: ScriptedServer) -> None:
    asked = agent(f"{EXAMPLE}:ToolsAgent:base_url={server.address},model=401")
    asked.reset(brief())
    with pytest.raises(RefusedError, match="refused with status 401"):
        asked.act(Playground(dict(PLACES), dict(VALUES)).decision())


def test_it_plays_in_a_room(
    player: Callable[[Answer], Agent], server: ScriptedServer, capsys: pytest.CaptureFixture[str]
) -> None:
    """It looks around, and then stops, so that the episode is short."""
    asked: list[dict[str, Any]] = []

    def answer(request: dict[str, Any]) -> dict[str, Any]:
        asked.append(request)
        return call("look" if len(asked) == 1 else "stop")

    player(answer)
    assert main(["play", "-s", "1", "-a", f"{EXAMPLE}:ToolsAgent:base_url={server.address},model=greedy"]) == 0
    assert re.search(r"ToolsAgent:\S+ rescued 0 of \d+ targets .*\(stopped\)", capsys.readouterr().out)
    assert len(asked) == 2
