"""The policies that the package brings: small, readable without a learner, and as good in the sketch as they were."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hazard_ms.agents.base import agent
from hazard_ms.agents.learned.players import SHIPPED
from hazard_ms.agents.learned.weights import ENDING, load, load_map, sees_map
from hazard_ms.spec.registry import TASKS
from tests.worlds.playground import Playground, brief

FILES = sorted(SHIPPED.glob(f"*{ENDING}"))
BROUGHT = [
    *("bc_HazardFire-v1", "bc_HazardFlood-v1", "bc_HazardWind-v1"),
    *("rl_HazardFire-v1", "rl_HazardFlood-v1", "rl_HazardWind-v1"),
    *("rl_paper_HazardFire-v1", "rl_paper_HazardFlood-v1"),
]
MOST = {"bc": 60, "rl": 60, "rl_paper": 1000}  # decisions in which two targets are rescued
LARGEST = 1_500_000  # of all files together [bytes]


def task_of(path: Path) -> str:
    return path.stem.rpartition("_")[2]


def test_they_are_small_and_named_by_agent_and_task() -> None:
    assert [path.stem for path in FILES] == BROUGHT
    assert sum(path.stat().st_size for path in SHIPPED.glob("*")) < LARGEST
    assert {path.suffix for path in SHIPPED.glob("*")} == {ENDING, ".json"}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_their_agents_play_at_once(path: Path) -> None:
    """Agents find those of the package by task, and rescue what they know."""
    name, task = path.stem.rsplit("_", 1)
    ground = Playground({"mug": (2.0, 0.0), "book": (0.0, 1.5)}, {"mug": 5.0, "book": 1.0})
    ground.look()
    player = agent(name)
    player.reset(brief(task))
    for _ in range(MOST[name]):
        if len(ground.rescued) < 2:
            ground.do(player.act(ground.decision()))
    assert ground.rescued == {"mug", "book"}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_their_facts_are_those_of_their_training(path: Path) -> None:
    told = json.loads(path.with_suffix(".json").read_text())
    cloned = path.stem.startswith("bc_")
    command = f"hazard-ms train {'bc' if cloned else 'ppo'} -e {task_of(path)} "
    assert told["command"].startswith(command) and task_of(path) in TASKS
    if cloned:
        best = max(told["rounds"], key=lambda each: each["student"])
        assert best["student"] > best["greedy"]
        return
    # in the sketch options are better than the plain rule; the six actions have at least what the paper's learner had
    least = told["best"]["greedy"] if path.stem.startswith("rl_Hazard") else 0.461
    assert told["best"]["validation"] > least


@pytest.mark.long
@pytest.mark.timeout(900)
@pytest.mark.parametrize(
    "path", [path for path in FILES if path.stem.startswith("rl_Hazard")], ids=lambda path: path.stem
)
def test_they_reproduce_the_score_that_was_kept_with_them(path: Path) -> None:
    from hazard_ms.learning.ppo import FEW, value_of
    from hazard_ms.sketch.scenes import more_scenes
    from hazard_ms.sketch.skill_times import load as times_of

    told = json.loads(path.with_suffix(".json").read_text())
    scenes = more_scenes(task_of(path), told["physics"], told["validation"], FEW)
    policy = load_map(path, task_of(path)) if sees_map(path) else load(path, task_of(path))
    found = value_of(policy, scenes, times_of("fetch"))
    assert found == pytest.approx(told["value"], abs=1e-6)
