"""The batched time limit of every registered environment."""

from __future__ import annotations

import dataclasses
from typing import Any

import gymnasium as gym
from gymnasium.envs.registration import EnvSpec, WrapperSpec
from gymnasium.utils import RecordConstructorArgs


class TimeLimit(gym.Wrapper, RecordConstructorArgs):
    """Truncates after `max_episode_steps` frames, keeping truncations of the environment itself (a broken simulation).

    Takes the place, and the limit, of gymnasium's own TimeLimit, which knows neither batches nor tensors. Where that
    limit is the task's usual one, the split's takes its place.
    """

    def __init__(self, env: gym.Env, max_episode_steps: int | None = None) -> None:
        RecordConstructorArgs.__init__(self, max_episode_steps=max_episode_steps)
        if isinstance(env, gym.wrappers.TimeLimit):
            usual = env.unwrapped.limit_of(env.get_wrapper_attr("_max_episode_steps"))  # type: ignore[attr-defined]
            max_episode_steps = max_episode_steps or usual
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
        again = WrapperSpec("TimeLimit", "hazard_ms.env.time_limit:TimeLimit", kwargs={})
        return dataclasses.replace(
            inner, max_episode_steps=self._max_episode_steps, additional_wrappers=(*inner.additional_wrappers, again)
        )

    def step(self, action: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        obs, reward, terminated, truncated, info = self.env.step(action)
        if self._max_episode_steps is not None:
            truncated = truncated | (self.unwrapped.elapsed_steps >= self._max_episode_steps)  # type: ignore[attr-defined]
        return obs, reward, terminated, truncated, info


def is_bare(env: gym.Env) -> bool:
    """Whether only the TimeLimit above and gymnasium's OrderEnforcing wrap `env`: then nobody has to see its steps."""
    while isinstance(env, TimeLimit | gym.wrappers.OrderEnforcing):
        env = env.env
    return env is env.unwrapped
