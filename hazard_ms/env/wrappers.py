"""Gymnasium's plain numpy interface, as a wrapper."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import torch
from gymnasium.utils import RecordConstructorArgs


class NumpyEnv(gym.Wrapper, RecordConstructorArgs):
    """One environment as gymnasium defines it: numpy, unbatched, nothing shared between calls. Passes `check_env`."""

    def __init__(self, env: gym.Env) -> None:
        RecordConstructorArgs.__init__(self)
        super().__init__(env)
        base: Any = env.unwrapped
        if base.num_envs != 1:
            raise ValueError(f"num_envs must be 1 for NumpyEnv, got {base.num_envs}")
        self.observation_space = base.single_observation_space
        self.action_space = base.single_action_space

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        obs, info = self.env.reset(seed=seed, options=options)
        return plain(obs), plain(info)

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        obs, reward, terminated, truncated, info = self.env.step(action)
        return plain(obs), float(reward), bool(terminated), bool(truncated), plain(info)

    def render(self) -> Any:
        return plain(self.env.render())


def plain(value: Any) -> Any:
    """`value` as numpy without its batch axis, copied; scalars become Python's own."""
    if isinstance(value, dict):
        return {k: plain(v) for k, v in value.items()}
    if isinstance(value, torch.Tensor):
        value = value.cpu().numpy()
    if isinstance(value, np.ndarray):
        value = value[0] if value.ndim else value
        return np.array(value) if np.ndim(value) else value.item()
    return value
