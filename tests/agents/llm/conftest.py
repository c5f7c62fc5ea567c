"""A scripted server, and a playground in which a model has much to decide."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from hazard_ms.agents.llm.agent import Llm
from hazard_ms.agents.llm.scripted import ScriptedServer
from hazard_ms.skills.executor import SkillEnv
from tests.worlds.playground import Playground

THINGS = {"mug": (2.0, 0.0), "book": (0.0, 2.5), "stone": (1.0, -2.0), "far": (6.0, 0.0), "shelf": (4.5, 0.5)}
VALUES = {"mug": 1.0, "book": 5.0, "stone": 5.0, "far": 1.0}

Made = Callable[..., Llm]


@dataclasses.dataclass
class Ground(Playground):
    """The playground above: one thing cannot be walked to, and one is far away."""

    places: dict[str, tuple[float, float]] = dataclasses.field(default_factory=lambda: dict(THINGS))
    values: dict[str, float] = dataclasses.field(default_factory=lambda: dict(VALUES))
    broken: frozenset[str] = frozenset({"stone"})


@pytest.fixture(scope="session")
def env() -> Iterator[SkillEnv]:
    """One environment for all tests that need the simulator."""
    made = SkillEnv.make("HazardFire-v1")
    yield made
    made.close()


@pytest.fixture
def server() -> Iterator[ScriptedServer]:
    running = ScriptedServer().start()
    yield running
    running.stop()


@pytest.fixture
def llm(server: ScriptedServer) -> Made:
    """Makes an agent that asks a model of the server, by its name."""

    def made(model: str = "greedy", **parameters: Any) -> Llm:
        return Llm(base_url=server.address, model=model, **parameters)

    return made
