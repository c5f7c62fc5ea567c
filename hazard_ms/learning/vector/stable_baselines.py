"""Vector environments of gymnasium as those of Stable-Baselines3."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv

from hazard_ms.learning.vector.processes import ProcessVectorEnv

MASKS = "action_masks"  # what sb3-contrib's MaskablePPO asks for


class SB3VecEnv(VecEnv):
    """A vector environment of gymnasium that resets in the step in which an episode ends, for Stable-Baselines3.

    Its dicts of info are filled where an episode ended: with all that info held then, "terminal_observation",
    "TimeLimit.truncated", and "episode" with the sum of rewards and the number of steps.
    """

    def __init__(
        self,
        envs: VectorEnv[Any, Any, Any],
        scale: float = 1.0,
        bootstraps: bool = True,
        masks: Callable[[], NDArray[np.bool_]] | None = None,
    ) -> None:
        """Take `envs`, N environments.

        Args:
            envs: What `hazard_ms.vector.make` makes with autoreset_mode="SameStep".
            scale: Factor on the rewards that learners get, but not on those in info.
            bootstraps: Whether learners add what might have come after episodes that were truncated.
            masks: Gives the masks of what can be chosen now, [N, A]; by default the environments' own, if any.

        Raises:
            ValueError: For environments that reset at another time.
        """
        mode = envs.metadata.get("autoreset_mode")
        if mode != AutoresetMode.SAME_STEP:
            raise ValueError(f"autoreset_mode must be SameStep for Stable-Baselines3, got {mode}")
        self.envs, self._scale, self._bootstraps = envs, scale, bootstraps
        self._masks = masks or getattr(envs, MASKS, None)  # a batch has masks of its own, processes are asked for them
        self._seed: int | None = None
        self._actions: Any = None
        self._returns, self._steps = np.zeros(envs.num_envs), np.zeros(envs.num_envs, np.int64)
        self.render_mode = envs.render_mode
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Choose the seed of the next reset, which is that of the first environment; None: the last series goes on."""
        self._seed = seed
        return [None if seed is None else seed + k for k in range(self.num_envs)]

    def reset(self) -> Any:
        """Begin all episodes anew: what is seen, [N, ...]. Raises ValueError for options that differ."""
        options = self._options[0] or None
        if any((given or None) != options for given in self._options):
            raise ValueError(f"options must be the same for all environments, got {self._options!r:.100}")
        obs, _ = self.envs.reset(seed=self._seed, options=options)
        self._seed = None
        self._reset_options()
        self._returns[:], self._steps[:] = 0.0, 0
        return obs

    def step_async(self, actions: NDArray[Any]) -> None:
        """Take the actions that `step_wait` plays, [N, ...]."""
        self._actions = actions

    def step_wait(self) -> Any:
        """Play them: what is seen [N, ...], rewards [N], whether episodes ended [N], and info of each environment."""
        obs, rewards, terminated, truncated, told = self.envs.step(self._actions)
        self._returns += rewards
        self._steps += 1
        done, infos = terminated | truncated, [dict[str, Any]() for _ in range(self.num_envs)]
        for n in np.flatnonzero(done):
            infos[n] = {
                **_row(told["final_info"], int(n)),
                "terminal_observation": _at(told["final_obs"], int(n)),
                "episode": {"r": float(self._returns[n]), "l": int(self._steps[n])},
            }
            if self._bootstraps:
                infos[n]["TimeLimit.truncated"] = bool(truncated[n] and not terminated[n])
        self._returns[done], self._steps[done] = 0.0, 0
        return obs, (self._scale * rewards).astype(np.float32), done, infos

    def action_masks(self) -> NDArray[np.bool_]:
        """Masks of what can be chosen now, [N, A]. Raises AttributeError for environments that have none."""
        return self._masks() if self._masks is not None else np.stack(self._processes(MASKS).call(MASKS))

    def close(self) -> None:
        """Close the environments."""
        self.envs.close()

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
        """The result of a method of environments. Raises AttributeError where there is none."""
        numbers = [*self._get_indices(indices)]
        if method_name == MASKS and self._masks is not None:
            return [*self.action_masks()[numbers]]
        return [*self._processes(method_name).call_some(numbers, method_name, *args, **kwargs)]

    def has_attr(self, attr_name: str) -> bool:
        """Whether all environments have an attribute or a method of this name."""
        if attr_name == "render_mode" or (attr_name == MASKS and self._masks is not None):
            return True
        try:
            return all(self._processes(attr_name).call("has_wrapper_attr", attr_name))
        except AttributeError:
            return False

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """The value of an attribute of environments. Raises AttributeError where there is none."""
        numbers = [*self._get_indices(indices)]
        if attr_name == "render_mode":
            return [self.render_mode for _ in numbers]
        return [*self._processes(attr_name).call_some(numbers, attr_name)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute of environments. Raises AttributeError where they are not in processes."""
        self._processes(attr_name).call_some([*self._get_indices(indices)], "set_wrapper_attr", attr_name, value)

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Whether each environment is wrapped in a wrapper of Stable-Baselines3: none is."""
        return [False for _ in self._get_indices(indices)]

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """The picture of each environment."""
        pictures: Any = self.envs.render()
        return [None] * self.num_envs if pictures is None else [*pictures]

    def _processes(self, name: str) -> ProcessVectorEnv:
        """The environments, where they can be asked for the attribute `name`."""
        if not isinstance(self.envs, ProcessVectorEnv):
            raise AttributeError(f"environments in one batch have no attributes of their own, got {name!r}")
        return self.envs


def _row(told: dict[str, Any], number: int) -> dict[str, Any]:
    """What info holds on the environment `number`, as Python's own numbers."""
    made: dict[str, Any] = {}
    for name, values in told.items():
        there = told.get(f"_{name}")
        if not name.startswith("_") and (there is None or there[number]):
            value = _row(values, number) if isinstance(values, dict) else values[number]
            made[name] = value.item() if isinstance(value, np.generic) else value
    return made


def _at(seen: Any, number: int) -> Any:
    """What was seen in the environment `number`."""
    return {name: _at(part, number) for name, part in seen.items()} if isinstance(seen, dict) else seen[number]
