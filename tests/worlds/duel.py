"""A room with a dear thing and a cheap one, of which only one can be saved in time, and an agent that does as told."""

from __future__ import annotations

import dataclasses

from hazard_ms.agents.base import PrivilegedAgent
from hazard_ms.skills.actions import wait
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import STOP, Action, Decision
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec import AgentStart, Body, Room, SceneSpec, Task
from hazard_ms.tasks.fire import hazard_fire

TASK = "HazardDuel-v1"
FRAMES = 240  # of an episode: for one of the two things, but not after PAUSE
PAUSE = 140
DEAR, CHEAP = "book_1", "box_1"


def thing(name: str, y: float) -> Body:
    return Body(name, name.removesuffix("_1"), "plain_box", (7.2, y, 0.0), scale=(0.15, 0.15, 0.3), mass=0.4)


DUEL = SceneSpec(  # one thing to the left, worth 5, and one to the right, worth 1
    name="test/duel",
    room=Room((12.0, 12.0)),
    fixtures=(),
    bodies=(thing(DEAR, 7.4), thing(CHEAP, 4.6)),
    target_categories=("book", "box"),
    fires=((0.4, 0.4),),
    agent_start=AgentStart((6.0, 6.0), 0.0),
)


def duel(physics: str) -> Task:
    return dataclasses.replace(hazard_fire(physics), scenes=lambda split: (DUEL.name,), build=lambda name: DUEL)


class Scripted(PrivilegedAgent):
    """Takes given actions, and then stops; it may change what it is shown and wait before each of them."""

    def __init__(self, *actions: Action, pause: int = 0, fallback: bool = False) -> None:
        self._left, self.pause, self.fallback = [*actions], pause, fallback

    def attach(self, env: SkillEnv) -> None:
        self._env = env

    def reset(self, brief: Brief) -> None:
        return

    def act(self, decision: Decision) -> Action:
        pause, self.pause = self.pause, 0
        self._env.run(wait(self._env.stage, pause))
        return self._left.pop(0) if self._left else Action(STOP)
