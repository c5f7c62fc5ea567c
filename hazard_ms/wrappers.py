"""Two wrappers: the batched time limit of every registered environment, and gymnasium's plain numpy interface."""

from __future__ import annotations

import dataclasses
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from gymnasium.envs.registration import EnvSpec, WrapperSpec
from gymnasium.utils import RecordConstructorArgs


class TimeLimit(gym.Wrapper, RecordConstructorArgs):
    """Truncates after `max_episode_steps` frames, keeping truncations of the environment itself (a broken simulation).

    Takes the place, and the limit, of gymnasium's own TimeLimit, which knows neither batches nor tensors.
    """

    def __init__(self, env: gym.Env, max_episode_steps: int | None = None) -> None:
        RecordConstructorArgs.__init__(self, max_episode_steps=max_episode_steps)
        if isinstance(env, gym.wrappers.TimeLimit):
            max_episode_steps = max_episode_steps or env.get_wrapper_attr("_max_episode_steps")
            env = env.env
        super().__init__(env)
        self._max_episode_steps = max_episode_steps
        if max_episode_steps is not None:
            env.unwrapped.allow_frames(max_episode_steps)  # type: ignore[attr-defined]

    @property
    def spec(self) -> EnvSpec | None:  # type: ignore[override]
        """The environment's spec with this limit, from which gymnasium makes the same environment again."""
        inner = self.env.spec
        if inner is None:
            return None
        again = WrapperSpec("TimeLimit", "hazard_ms.wrappers:TimeLimit", kwargs={})
        return dataclasses.replace(
            inner, max_episode_steps=self._max_episode_steps, additional_wrappers=(*inner.additional_wrappers, again)
        )

    def step(self, action: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        obs, reward, terminated, truncated, info = self.env.step(action)
        if self._max_episode_steps is not None:
            truncated = truncated | (self.unwrapped.elapsed_steps >= self._max_episode_steps)  # type: ignore[attr-defined]
        return obs, reward, terminated, truncated, info


def is_bare(env: gym.Env) -> bool:
    """Whether `env` is wrapped in nothing, or only in the TimeLimit above: then nobody else has to see its steps."""
    while isinstance(env, TimeLimit):
        env = env.env
    return env is env.unwrapped


class NumpyEnv(gym.Wrapper, RecordConstructorArgs):
    """One environment as gymnasium defines it: numpy, unbatched, nothing shared between calls. Passes `check_env`."""

    def __init__(self, env: gym.Env) -> None:
        RecordConstructorArgs.__init__(self)
        super().__init__(env)
        base: Any = env.unwrapped
        if base.num_envs != 1:
            raise ValueError(f"num_envs is {base.num_envs}; NumpyEnv takes an environment with num_envs=1")
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
