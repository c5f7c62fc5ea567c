"""Whatever policies the package brings: small, readable without a learner, and as good in the sketch as they were."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hazard_ms.agents.learned.players import SHIPPED
from hazard_ms.agents.learned.weights import ENDING, load
from hazard_ms.registry import TASKS

FILES = sorted(SHIPPED.glob(f"*{ENDING}"))
LARGEST = 1_500_000  # of all files together [bytes]


def task_of(path: Path) -> str:
    return path.stem.partition("_")[2]


def test_they_are_small_and_named_by_agent_and_task() -> None:
    assert sum(path.stat().st_size for path in SHIPPED.glob("*")) < LARGEST
    assert {path.suffix for path in SHIPPED.glob("*")} <= {ENDING, ".json"}
    for path in FILES:
        assert path.stem.partition("_")[0] in ("bc", "rl") and task_of(path) in TASKS
        assert load(path, task_of(path)).shape.ranges


@pytest.mark.long
@pytest.mark.timeout(900)
@pytest.mark.parametrize("path", [path for path in FILES if path.stem.startswith("rl_")], ids=lambda path: path.stem)
def test_they_reproduce_the_score_that_was_kept_with_them(path: Path) -> None:
    from hazard_ms.learning.cloning import scores
    from hazard_ms.learning.playing import Player
    from hazard_ms.learning.ppo import FEW
    from hazard_ms.sketch.scenes import more_scenes
    from hazard_ms.sketch.skill_times import load as times_of

    told = json.loads(path.with_suffix(".json").read_text())
    scenes = more_scenes(task_of(path), told["physics"], told["validation"], FEW)
    found = scores(scenes, times_of("fetch"), Player(load(path, task_of(path))).play).mean()
    assert found == pytest.approx(told["value"], abs=1e-6)
