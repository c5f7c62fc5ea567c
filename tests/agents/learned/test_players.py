"""The agents `bc` and `rl`: they play the options that their policies choose."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from hazard_ms.agents.base import Agent, agent
from hazard_ms.agents.learned import players
from hazard_ms.skills.decision import DROP, Action
from tests.worlds.playground import Playground, brief
from tests.worlds.policies import ship, stored, stored_map

PLACES = {"mug": (2.0, 0.0), "book": (0.0, 1.5), "shelf": (2.5, 1.0), "hidden": (4.5, 2.0)}


def untrained(folder: Path) -> Agent:
    """The agent with a policy that was never trained, at the beginning of an episode."""
    player = agent(f"bc:weights={stored(folder / 'one.safetensors')}")
    player.reset(brief())
    return player


def played(folder: Path, ground: Playground, most: int = 60) -> list[Action]:
    """The actions of the agent until everything is safe."""
    player, made = untrained(folder), list[Action]()
    while len(ground.rescued) < len(ground.values) and len(made) < most:
        made.append(player.act(ground.decision()))
        ground.do(made[-1])
    return made


def test_it_rescues_what_it_knows(tmp_path: Path) -> None:
    """Whatever its policy prefers, only what can be done is done, and it does not stop before."""
    ground = Playground(dict(PLACES), {"mug": 5.0, "book": 1.0})
    ground.look()
    played(tmp_path, ground)
    assert ground.rescued == {"mug", "book"}


def test_it_gives_up_what_cannot_be_picked_up(tmp_path: Path) -> None:
    ground = Playground(dict(PLACES), {"mug": 5.0, "book": 1.0}, slippery=frozenset({"mug"}))
    ground.look()
    made = played(tmp_path, ground)
    assert ground.rescued == {"book"}
    assert sum(action == Action("pick_up", "mug") for action in made) <= 4


def test_what_is_in_the_hand_goes_into_the_bag(tmp_path: Path) -> None:
    ground = Playground(dict(PLACES), {"mug": 5.0})
    ground.look()
    ground.held = "mug"
    player = untrained(tmp_path)
    assert player.act(ground.decision()) == Action(DROP) and player.note == "into the bag"


def test_by_the_six_actions_it_rescues_what_it_knows_sooner_or_later(tmp_path: Path) -> None:
    """Untrained, that is by chance; it is the same chance in every episode of a seed."""
    from tests.worlds.playground import play

    made = []
    for _ in range(2):
        ground = Playground(dict(PLACES), {"mug": 5.0, "book": 1.0})
        ground.look()
        player = agent(f"rl_paper:weights={stored_map(tmp_path / 'map.safetensors')}")
        made.append(play(player, ground, seed=3))
        assert ground.rescued == {"mug", "book"} and player.counters["impossible"] > 5
        assert player.note in ("to_target", "pick_up", "drop", "explore", "wander")
    assert made[0] == made[1]
    masked = agent(f"rl_paper:weights={stored_map(tmp_path / 'map.safetensors', masked=True)}")
    play(masked, Playground(dict(PLACES), {"mug": 5.0}), seed=3)
    assert masked.counters == {"impossible": 0.0}


COMMANDS = [("bc", "train bc"), ("rl", "train ppo"), ("rl_paper", "train ppo --actions paper")]


@pytest.mark.parametrize(("name", "command"), COMMANDS)
def test_without_weights_it_says_how_to_make_them(
    name: str, command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    player = agent(f"{name}:weights={tmp_path / 'none.safetensors'}")
    with pytest.raises(ValueError, match=rf"none.safetensors must hold a policy for HazardFire-v1: .*{command} -e"):
        player.reset(brief())
    monkeypatch.setattr(players, "SHIPPED", tmp_path)
    with pytest.raises(ValueError, match=f"none are shipped for HazardFire-v1: .*{command} -e HazardFire-v1"):
        agent(name).reset(brief())


@pytest.mark.parametrize("name", ["bc", "rl", "rl_paper"])
def test_weights_of_the_package_are_found_by_task(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(players, "SHIPPED", ship(tmp_path))
    ground = Playground(dict(PLACES), {"mug": 5.0})
    ground.look()
    shipped, given = agent(name), agent(f"{name}:weights={tmp_path / f'{name}_HazardFire-v1.safetensors'}")
    for player in (shipped, given):
        player.reset(brief())
    assert shipped.act(ground.decision()) == given.act(ground.decision())
    (tmp_path / f"{name}_HazardFire-v1.safetensors").unlink()
    with pytest.raises(ValueError, match="none are shipped for HazardFire-v1"):
        agent(name).reset(brief())


@pytest.mark.parametrize("name", ["rl", "rl_paper"])
def test_a_policy_for_other_hazards_is_refused(name: str, tmp_path: Path) -> None:
    store = stored_map if name == "rl_paper" else stored
    player, told = agent(f"{name}:weights={store(tmp_path / 'one.safetensors')}"), brief()
    player.reset(told)
    with pytest.raises(ValueError, match=r"as many hazards as the episode has \(fire, fire\), got one for 1"):
        player.reset(dataclasses.replace(told, hazards=told.hazards * 2))
