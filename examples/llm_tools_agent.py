"""An agent of your own that asks a language model with tools: it calls fetch(thing), look() or stop(), not a letter.

    export HAZARD_MS_LLM_BASE_URL=http://127.0.0.1:8000/v1 HAZARD_MS_LLM_MODEL=my-model
    hazard-ms play --agent examples/llm_tools_agent.py:ToolsAgent --output tools.mp4

The client, the situation in words and the options are those of the agent `llm`: docs/language_models.md tells of them.
"""

from __future__ import annotations

import json
from typing import Any

from hazard_ms import Action, Agent
from hazard_ms.agents.llm.choices import LETTERS, MACRO, SEARCH, Choice, forced, menu
from hazard_ms.agents.llm.client import Client
from hazard_ms.agents.llm.endpoint import endpoint
from hazard_ms.agents.llm.memory import Memory
from hazard_ms.agents.llm.network.faults import NoAnswerError
from hazard_ms.agents.llm.prompt import messages, system_text
from hazard_ms.agents.llm.scene_text import block, plain_names
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, Decision

ASK = 'Do so by one function call: the option "fetch mug_1" is fetch(thing="mug_1").'
GIVE_UP = 4  # failures with a thing after which it is no longer an option
DEADLINE = 50.0  # for an answer [s]

Call = tuple[str, str | None]  # the name of a function, and the thing that it is called with


class ToolsAgent(Agent):
    """Lets a model choose by a function call what to go for; what follows from that is done without asking."""

    colours = False

    def __init__(self, base_url: str = "", model: str = "") -> None:
        """`base_url`, `model`: of the server; else those of the environment."""
        self.client = Client(endpoint(base_url, model), tries=3, seed=0)
        self.client.greet()

    def reset(self, brief: Brief) -> None:
        """Begin an episode."""
        self.brief, self.memory = brief, Memory(brief.random_seed)

    def act(self, decision: Decision) -> Action:
        """Pick up what was walked up to, put away what is held, look around at places to search; else ask."""
        self.memory.note(decision)
        self.note, self.fallback = "follows by itself", False
        action = Action(EXPLORE) if self.memory.arrived_to_search(decision) else forced(decision)
        if action is not None:
            self.memory.chose(decision, action, str(action), search=False)
            return action
        failures, visits = self.memory.believed.failures, self.memory.believed.visits
        on_offer = menu(decision, failures, visits, GIVE_UP, MACRO, len(LETTERS))
        told = block(self.brief, decision, self.memory, on_offer)
        names = plain_names(decision.names)
        choice = self.ask(told, {(c.move.replace(" ", "_"), names.get(c.thing or "")): c for c in on_offer.choices})
        self.memory.chose(decision, choice.action, told["options"][choice.letter], search=choice.move == SEARCH)
        return choice.action

    def ask(self, told: dict[str, Any], choices: dict[Call, Choice]) -> Choice:
        """The choice that the model calls for; the first one where it calls for none of them."""
        asked, _ = messages("llm-1", system_text(self.brief, macro=True), told, ASK)
        request = {"model": self.client.endpoint.model, "messages": asked, "tools": tools(choices)}
        try:
            call = called(self.client.ask(request, DEADLINE))
            choice = choices[call]
            self.note = f"called {call[0]}({call[1] or ''})"
        except (NoAnswerError, LookupError, TypeError, AttributeError, ValueError, RecursionError) as error:
            choice, self.fallback = next(iter(choices.values())), True
            self.note = f"no function on offer was called, so the first option: {type(error).__name__}: {error}"
        return choice


def tools(choices: dict[Call, Choice]) -> list[dict[str, Any]]:
    """One function for each kind of choice, with the names of the things that it can be called with."""
    things: dict[str, list[str]] = {}
    for name, thing in choices:
        things.setdefault(name, []).extend([] if thing is None else [thing])
    made = []
    for name, enum in things.items():
        properties = {"thing": {"type": "string", "enum": enum}} if enum else {}
        parameters = {"type": "object", "properties": properties, "required": list(properties)}
        made.append({"type": "function", "function": {"name": name, "parameters": parameters}})
    return made


def called(answer: dict[str, Any]) -> Call:
    """The first function call of a chat completion. Raises one of many errors for an answer without one."""
    function = answer["choices"][0]["message"]["tool_calls"][0]["function"]
    return function["name"], json.loads(function["arguments"] or "{}").get("thing")
