"""Skills in wrapped environments: every wrapper sees every frame, and the episode is the same to the bit."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium as gym
import h5py
import numpy as np
import pytest
import torch
from mani_skill.utils.wrappers.record import RecordEpisode

from hazard_ms import Action, NumpyEnv, SkillEnv
from hazard_ms.env.time_limit import is_bare
from hazard_ms.skills.decision import EXPLORE
from hazard_ms.skills.failures import EPISODE_OVER

pytestmark = pytest.mark.render
FRAMES = 25  # of an episode; to look around takes longer


def make() -> gym.Env:
    camera = {"width": 32, "height": 32}
    settings: dict[str, Any] = {"obs_mode": "none", "control_mode": "pd_joint_pos", "effects": "off"}
    return gym.make("HazardFire-v1", max_episode_steps=FRAMES, sensor_configs=camera, **settings)


def play(env: gym.Env) -> tuple[SkillEnv, float, Any]:
    """An episode of one action, its reward and its result."""
    skills = SkillEnv(env)
    skills.reset(seed=5)
    _, reward, _, truncated, info = skills.step(Action(EXPLORE))
    assert truncated and skills.frame == FRAMES
    return skills, reward, info["result"]


def test_only_wrappers_of_others_have_to_see_every_frame() -> None:
    """What gym.make itself wraps an environment in need not: frames of skills go round it."""
    env = make()
    assert is_bare(env) and not is_bare(gym.wrappers.RecordEpisodeStatistics(env)) and not is_bare(NumpyEnv(env))
    env.close()


def test_what_records_sees_every_frame(tmp_path: Path) -> None:
    bare, reward, result = play(make())
    recorded, recorded_reward, recorded_result = play(
        RecordEpisode(make(), str(tmp_path), save_video=False, trajectory_name="skills")
    )
    assert recorded_reward == reward and recorded_result == result and result.reason == EPISODE_OVER
    for name, tensor in vars(bare.base.world).items():
        if isinstance(tensor, torch.Tensor):
            assert torch.equal(getattr(recorded.base.world, name), tensor), name
    recorded.close()
    with h5py.File(tmp_path / "skills.h5") as file:
        assert file["traj_0/actions"].shape == (FRAMES, *bare.base.single_action_space.shape)
        assert file["traj_0/truncated"][-1] and not file["traj_0/truncated"][:-1].any()
        assert np.isclose(np.sum(file["traj_0/rewards"]), reward, rtol=1e-5)
    bare.close()


def test_a_wrapper_that_gives_numpy_serves_skills_too() -> None:
    skills, reward, _ = play(NumpyEnv(make()))
    assert isinstance(reward, float) and int(skills.base.elapsed_steps[0]) == FRAMES
    skills.close()
