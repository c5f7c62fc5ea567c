"""Our `step`, which repeats what ManiSkill's does in fewer operations, beside ManiSkill's own."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch
from mani_skill.envs.sapien_env import BaseEnv

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.env import inputs

FRAMES = 12


def of_maniskill(env: Any, action: Any) -> tuple[Any, ...]:
    """A frame as ManiSkill's BaseEnv lets it pass."""
    made: tuple[Any, ...] = BaseEnv.step(env, inputs.action(env, action))
    return made


@pytest.mark.parametrize("obs_mode", ["state", "state_dict", "none"])
@pytest.mark.parametrize("reward_mode", ["dense", "normalized_dense", "sparse", "none"])
def test_a_frame_is_that_of_maniskill(obs_mode: str, reward_mode: str) -> None:
    keywords: dict[str, Any] = {"obs_mode": obs_mode, "reward_mode": reward_mode, "render_backend": "none"}
    one, other = (gym.make("HazardFire-v1", **keywords).unwrapped for _ in range(2))
    rng = np.random.default_rng(0)
    for env in (one, other):
        env.reset(seed=1)
    for frame in range(FRAMES):
        action: Any = rng.uniform(-1.0, 1.0, one.single_action_space.shape).astype(np.float32)
        if frame == 5:
            action = None
        elif frame > 8:
            action = {"control_mode": "pd_joint_pos", "action": action[: one.agent.action_size("pd_joint_pos")]}
        ours, theirs = one.step(action), of_maniskill(other, action)
        assert same(ours[0], theirs[0])
        for mine, its in zip(ours[1:4], theirs[1:4], strict=True):
            assert torch.equal(mine, its) and mine.dtype == its.dtype
        assert same(ours[4], theirs[4]) and torch.equal(one.elapsed_steps, other.elapsed_steps)
        assert same(one._last_obs, other._last_obs)
    one.close()
    other.close()


def same(one: Any, other: Any) -> bool:
    """Whether nested tensors have the same names, types and numbers."""
    if isinstance(one, dict):
        return list(one) == list(other) and all(same(one[name], other[name]) for name in one)
    return one.dtype == other.dtype and torch.equal(one, other)
