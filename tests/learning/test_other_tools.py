"""Other people's learners run unchanged on environments in the simulator: on decisions, and on single motions."""

from __future__ import annotations

import os
import runpy
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest
import torch

from tests.worlds.registering import practising

ROOT = Path(__file__).parents[2]
PPO_FILE = os.environ.get("HAZARD_MS_MANISKILL_PPO", "")  # ManiSkill's examples/baselines/ppo/ppo.py; on no index
DECISIONS = """
import gymnasium as gym
def make():
    return gym.make("hazard_ms:HazardFireSkills-v1", backend="simulator", max_frames=300)
if __name__ == "__main__":
    from sb3_contrib import MaskablePPO
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import SubprocVecEnv
    for learner in (PPO, MaskablePPO):
        envs = SubprocVecEnv([make, make], start_method="spawn")
        model = learner("MlpPolicy", envs, n_steps=2, batch_size=4, n_epochs=1, device="cpu")
        print(model.learn(4).num_timesteps)
        envs.close()
"""
MOTIONS = """
import gymnasium as gym
from hazard_ms import NumpyEnv
def make():
    env = gym.make(
        "hazard_ms.tasks.practice:HazardPickUp-v1",
        obs_mode="state",
        render_backend="none",
        deterministic=False,
    )
    return NumpyEnv(env)
if __name__ == "__main__":
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import SubprocVecEnv
    envs = SubprocVecEnv([make, make], start_method="spawn")
    model = PPO("MlpPolicy", envs, n_steps=128, batch_size=64, n_epochs=1, device="cpu")
    print(model.learn(256).num_timesteps)
    envs.close()
"""


@pytest.mark.long
@pytest.mark.timeout(1800)
@pytest.mark.parametrize(
    ("script", "said"),
    [pytest.param(DECISIONS, ["4", "4"], marks=pytest.mark.render), pytest.param(MOTIONS, ["256"])],
    ids=["decisions", "motions"],
)
def test_learners_of_stable_baselines_run_in_processes(script: str, said: list[str], tmp_path: Path) -> None:
    """In a script of its own: spawned processes import the main module again."""
    (tmp_path / "spawned.py").write_text(script)
    command = [sys.executable, str(tmp_path / "spawned.py")]
    environ = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, capture_output=True, text=True, timeout=1700, env=environ, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout.split() == said


@pytest.fixture
def practice() -> Iterator[Any]:
    with practising() as module:
        yield module


def test_vector_environment_of_maniskill_tells_what_its_baselines_read(practice: Any) -> None:
    """As ManiSkill's ppo.py makes and reads it: limit, metrics, and what was seen last before a reset."""
    from mani_skill.utils import gym_utils
    from mani_skill.vector.wrappers.gymnasium import ManiSkillVectorEnv

    settings = {"obs_mode": "state", "control_mode": "pd_joint_delta_pos", "render_backend": "none"}
    env = gym.make("HazardPickUp-v1", num_envs=1, reconfiguration_freq=None, deterministic=False, **settings)
    envs = ManiSkillVectorEnv(env, 1, ignore_terminations=False, record_metrics=True)
    assert gym_utils.find_max_episode_steps_value(envs._env) == 120
    seen, _ = envs.reset(seed=1)
    assert seen.shape == (1, *envs.single_observation_space.shape) and seen.dtype == torch.float32
    idle = torch.zeros(1, *envs.single_action_space.shape)
    rewards = []
    for _ in range(120):
        obs, reward, ended, cut, info = envs.step(idle)
        rewards.append(float(reward))
    assert bool(cut) and not bool(ended) and bool(info["_final_info"])
    told = info["final_info"]["episode"]
    assert float(told["return"]) == pytest.approx(sum(rewards), rel=1e-4) and int(told["episode_len"]) == 120
    assert not bool(told["success_once"]) and info["final_observation"].shape == obs.shape
    assert not torch.equal(info["final_observation"], obs)
    envs.close()


@pytest.mark.long
@pytest.mark.skipif(not PPO_FILE, reason="HAZARD_MS_MANISKILL_PPO names no copy of ManiSkill's ppo.py")
def test_baseline_of_maniskill_runs_unchanged(
    practice: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """It asks for a GPU's physics; where there is none, `gym.make` gives it those of the CPU."""
    monkeypatch.chdir(tmp_path)
    count = "8" if torch.cuda.is_available() else "1"
    if count == "1":
        make = gym.make
        monkeypatch.setattr(gym, "make", lambda *a, **k: make(*a, **{**k, "sim_backend": "physx_cpu"}))
    words = [
        "--env_id=hazard_ms.tasks.practice:HazardPickUp-v1",
        f"--num_envs={count}",
        f"--num_eval_envs={count}",
        "--num_steps=64",
    ]
    more = ["--num_minibatches=2", "--update_epochs=1", f"--total_timesteps={128 * int(count)}", "--no-capture_video"]
    monkeypatch.setattr(sys, "argv", [PPO_FILE, *words, *more, "--num_eval_steps=130", "--exp_name=hazard"])
    runpy.run_path(PPO_FILE, run_name="__main__")
    out = capsys.readouterr().out
    assert "Epoch: 2" in out and "eval_success_once_mean" in out
    assert list(tmp_path.glob("runs/hazard/*.pt"))
