"""Agents open the door of practice by their own skill, are scored, and demonstrate it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from hazard_ms.agents.base import PrivilegedAgent, agent
from hazard_ms.cli.__main__ import main
from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.demonstrations.reading import entries
from hazard_ms.demonstrations.recording import RecordJob, attempt, line
from hazard_ms.evaluation.options import EnvOptions, EpisodeOptions
from hazard_ms.lerobot import ENV_ID
from hazard_ms.skills.executor import SkillEnv
from tests.worlds.registering import practising

pytestmark = pytest.mark.render
TASK, MODULE = "HazardOpenDoor-v1", "hazard_ms.tasks.practice"


@pytest.fixture(scope="module", autouse=True)
def practice() -> Iterator[Any]:
    with practising() as module:
        yield module


def successes(split: str, name: str, seeds: range, **keywords: Any) -> int:
    """The number of episodes in which the agent called `name` opened the door."""
    env, count = SkillEnv.make(TASK, split=split, **keywords), 0
    for seed in seeds:
        decision, _ = env.reset(seed=seed)
        player = agent(name)
        if isinstance(player, PrivilegedAgent):
            player.attach(env)
        player.reset(env.brief())
        over = False
        while not over:
            action = player.act(decision)
            decision, _, terminated, truncated, info = env.step(action)
            over = terminated or truncated
        count += bool(info["success"][0])
    env.close()
    return count


def test_agents_open_doors_in_calm_and_beside_a_fire() -> None:
    """Random opens it by chance, as one of its moves."""
    assert successes("train", "oracle", range(2)) == 2
    assert successes("test", "greedy", range(2), hazards=["fire"]) == 2
    assert successes("test", "random", range(3)) >= 1
    assert successes("test", "planner", range(2)) == 2
    assert successes("test", "rule", range(1)) == 1
    assert successes("test", "llm:base_url=scripted,model=mitigates", range(1)) == 1


@pytest.mark.long
@pytest.mark.parametrize("split", ["train", "test"])
def test_the_oracle_opens_nearly_every_door(split: str) -> None:
    """Measured: 25 of 25 in both."""
    assert successes(split, "oracle", range(25)) >= 24


def test_the_oracle_demonstrates_it_and_is_scored(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The joint actions of the demonstration open the door again in the environment that LeRobot's tools play."""
    episode = EpisodeOptions(env_id=TASK, agent="oracle", seed=4, load=(MODULE,))
    options = RecordOptions(EnvOptions(env_id=TASK, load=(MODULE,)), output=tmp_path / "demos")
    options.dataset.mkdir(parents=True)
    outcome = attempt(RecordJob(episode, 600.0, record=options), lambda word: None)
    assert not outcome.error and outcome.result is not None and outcome.result.ended == "door open"
    (folder,) = [path for path in options.dataset.iterdir() if path.is_dir()]
    made = json.loads((folder / "episode.json").read_text())
    frames = np.load(folder / "frames.npz")
    (entry,) = entries(options.dataset)
    assert line(options.dataset, entry, options.env.goal).startswith(f"{folder.name}: succeeded (door open), ")
    assert made["reason"] == "" and made["subtasks"][-1] == "open door_0" and bool(frames["success"][-1])

    env = gym.make(ENV_ID, task=f"{MODULE}:{TASK}", side=64, every=1, split="train")
    env.reset(seed=4, options={"scene": made["result"]["scene"]})
    for action in frames["action"]:
        _, _, terminated, _, info = env.step(action)
        if terminated:
            break
    assert info["is_success"]
    env.close()

    asked = ["evaluate", "-e", TASK, "--load", MODULE, "--agents", "oracle", "--episodes", "1", "--backend", "serial"]
    assert main([*asked, "-o", str(tmp_path / "scores")]) == 0
    (path,) = [p for p in (tmp_path / "scores").rglob("*.json") if "door open" in p.read_text()]
    assert json.loads(path.read_text())["decisions"][0]["verb"] == "open"
    printed = capsys.readouterr().out
    assert "1/1 oracle succeeded in practice/100" in printed and "oracle: succeeded in 1 of 1 episodes" in printed
