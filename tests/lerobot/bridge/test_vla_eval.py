"""Our benchmark for vla-eval: with a stub of what it uses of vla-eval, and with vla-eval itself where it is.

HAZARD_MS_VLA_EVAL_PYTHON names the Python of an environment with vla-eval and gymnasium.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hazard_ms.lerobot import hazard_client
from tests.lerobot.bridge.serving import EXAMPLES, copied
from tests.lerobot.bridge.stand_in import StandIn, admitting, equal
from tests.worlds.registering import loaded

PYTHON = os.environ.get("HAZARD_MS_VLA_EVAL_PYTHON", "")
BOTH = ["HazardFire-v1", "HazardFlood-v1"]


class Recorder:
    """Keeps what is recorded."""

    def __init__(self) -> None:
        self.pictures: list[Any] = []
        self.steps: list[dict[str, Any]] = []

    def record_video(self, picture: Any) -> None:
        self.pictures.append(picture)

    def record_step(self, **fields: Any) -> None:
        self.steps.append(fields)


class Base:
    """Stands for StepBenchmark, whose runners give it a recorder with each episode."""

    def __init__(self) -> None:
        self._recorder = Recorder()


@pytest.fixture
def example(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    base, specs = ModuleType("vla_eval.benchmarks.base"), ModuleType("vla_eval.specs")
    base.__dict__.update(StepBenchmark=Base, StepResult=SimpleNamespace)
    specs.__dict__.update(IMAGE_RGB="rgb", LANGUAGE="words", DimSpec=lambda *given, **named: given)
    for module in (ModuleType("vla_eval"), ModuleType("vla_eval.benchmarks"), base, specs):
        monkeypatch.setitem(sys.modules, module.__name__, module)
    monkeypatch.setitem(sys.modules, "hazard_client", hazard_client)
    with loaded(EXAMPLES / "hazard_vla_eval.py") as made:
        yield made


def test_its_four_methods_play_episodes_of_the_seeds(example: Any) -> None:
    with admitting(1) as address:
        made = example.HazardBenchmark(tasks=BOTH, seed=40, server=address, side=20)
        assert made.get_action_spec()["joints"][1] == 2 and made.get_observation_spec()["state"][1] == 4
        assert made.get_tasks() == [{"name": name} for name in BOTH] and made.get_metadata() == {"max_steps": None}
        for name, words in zip(BOTH, ("Stand in.", "Stand in water."), strict=True):
            task, alone = {"name": name, "episode_idx": 2}, StandIn(side=20)
            seen, (here, _) = made.reset(task), alone.reset(seed=42)
            for done in (False, False, True):
                told = made.make_obs(seen, task)
                equal(told.pop("state"), here["agent_pos"])
                equal(told.pop("images"), here["pixels"])
                assert told == {"task_description": words}
                result = made.step({"actions": np.array([[0.1, -0.2]])})
                here, reward, *_ = alone.step(np.float32([0.1, -0.2]))
                seen = result.obs
                assert (result.reward, result.done) == (reward, done)
            assert made.get_step_result(result) == {"success": True, "value": 1 / 3}
        assert len(made._recorder.pictures) == 8 and len(made._recorder.steps) == 6
        assert set(made._recorder.steps[0]) == made._ALL_RECORD_FIELDS
        made._made._leave()  # as after an answer that came too late
        assert made.reset(task) is not None
        made.cleanup()


RUN = f"""
import json, sys
import numpy as np
from vla_eval.api import evaluate
from vla_eval.model_servers.predict import PredictModelServer

class Still(PredictModelServer):
    def predict(self, obs, ctx):
        assert obs["images"]["head"].shape == (20, 20, 3) and obs["state"].shape == (4,)
        return {{"actions": np.float32([0.1, -0.2])}}
    def get_action_spec(self):
        return {{}}
    get_observation_spec = get_action_spec

params = {{"server": sys.argv[1], "side": 20, "tasks": {BOTH!r}}}
entry = {{"benchmark": "hazard_vla_eval:HazardBenchmark", "episodes_per_task": 2, "params": params}}
print("FOUND", json.dumps(evaluate(Still(), {{"benchmarks": [entry]}}, output_dir="results"), default=str))
"""


@pytest.mark.skipif(not PYTHON, reason="vla-eval is not there: HAZARD_MS_VLA_EVAL_PYTHON")
def test_vla_eval_itself_evaluates_a_model(tmp_path: Path) -> None:
    with admitting(1) as address:
        done = subprocess.run(
            [PYTHON, "-c", RUN, address], cwd=copied(tmp_path), capture_output=True, text=True, timeout=200
        )
    assert done.returncode == 0, done.stderr[-3000:]
    found = json.loads(done.stdout.split("FOUND ")[1].splitlines()[0])[0]
    assert [task["task"] for task in found["tasks"]] == BOTH
    assert [episode["steps"] for task in found["tasks"] for episode in task["episodes"]] == [3] * 4
    assert found["mean_success"] == 1.0 and round(found["mean_value"], 4) == 0.3333 and not found["num_errors"]
