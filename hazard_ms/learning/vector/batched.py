"""The batched environment of a GPU behind the interface that environments in processes have."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from mani_skill.utils.common import to_numpy
from numpy.typing import NDArray


class BatchedEnv(gym.vector.VectorEnv[Any, Any, NDArray[Any]]):
    """N environments of one batch of ManiSkill's, with arrays of numpy instead of tensors.

    Who wants tensors that stay on the GPU takes ManiSkill's own ManiSkillVectorEnv.
    """

    def __init__(self, env: gym.Env[Any, Any], autoreset_mode: AutoresetMode) -> None:
        """Take a batched `env`."""
        base: Any = env.unwrapped
        self._env, self._device, self._autoreset = env, base.device, autoreset_mode
        self.num_envs, self.spec, self.render_mode = base.num_envs, env.spec, env.render_mode
        self.metadata = {**env.metadata, "autoreset_mode": autoreset_mode}
        self.single_observation_space, self.single_action_space = (
            base.single_observation_space,
            base.single_action_space,
        )
        self.observation_space, self.action_space = (
            gym.vector.utils.batch_space(space, self.num_envs)
            for space in (self.single_observation_space, self.single_action_space)
        )
        self._over = torch.zeros(self.num_envs, dtype=torch.bool, device=self._device)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin episodes: what is seen, [N, ...], and info, [N] each.

        `seed` is that of the first environment, the next ones having the numbers that follow, or one for each;
        `options` are those of the environment, and "reset_mask", bool [N], which says who begins.

        Raises ValueError for what is not allowed.
        """
        given = dict(options or {})
        if "reset_mask" in given:
            given["env_idx"] = np.flatnonzero(given.pop("reset_mask")).tolist()
        seeds = [seed + k for k in range(self.num_envs)] if isinstance(seed, (int, np.integer)) else seed
        obs, info = self._env.reset(seed=seeds, options=given)  # type: ignore[arg-type]
        self._over[given.get("env_idx", slice(None))] = False
        return to_numpy(obs), _told(info)

    def step(
        self, actions: Any
    ) -> tuple[Any, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Step all environments: what is seen [N, ...], rewards, terminated, truncated, [N] each, and info.

        Raises ValueError for actions of a wrong shape, type or number.
        """
        obs, reward, *ends, info = self._env.step(torch.as_tensor(actions, device=self._device))
        terminated, truncated = (torch.as_tensor(end, device=self._device).clone() for end in ends)
        reward, over = torch.as_tensor(reward, device=self._device), terminated | truncated
        again = {AutoresetMode.NEXT_STEP: self._over, AutoresetMode.SAME_STEP: over}.get(self._autoreset)
        rows = [] if again is None else again.nonzero()[:, 0].tolist()
        final: dict[str, Any] = {}
        if rows:
            if self._autoreset == AutoresetMode.SAME_STEP:
                final = _final(to_numpy(obs), _told(info), to_numpy(over))
            else:  # what these did was no step of an episode
                reward = reward.masked_fill(self._over, 0.0)
                terminated, truncated = terminated & ~self._over, truncated & ~self._over
            obs, info = self._env.reset(options={"env_idx": rows})
        self._over = terminated | truncated
        numbers = to_numpy(reward).astype(np.float64), to_numpy(terminated), to_numpy(truncated)
        return to_numpy(obs), *numbers, {**_told(info), **final}

    def render(self) -> tuple[Any, ...] | None:
        """The picture of each environment."""
        pictures = self._env.render()
        return None if pictures is None else tuple(to_numpy(pictures))

    def close_extras(self, **_: Any) -> None:
        """Close the environment."""
        self._env.close()


def _told(info: dict[str, Any]) -> dict[str, Any]:
    """The `info` of a batch as gymnasium has it: arrays [N], and flags under _NAME."""
    made: dict[str, Any] = {}
    for name, value in to_numpy(info).items():
        if isinstance(value, np.ndarray) and value.ndim:
            made[name], made[f"_{name}"] = value.copy(), np.ones(len(value), np.bool_)
    return made


def _final(obs: Any, info: dict[str, Any], over: NDArray[np.bool_]) -> dict[str, Any]:
    """What was seen and told last in the environments whose episode is `over`, [N]."""
    seen = np.full(len(over), None, dtype=object)
    for n in np.flatnonzero(over):
        seen[n] = _at(obs, int(n))
    there = {name: over.copy() if name.startswith("_") else value for name, value in info.items()}
    return {"final_obs": seen, "final_info": there, "_final_obs": over, "_final_info": over.copy()}


def _at(obs: Any, number: int) -> Any:
    return {name: _at(part, number) for name, part in obs.items()} if isinstance(obs, dict) else obs[number].copy()
