"""The bridge with the simulator behind it, and without anything of ours on the other side."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.lerobot.environment import RobotEnv
from hazard_ms.lerobot.hazard_client import RemoteEnv
from tests.lerobot.bridge.serving import CLIENT, copied, serving
from tests.lerobot.bridge.stand_in import equal

SETTINGS = {"task": "HazardFire-v1", "split": "test", "side": 64, "every": 3, "max_frames": 9, "cameras": ["wrist"]}
OURS = ("torch", "sapien", "mani_skill", "hazard_ms")


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with serving("--sessions", "1", "--load", "hazard_ms.tasks.practice") as address:
        yield address


@pytest.mark.render
def test_episodes_through_the_bridge_are_those_without_it(address: str) -> None:
    """Spaces, observations, rewards and infos, bit by bit, in two scenes, one of which no seed chose."""
    alone, env = RobotEnv(**SETTINGS), RemoteEnv(server=address, **SETTINGS)
    assert env.observation_space == alone.observation_space and env.action_space == alone.action_space
    assert env.metadata == alone.metadata and env._max_episode_steps == alone._max_episode_steps == 3
    assert env.task_description == alone.task_description == env.task
    chance = np.random.default_rng(0)
    for options in ({"lerobot_new_rollout": True}, {"scene": "kitchen_a/03"}):
        begun = [each.reset(seed=11, options=options) for each in (alone, env)]
        equal(*(dict(enumerate(told)) for told in begun))
        for _ in range(3):
            action = chance.uniform(-0.3, 0.3, env.action_space.shape).astype(np.float32)
            stepped = [each.step(action) for each in (alone, env)]
            equal(*(dict(enumerate(told)) for told in stepped))
        assert set(stepped[1][0]["pixels"]) == {"head", "wrist"}
        assert stepped[1][3] and stepped[1][0]["pixels"]["head"].std() > 10.0
    equal(alone.render(), env.render())
    with pytest.raises(ValueError, match=r"action must have shape .*, got \(3,\)"):
        env.step(np.zeros(3))
    alone.close()
    env.close()


@pytest.mark.render
def test_what_the_environment_refuses_arrives_in_its_words(address: str) -> None:
    for keywords, error, message in (
        ({"task": "HazardFier-v1"}, RuntimeError, "Environment `HazardFier` doesn't exist. Did you mean: `HazardFire`"),
        ({"side": 4}, ValueError, "side must be a whole number from 16 to 1024, got 4"),
    ):
        with pytest.raises(error, match=message):
            RemoteEnv(server=address, **keywords)


@pytest.mark.render
def test_modules_of_the_servers_own_choice_bring_tasks(address: str) -> None:
    env = RemoteEnv(server=address, task="HazardPickUp-v1", side=16, split="train")
    assert env.task_description == "Take the thing before you into your hand."
    env.close()


def test_the_client_is_one_file_that_needs_nothing_of_ours(tmp_path: Path) -> None:
    tree = ast.parse(CLIENT.read_text())
    named = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    named |= {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    roots = {name.split(".")[0] for name in named}
    assert roots - sys.stdlib_module_names == {"numpy", "gymnasium"} and "pickle" not in roots
    code = f"import sys, hazard_client; assert not set(sys.modules) & set({OURS!r}), sys.modules"
    subprocess.run([sys.executable, "-c", code], cwd=copied(tmp_path), check=True, timeout=60)
