"""LeRobot in an environment of its own, which has nothing of ours, plays through the bridge.

HAZARD_MS_LEROBOT_PYTHON names its Python: that of `HAZARD_MS_LEROBOT=1 ./run test --long`, or of a later LeRobot.
"""

from __future__ import annotations

import ast
import json
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from hazard_ms.lerobot.sizes import ACTIONS, FRAMES, STATES
from tests.lerobot.bridge.serving import CLIENT, EXAMPLES, copied, serving

PYTHON = os.environ.get("HAZARD_MS_LEROBOT_PYTHON", "")
PRESENT = pytest.mark.skipif(not PYTHON, reason="LeRobot is not there: HAZARD_MS_LEROBOT=1 ./run test --long")
SMALL = ("dim_model=64", "n_heads=2", "dim_feedforward=128", "chunk_size=8", "n_action_steps=8")
HUB = """
import sys
from lerobot.envs.utils import _call_make_env, _load_module_from_path, _normalize_hub_result
if __name__ == "__main__":
    module = _load_module_from_path(sys.argv[1], module_name="hub_env_you_hazard")
    made = _normalize_hub_result(_call_make_env(module, n_envs=2, use_async_envs=True, cfg=None))
    vector = made["hazard"][0]
    seen, _ = vector.reset(seed=[0, 1])
    assert seen["pixels"]["head"].shape == (2, 256, 256, 3) and seen["agent_pos"].shape == (2, 37)
    assert vector.call("task_description")[0].startswith("Put every target") and vector.call("_max_episode_steps")
    vector.close()
    assert not {"sapien", "mani_skill", "hazard_ms"} & set(sys.modules)
    print("PLAYED")
"""


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with serving("--sessions", "3") as address:
        yield address


def run(folder: Path, address: str, *words: str) -> str:
    """Run a program of LeRobot's environment in `folder`; returns what it prints."""
    env = {**os.environ, "HF_HUB_OFFLINE": "1", "HF_HOME": str(folder / "hub"), "OMP_NUM_THREADS": "1"}
    env |= {"PYTHONPATH": str(folder), "HAZARD_MS_SERVER": address}
    done = subprocess.run(words, cwd=folder, env=env, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr[-4000:]
    return done.stdout + done.stderr


@PRESENT
@pytest.mark.long
@pytest.mark.render
@pytest.mark.timeout(900)
def test_its_evaluation_plays_through_the_bridge(tmp_path: Path, address: str) -> None:
    policy = ("--policy.type=act", "--policy.device=cpu", "--policy.push_to_hub=false")
    policy += (*(f"--policy.{each}" for each in SMALL), "--policy.pretrained_backbone_weights=null")
    place = ("--env.discover_packages_path=hazard_lerobot", "--env.type=hazard_bridge", f"--env.server={address}")
    place += ("--env.side=64", "--env.fps=10", '--env.keywords={"max_frames": 12}')
    count = ("--eval.n_episodes=2", "--eval.batch_size=2", "--seed=0", "--output_dir=scored")
    told = run(copied(tmp_path), address, str(Path(PYTHON).with_name("lerobot-eval")), *policy, *place, *count)
    assert "does not have 'task_description'" not in told
    found = json.loads((tmp_path / "scored" / "eval_info.json").read_text())
    assert found["overall"]["n_episodes"] == 2 and found["overall"]["pc_success"] == 0.0  # in four steps, untrained
    assert len(list((tmp_path / "scored" / "videos").rglob("*.mp4"))) == 2


@PRESENT
@pytest.mark.long
@pytest.mark.render
@pytest.mark.timeout(900)
def test_the_client_alone_is_an_env_py_of_its_hub(tmp_path: Path, address: str) -> None:
    (tmp_path / "env.py").write_text(CLIENT.read_text())
    (tmp_path / "hub.py").write_text(HUB)
    assert "PLAYED" in run(tmp_path, address, PYTHON, "hub.py", "env.py")


def test_the_sizes_that_its_configuration_tells_are_ours() -> None:
    tree = ast.parse((EXAMPLES / "hazard_lerobot.py").read_text())
    told = {ast.unparse(node.targets[0]): node.value for node in tree.body if isinstance(node, ast.Assign)}
    assert ast.literal_eval(told["SIZES"]) == {robot: (STATES[robot], ACTIONS[robot]) for robot in STATES}
    assert ast.literal_eval(told["FRAMES"]) == FRAMES["paper"] == FRAMES["realistic"]
