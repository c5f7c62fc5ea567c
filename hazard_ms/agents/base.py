"""The contract that every agent keeps, and the names by which agents are found.

A third party's agent needs no entry here: `agent("package.module:Class")` imports it.
"""

from __future__ import annotations

import abc
import importlib

import numpy as np

from hazard_ms.sensing.semantic_map import Sighting
from hazard_ms.skills.decision import Action, Decision
from hazard_ms.spec import Task

AGENTS = {  # as text, so that naming the agents imports none of them
    "random": "hazard_ms.agents.random:Random",
    "greedy": "hazard_ms.agents.greedy:Greedy",
}


class Agent(abc.ABC):
    """Chooses the next action from what has been seen. `note` may say why; it is shown with the decision and changes nothing."""

    note: str = ""

    @abc.abstractmethod
    def reset(self, task: Task, seed: int) -> None:
        """Begin an episode of `task`. An agent that draws lots draws them from `seed` alone."""

    @abc.abstractmethod
    def act(self, decision: Decision) -> Action:
        """The next action; called again when that has ended."""


def agent(name: str) -> Agent:
    """A new agent: one of `AGENTS`, or that of a third party as `package.module:Class`."""
    if name not in AGENTS and ":" not in name:
        raise ValueError(f"no agent is called {name!r}; there are {', '.join(sorted(AGENTS))}, or give package.module:Class")
    module_name, _, class_name = AGENTS.get(name, name).partition(":")
    if not module_name or not class_name:
        raise ValueError(f"agent {name!r}: package.module:Class has two halves; there are also {', '.join(sorted(AGENTS))}")
    try:
        module = importlib.import_module(module_name)
    except ModuleNotFoundError as missing:
        raise ValueError(f"agent {name!r}: there is no module {missing.name!r}") from missing
    made = getattr(module, class_name, None)
    if not (isinstance(made, type) and issubclass(made, Agent)):
        raise ValueError(f"agent {name!r}: {class_name!r} of {module_name} is no subclass of hazard_ms.agents.base.Agent")
    return made()


def distance(decision: Decision, sighting: Sighting) -> float:
    """Horizontal distance from the agent to a thing it has seen [m]."""
    return float(np.hypot(*(sighting.position[:2] - np.asarray(decision.agent_position))))


def known(decision: Decision, names: tuple[str, ...]) -> dict[str, Sighting]:
    """Those of `names` that were seen and are remembered, nearest first."""
    seen = {name: decision.map.objects[i] for name in names if (i := decision.index(name)) in decision.map.objects}
    return dict(sorted(seen.items(), key=lambda item: distance(decision, item[1])))


def open_targets(decision: Decision) -> tuple[str, ...]:
    """Names of the targets that are neither rescued nor in the hand."""
    return tuple(t.name for t in decision.targets if not t.rescued and t.name != decision.held)
