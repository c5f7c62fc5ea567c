"""The agent `bc`: plays the options that its policy chooses."""

from __future__ import annotations

from pathlib import Path

import pytest
import torch

from hazard_ms.agents.base import Agent, agent
from hazard_ms.agents.learned.set_policy import SetPolicy, Shape
from hazard_ms.agents.learned.weights import contents
from hazard_ms.skills.decision import DROP, Action
from tests.worlds.playground import Playground, brief

ME = "hazard_ms.agents.learned.bc:Bc"
PLACES = {"mug": (2.0, 0.0), "book": (0.0, 1.5), "shelf": (2.5, 1.0), "hidden": (4.5, 2.0)}


def untrained(folder: Path) -> Agent:
    """The agent with a policy that was never trained, at the beginning of an episode."""
    torch.manual_seed(0)
    packed, told = contents(SetPolicy(Shape(((20.0, 600.0),))), "HazardFire-v1", {})
    (folder / "one.safetensors").write_bytes(packed)
    (folder / "one.json").write_text(told)
    player = agent(f"{ME}:weights={folder / 'one.safetensors'}")
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


def test_without_weights_it_says_how_to_make_them(tmp_path: Path) -> None:
    player = agent(f"{ME}:weights={tmp_path / 'none.safetensors'}")
    with pytest.raises(ValueError, match=r"none.safetensors must hold a policy for HazardFire-v1: .*train bc"):
        player.reset(brief())
