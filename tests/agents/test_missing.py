"""Targets that are no longer where they were seen: agents go for others, and look around where they missed one."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hazard_ms.agents.base import agent, known
from hazard_ms.agents.planner import Planner
from hazard_ms.agents.teams.joint import Joint
from hazard_ms.skills.decision import EXPLORE, WALK_TO, Action
from tests.worlds.playground import Playground, brief

PLACES = {"gone": (1.5, 0.0), "there": (-2.5, 0.0)}


def lose(ground: Playground, name: str = "gone") -> None:
    """Mark on the map that a look has shown the thing's place without it."""
    index = ground.names.index(name)
    ground.remember(index, replace(ground.map.objects[index], missing=True))


@pytest.mark.parametrize("name", ["planner", "mcts:simulations=64", "greedy", "rule"])
def test_nobody_walks_to_where_a_thing_no_longer_is(name: str) -> None:
    """The lost one is nearer, and worth more."""
    ground = Playground(PLACES, {"gone": 9.0, "there": 3.0})
    player = agent(name)
    player.reset(brief())
    ground.do(player.act(ground.decision()))
    lose(ground)
    for _ in range(12):
        action = player.act(ground.decision())
        assert action.target != "gone", f"{action} by {name}"
        ground.do(action)
        lose(ground)  # looks of the playground show everything
        if ground.rescued:
            break
    assert ground.rescued == {"there"}


def test_who_arrives_where_a_thing_no_longer_is_looks_around_instead_of_reaching_for_it() -> None:
    ground = Playground({"gone": (1.5, 0.0)}, {"gone": 5.0})
    player = Planner()
    player.reset(brief())
    ground.do(player.act(ground.decision()))
    walk = player.act(ground.decision())
    assert walk == Action(WALK_TO, "gone")
    ground.do(walk)
    assert ground.decision().walked_up_to == "gone"
    lose(ground)
    assert player.act(ground.decision()) == Action(EXPLORE)


def test_what_is_missing_is_known_only_to_those_who_ask_for_it() -> None:
    ground = Playground(PLACES, dict.fromkeys(PLACES, 1.0))
    ground.look()
    lose(ground)
    assert list(known(ground.decision(), ("gone", "there"))) == ["there"]
    assert list(known(ground.decision(), ("gone", "there"), missing=True)) == ["gone", "there"]


def test_a_team_is_not_told_of_what_is_missing() -> None:
    ground = Playground(PLACES, dict.fromkeys(PLACES, 1.0))
    team = Joint()
    team.reset({"fetch-0": brief(), "fetch-1": brief()})
    ground.do(Action(EXPLORE))
    lose(ground)
    told = team.act({"fetch-0": ground.decision()})["fetch-0"]
    assert told.target == "there"
