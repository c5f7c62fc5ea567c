"""What all agents of the paper have in common: their names, and that nothing missing from a decision stops them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hazard_ms.agents.base import agent, note_of
from hazard_ms.agents.paper.mcts import Mcts
from hazard_ms.skills.decision import EXPLORE, Action
from hazard_ms.spec.registry import AGENTS
from tests.worlds.playground import Playground, brief, play

NAMES = ("paper/greedy", "paper/rule", "paper/mcts", "paper/mcts_diff")


def test_they_are_registered_beside_our_own() -> None:
    assert set(NAMES) == {name for name in AGENTS if name.startswith("paper/")}
    assert {"greedy", "rule"} <= set(AGENTS) and type(agent("greedy")) is not type(agent("paper/greedy"))


def test_their_parameters_follow_the_name() -> None:
    made = agent("paper/mcts:value=false,simulations=3")
    assert isinstance(made, Mcts) and vars(made) != vars(agent("paper/mcts:value=true,simulations=3"))
    with pytest.raises(ValueError, match="simulations must be a whole number from 1 to 1000000, got 0"):
        agent("paper/mcts_diff:simulations=0")


@pytest.mark.parametrize("name", NAMES)
def test_they_look_around_where_they_know_nothing(name: str) -> None:
    ground = Playground({"a": (9.0, 0.0)}, {"a": 5.0})
    assert set(play(agent(name), ground)) == {Action(EXPLORE)} and ground.frame >= 1500


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("levels", [(), (float("nan"),)])
def test_they_play_without_levels_of_hazards(name: str, levels: tuple[float, ...]) -> None:
    """Where nothing renders there is no hazard image."""
    ground = Playground({"a": (1.0, 0.0), "b": (0.0, 2.0)}, {"a": 5.0, "b": 1.0}, sight=9.0)
    ground.look()
    ground.remember(0, replace(ground.map.objects[0], levels=levels))
    player = agent(name)
    play(player, ground, most=80)
    assert ground.rescued == {"a", "b"} and note_of(player)


@pytest.mark.parametrize("name", NAMES)
def test_a_new_episode_owes_nothing_to_the_last(name: str) -> None:
    def room() -> Playground:
        return Playground({"a": (1.0, 0.0), "b": (0.0, 2.0), "c": (-2.0, 1.0)}, {"a": 5.0, "b": 1.0, "c": 5.0})

    used = agent(name)
    play(used, room(), seed=9, most=5)
    assert play(used, room(), seed=4, most=15) == play(agent(name), room(), seed=4, most=15)
    assert brief(seed=9) != brief(seed=4)
