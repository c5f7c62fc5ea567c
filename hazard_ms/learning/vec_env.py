"""Hundreds of rescues in the sketch as one vector environment of Stable-Baselines3, in one process.

The end of time is an end like others: the score is settled then, and policies see how much time is left. So nothing is
marked as truncated, which would have learners add what might have come after.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv

from hazard_ms.agents.learned.set_policy import worthwhile
from hazard_ms.sketch.environments.batch import SketchBatch
from hazard_ms.sketch.environments.choices import OPTIONS


class SketchVecEnv(VecEnv):
    """The rescues of a `SketchBatch`. The option `stop` is offered only where there is nothing to go to."""

    def __init__(self, batch: SketchBatch, scale: float = 1.0) -> None:
        """Take a `batch` of N rescues; `scale`: factor on the rewards that learners get, but not on those in info."""
        self.batch, self._scale = batch, scale
        self.render_mode = None
        super().__init__(batch.num_envs, batch.single_observation_space, batch.single_action_space)
        self._returns = np.zeros(batch.num_envs)
        self._seed: int | None = None
        self._actions: Any = None

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Choose the seed of the next reset."""
        self._seed = seed
        return [seed] * self.num_envs

    def reset(self) -> NDArray[np.float32]:
        """Begin all episodes anew: what is seen, [N, ...]."""
        obs, _ = self.batch.reset(seed=self._seed)
        self._seed = None
        self._returns[:] = 0.0
        return obs

    def step_async(self, actions: NDArray[np.int64]) -> None:
        """Take the choices that `step_wait` plays, [N]."""
        self._actions = actions

    def step_wait(self) -> Any:
        """Play them: what is seen [N, ...], rewards [N], whether episodes ended [N], and info of each rescue."""
        obs, rewards, terminated, truncated, told = self.batch.step(self._actions)
        self._returns += rewards
        done, infos = terminated | truncated, [dict[str, Any]() for _ in range(self.num_envs)]
        for n in np.flatnonzero(done):
            ended = told["final_info"]
            infos[n] = {
                "terminal_observation": told["final_obs"][n],
                "episode": {"r": float(self._returns[n]), "l": int(ended["decisions"][n])},
                "value": float(ended["value"][n]),
                "frame": int(ended["frame"][n]),
            }
        self._returns[done] = 0.0
        return obs, (self._scale * rewards).astype(np.float32), done, infos

    def action_masks(self) -> NDArray[np.bool_]:
        """Masks of what can be chosen now, [N, A]."""
        masks = self.batch.action_masks()
        return worthwhile(masks) if self.batch.actions == OPTIONS else masks

    def close(self) -> None:
        """Close the batch of rescues."""
        self.batch.close()

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
        """The result of a method for each rescue: `action_masks`. Raises AttributeError for others."""
        if method_name != "action_masks":
            raise AttributeError(f"a method of rescues must be action_masks, got {method_name!r}")
        return [*self.action_masks()[list(self._get_indices(indices))]]

    def has_attr(self, attr_name: str) -> bool:
        """Whether rescues have an attribute: they have masks, and no pictures."""
        return attr_name in ("action_masks", "render_mode")

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """The value of an attribute for each rescue: `render_mode`. Raises AttributeError for others."""
        if attr_name != "render_mode":
            raise AttributeError(f"an attribute of rescues must be render_mode, got {attr_name!r}")
        return [None for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Raises AttributeError: rescues have no attributes that can be set."""
        raise AttributeError(f"rescues must be left as they are, got {attr_name!r} to set")

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Whether each rescue is wrapped: none is."""
        return [False for _ in self._get_indices(indices)]
