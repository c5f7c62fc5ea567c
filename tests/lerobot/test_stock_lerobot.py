"""LeRobot itself, unchanged: it trains on an export and evaluates in our environment, and replays succeed as recorded.

`HAZARD_MS_LEROBOT=1 ./run test --long` brings it; HAZARD_MS_LEROBOT_PYTHON names the Python of another environment.
"""

from __future__ import annotations

import json
import os
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.demonstrations.export import lerobot
from hazard_ms.demonstrations.export.source import Source
from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.demonstrations.reading import entries
from hazard_ms.demonstrations.recording import RecordJob, attempt
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.scenes.schema import to_json
from hazard_ms.scenes.splits import scene

PYTHON = os.environ.get("HAZARD_MS_LEROBOT_PYTHON", "")
pytestmark = [
    pytest.mark.long,
    pytest.mark.render,
    pytest.mark.skipif(not PYTHON, reason="LeRobot is not there: HAZARD_MS_LEROBOT=1 ./run test --long"),
]
ROOT = Path(__file__).parents[2]
SMALL = {  # so that a few steps take seconds
    "act": ("dim_model=64", "n_heads=2", "dim_feedforward=128", "chunk_size=8", "n_action_steps=8"),
    "diffusion": ("down_dims=[32,64]", "horizon=8", "n_action_steps=4", "num_train_timesteps=10"),
}
PLACE = ("--env.discover_packages_path=hazard_ms.lerobot", "--env.type=hazard", "--env.task=HazardFire-v1")


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a room in which one thing is to be rescued, and two demonstrations of that as a dataset."""
    home = tmp_path_factory.mktemp("lerobot")
    one = replace(scene("kitchen_a/03"), name="backpack", target_categories=("backpack",))
    (home / "backpack.json").write_text(to_json(one))
    options = RecordOptions(agent="oracle", keep=0.0, verify=False, every=1, obs="rgb", output=home / "demos")
    options.dataset.mkdir(parents=True)
    for seed in (0, 1):
        episode = EpisodeOptions(agent="oracle", seed=seed, scene=str(home / "backpack.json"))
        assert not attempt(RecordJob(episode, 600.0, record=options), lambda word: None).error
    assert [entry.value for entry in entries(options.dataset)] == [1.0, 1.0]  # both succeeded
    lerobot.write(Source(options.dataset), home / "set")
    return home


def run(command: str, home: Path, *words: str) -> str:
    """Run a command of LeRobot in `home`; returns what it prints."""
    env = {**os.environ, "HF_HUB_OFFLINE": "1", "HF_HOME": str(home / "hub"), "OMP_NUM_THREADS": "1"}
    env |= {"PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'tests/lerobot'}"}
    done = subprocess.run(
        [str(Path(PYTHON).with_name(command)), *words],
        cwd=home,
        env=env,
        capture_output=True,
        text=True,
        timeout=1800,
    )
    assert done.returncode == 0, done.stderr[-4000:]
    return done.stdout + done.stderr


def evaluated(home: Path, name: str, *words: str) -> dict[str, Any]:
    """What `lerobot-eval` finds out in two episodes of the room."""
    told = (*PLACE, f'--env.scenes=["{home / "backpack.json"}"]', "--eval.n_episodes=2", "--eval.batch_size=2")
    printed = run("lerobot-eval", home, *told, "--policy.device=cpu", "--seed=0", f"--output_dir={name}", *words)
    assert "does not have 'task_description'" not in printed
    found: dict[str, Any] = json.loads((home / name / "eval_info.json").read_text())
    return found


@pytest.mark.parametrize("kind", SMALL)
def test_a_policy_is_trained_on_our_data_and_evaluated_in_our_environment(home: Path, kind: str) -> None:
    words = ("--dataset.repo_id=hazard/backpack", f"--dataset.root={home / 'set'}", "--dataset.video_backend=pyav")
    words += (f"--policy.type={kind}", "--policy.device=cpu", "--policy.push_to_hub=false", "--wandb.enable=false")
    words += (*(f"--policy.{each}" for each in SMALL[kind]), "--policy.pretrained_backbone_weights=null")
    words += ("--batch_size=2", "--steps=2", "--num_workers=0", "--log_freq=1", "--eval_freq=0")
    assert "End of training" in run("lerobot-train", home, *words, f"--output_dir=trained-{kind}")
    policy = home / f"trained-{kind}" / "checkpoints" / "last" / "pretrained_model"
    found = evaluated(home, f"scored-{kind}", f"--policy.path={policy}", "--env.episode_length=5")
    assert found["overall"]["n_episodes"] == 2 and found["overall"]["pc_success"] == 0.0  # in five frames, by two steps
    assert len(list((home / f"scored-{kind}" / "videos").rglob("*.mp4"))) == 2


def test_demonstrations_that_are_played_again_succeed_as_they_did(home: Path) -> None:
    words = ("--policy.discover_packages_path=replaying", "--policy.type=replaying", f"--policy.data={home / 'set'}")
    found = evaluated(home, "replayed", *words, "--policy.push_to_hub=false", "--env.episode_length=300")
    assert found["overall"]["pc_success"] == 100.0
    seen = json.loads((home / "set" / "replayed.json").read_text())
    assert seen["apart"] == 0.0 and seen["rows"] > 100  # what the robot feels is what was recorded, bit by bit
    (words_of_task,) = seen["tasks"]
    assert words_of_task == lerobot_task(home / "set")


def lerobot_task(folder: Path) -> str:
    """The only task of a dataset."""
    import pyarrow.parquet as pq

    table = pq.read_table(folder / "meta/tasks.parquet").to_pydict()
    (text,) = next(column for column in table.values() if isinstance(column[0], str))
    return str(text)
