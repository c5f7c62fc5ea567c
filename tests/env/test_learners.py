"""What Stable-Baselines3 and gymnasium's vector environments do with NumpyEnv: the real ones, for a few steps."""

from __future__ import annotations

import os
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import hazard_ms
from hazard_ms import NumpyEnv

ROOT = Path(__file__).parents[2]
FRAMES = 3  # of an episode
stable_baselines3 = pytest.importorskip("stable_baselines3")


def make(**keywords: Any) -> NumpyEnv:
    settings = {"obs_mode": "state", "render_backend": "none", "max_episode_steps": FRAMES, **keywords}
    return NumpyEnv(gym.make("HazardFire-v1", **settings))


def test_checkers_find_nothing_without_a_renderer() -> None:
    from stable_baselines3.common.env_checker import check_env as check_for_learners

    env = make()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # test_env.py lists what they may say
        check_env(env)
        check_for_learners(env)
    env.close()


class Scenes(gym.Wrapper):
    """Notes the scene of every episode."""

    def __init__(self, env: gym.Env) -> None:
        super().__init__(env)
        self.seen: list[str] = []

    def reset(self, **keywords: Any) -> Any:
        outcome = self.env.reset(**keywords)
        self.seen.append(self.unwrapped.specs[0].name)  # type: ignore[attr-defined]
        return outcome


def train(steps: int, **keywords: Any) -> list[str]:
    """The scenes in which Stable-Baselines3 trains for `steps`; it gives a seed to the first reset alone."""
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import DummyVecEnv

    noted = Scenes(make(deterministic=False, **keywords))
    envs = DummyVecEnv([lambda: noted])
    PPO("MlpPolicy", envs, n_steps=steps, batch_size=steps, n_epochs=1, seed=11, device="cpu").learn(steps)
    envs.close()
    return noted.seen


@pytest.mark.long
def test_training_sees_several_scenes_and_the_same_again() -> None:
    first = train(6 * FRAMES)
    assert len(first) == 7 and len(set(first)) >= 4  # of 100: five of seven alike is a chance of one in a million
    assert train(6 * FRAMES) == first


def test_scenes_stay_for_as_many_episodes_as_asked() -> None:
    seen = train(6 * FRAMES, scene_every=3)
    assert len(set(seen[:3])) == 1 and len(set(seen[3:6])) == 1 and seen[0] != seen[3] != seen[6]
    assert len(set(train(3 * FRAMES, scene_every=0))) == 1


def test_explicit_reconfiguration_decides_alone() -> None:
    env = make(deterministic=False, reconfiguration_freq=0)
    scenes = [env.reset(seed=seed)[1] and env.unwrapped.specs[0].name for seed in (5, None, None, None)]
    assert len(set(scenes)) == 1
    env.close()


@pytest.mark.long
def test_training_in_processes() -> None:
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import SubprocVecEnv

    envs = SubprocVecEnv([make, make], start_method="spawn")
    try:
        model = PPO("MlpPolicy", envs, n_steps=4, batch_size=8, n_epochs=1, seed=3, device="cpu").learn(8)
        assert model.num_timesteps == 8 and np.isfinite(model.rollout_buffer.observations).all()
    finally:
        envs.close()


@pytest.mark.long
def test_the_line_that_is_advised_runs(tmp_path: Path) -> None:
    """In a script of its own: new processes import the main module again."""
    code = (
        "import hazard_ms\n"
        "if __name__ == '__main__':\n"
        "    keywords = dict(obs_mode='state', render_backend='none')\n"
        "    envs = hazard_ms.vector.make('HazardFire-v1', num_envs=2, **keywords)\n"
        "    obs, _ = envs.reset(seed=[1, 2])\n"
        "    print(obs.shape[0], (obs[0] != obs[1]).any(), envs.step(envs.action_space.sample())[1].shape)\n"
        "    envs.close()\n"
    )
    script = tmp_path / "training.py"
    script.write_text(code)
    environ = {**os.environ, "PYTHONPATH": str(ROOT)}
    out = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, timeout=280, env=environ, check=False
    )
    assert out.returncode == 0, out.stderr[-2000:]
    assert out.stdout.split() == ["2", "True", "(2,)"]


def test_the_package_offers_it_at_the_top() -> None:
    assert hazard_ms.NumpyEnv is NumpyEnv
