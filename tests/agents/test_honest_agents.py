"""No agent but the privileged can reach what is hidden: it decides alike after the simulation's state was wiped out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest
import torch

from hazard_ms.agents.base import Agent, agent
from hazard_ms.agents.learned import players
from hazard_ms.env import HazardEnv
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, WALK_TO, Action, Decision
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec.registry import AGENTS, load
from tests.worlds.policies import ship

HONEST = sorted(name for name, entry in AGENTS.items() if not load(entry.agent).privileged)
TASKS = ["HazardFire-v1", pytest.param("HazardFlood-v1", marks=pytest.mark.long)]
TASKS.append(pytest.param("HazardWind-v1", marks=pytest.mark.long))
DECISIONS = 3  # of an episode in which the agents are asked


class Cheat(Agent):
    """An agent that looks into the simulation: it walks to what is farthest along x."""

    def __init__(self, env: HazardEnv) -> None:
        self.env = env

    def reset(self, brief: Brief) -> None:
        return

    def act(self, decision: Decision) -> Action:
        """The thing with the greatest x, which is the first where none has one."""
        x = self.env.world.position[0, :, 0].nan_to_num(-torch.inf)
        return Action(WALK_TO, decision.names[int(x.argmax())])


def wipe(holder: object) -> int:
    """Overwrite all tensors of an object: numbers by NaN or 0, truth by its opposite. Returns how many there are."""
    tensors = [value for value in vars(holder).values() if isinstance(value, torch.Tensor)]
    for value in tensors:
        if value.is_floating_point():
            value.fill_(torch.nan)
        elif value.dtype == torch.bool:
            value.logical_not_()
        else:
            value.zero_()
    return len(tensors)


def wipe_out(env: HazardEnv) -> None:
    """Overwrite all that the simulation knows of the present: bodies, hazards, damage, rescues, hand, and chance."""
    counts = [wipe(holder) for holder in (env.world, env.world.chance, *env.episode.parts.values())]
    assert min(counts) > 0 and sum(counts) > 25, "there is less to wipe out than there was"
    assert bool(env.world.position.isnan().all())


@dataclass
class Asked:
    """What the agents were asked in one episode, and what each chose while the simulation was as it is."""

    env: HazardEnv
    brief: Brief
    decisions: list[Decision]
    chosen: dict[str, list[Action]]
    cheated: list[Action]


def choices(player: Agent, brief: Brief, decisions: list[Decision]) -> list[Action]:
    """What an agent chooses at each of the decisions of an episode."""
    player.reset(brief)
    return [player.act(decision) for decision in decisions]


@pytest.fixture(scope="module", autouse=True)
def _weights(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Learned agents have policies for every task, though untrained ones."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(players, "SHIPPED", ship(tmp_path_factory.mktemp("weights")))
        yield


@pytest.fixture(scope="module", params=TASKS)
def asked(request: pytest.FixtureRequest) -> Iterator[Asked]:
    """Looks around, then walks to the first things on the map; at each decision every agent is asked."""
    env = SkillEnv.make(request.param, obs_mode="none")
    decision, _ = env.reset(seed=3)
    brief = env.brief()
    players = {**{name: agent(name) for name in HONEST}, "": Cheat(env.base)}
    for player in players.values():
        player.reset(brief)
    made = Asked(env.base, brief, [], {name: [] for name in HONEST}, [])
    for number in range(DECISIONS):
        made.decisions.append(decision)
        for name, player in players.items():
            (made.chosen[name] if name else made.cheated).append(player.act(decision))
        if number < DECISIONS - 1:
            known = [t.name for t in decision.targets if t.index in decision.map.objects]
            action = Action(WALK_TO, known[number % len(known)]) if number and known else Action(EXPLORE)
            decision = env.step(action)[0]
    wipe_out(env.base)
    yield made
    env.close()


@pytest.mark.parametrize("name", HONEST)
def test_an_agent_decides_by_what_it_is_told_alone(asked: Asked, name: str) -> None:
    assert choices(agent(name), asked.brief, asked.decisions) == asked.chosen[name]


def test_an_agent_that_cheats_is_found_out(asked: Asked) -> None:
    assert choices(Cheat(asked.env), asked.brief, asked.decisions) != asked.cheated


def test_what_was_decided_on_is_worth_deciding(asked: Asked) -> None:
    """The agents saw targets, levels of the hazard and a floor, so that there was something to reach for."""
    last = asked.decisions[-1]
    assert last.frame > 60 and len(last.map.objects) > 5
    assert any(target.index in last.map.objects for target in last.targets)
    assert all(np.isfinite(sighting.position).all() for sighting in last.map.objects.values())
    assert {action.verb for actions in asked.chosen.values() for action in actions} >= {EXPLORE, WALK_TO}
