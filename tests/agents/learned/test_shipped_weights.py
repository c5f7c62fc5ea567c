"""Whatever policies the package brings: small, readable without a learner, and as good in the sketch as they were."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hazard_ms.agents.learned.players import SHIPPED
from hazard_ms.agents.learned.weights import ENDING, load, load_map, sees_map
from hazard_ms.registry import TASKS

FILES = sorted(SHIPPED.glob(f"*{ENDING}"))
LARGEST = 1_500_000  # of all files together [bytes]


def task_of(path: Path) -> str:
    return path.stem.rpartition("_")[2]


def test_they_are_small_and_named_by_agent_and_task() -> None:
    assert sum(path.stat().st_size for path in SHIPPED.glob("*")) < LARGEST
    assert {path.suffix for path in SHIPPED.glob("*")} <= {ENDING, ".json"}
    for path in FILES:
        assert path.stem.rpartition("_")[0] in ("bc", "rl", "rl_paper") and task_of(path) in TASKS
        policy = load_map(path, task_of(path)) if sees_map(path) else load(path, task_of(path))
        assert policy.shape.ranges


@pytest.mark.long
@pytest.mark.timeout(900)
@pytest.mark.parametrize("path", [path for path in FILES if path.stem.startswith("rl_")], ids=lambda path: path.stem)
def test_they_reproduce_the_score_that_was_kept_with_them(path: Path) -> None:
    from hazard_ms.learning.ppo import FEW, value_of
    from hazard_ms.sketch.scenes import more_scenes
    from hazard_ms.sketch.skill_times import load as times_of

    told = json.loads(path.with_suffix(".json").read_text())
    scenes = more_scenes(task_of(path), told["physics"], told["validation"], FEW)
    policy = load_map(path, task_of(path)) if sees_map(path) else load(path, task_of(path))
    found = value_of(policy, scenes, times_of("fetch"))
    assert found == pytest.approx(told["value"], abs=1e-6)
