"""Environments in processes of their own, as one vector environment of gymnasium."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.error import ClosedEnvironmentError
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from hazard_ms.learning.vector.players import Processes
from hazard_ms.spec.checks import whole

PATIENCE = 600.0  # longest time of a step or a reset by default [s] [ours]


class ProcessVectorEnv(gym.vector.VectorEnv[Any, Any, NDArray[Any]]):
    """N environments in P processes, one thread each. Each plays as it would alone: the same bits for the same seeds.

    A process plays its environments one after another, so more environments than cores cost no more than their frames.
    What is handed out is the caller's own. An error of an environment is raised here as it is; what caused it names
    the environment. A process that dies or hangs raises LostEnvironmentError, and all is closed.
    """

    def __init__(
        self,
        env_id: str,
        num_envs: int,
        processes: int,
        keywords: Mapping[str, Any],
        autoreset_mode: AutoresetMode,
        patience: float = PATIENCE,
    ) -> None:
        """Start P = `processes`, which make N = `num_envs` environments with `keywords` of gym.make.

        `patience`: longest time of a step or a reset [s].

        Raises what gym.make raises.
        """
        self.num_envs, self._patience = num_envs, patience
        self._processes = Processes(env_id, num_envs, processes, keywords, autoreset_mode)
        made = self._processes.spaces
        self.metadata = {**made.metadata, "autoreset_mode": autoreset_mode}
        self.render_mode = made.render_mode
        self.single_observation_space, self.single_action_space = made.observation, made.action
        self.observation_space = batch_space(made.observation, num_envs)
        self.action_space = batch_space(made.action, num_envs)
        self._begun = False

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin episodes: what is seen, [N, ...], and info, [N] each.

        Args:
            seed: That of the first environment, the next ones having the numbers that follow; or one for each.
            options: Those of the environments; "reset_mask", bool [N], says which begin, while others go on.

        Raises:
            ValueError: For what an environment refuses, and for lists and masks of another length.
        """
        self._check_open()
        if isinstance(seed, (list, tuple, np.ndarray)):
            seeds = [*seed]
        else:
            seeds = [None if seed is None else whole(seed, 0, 2**32 - 1, "seed") + k for k in range(self.num_envs)]
        if len(seeds) != self.num_envs:
            raise ValueError(f"seed must be one number, or {self.num_envs} of them, got {len(seeds)}")
        given = dict(options or {})
        mask = np.asarray(given.pop("reset_mask", np.ones(self.num_envs, bool)))
        if mask.shape != (self.num_envs,) or mask.dtype != np.bool_ or not mask.any():
            raise ValueError(
                f"reset option 'reset_mask' must be {self.num_envs} flags, at least one of them True, got {mask!r:.100}"
            )
        if not (self._begun or mask.all()):
            raise ValueError("reset option 'reset_mask' must select all environments at the first reset")
        others = given if options else None
        self._begun = False
        infos = self._play("reset", [(s, others) if on else None for s, on in zip(seeds, mask, strict=True)])
        self._begun = True
        return self._processes.seen(), self._together(infos)

    def step(
        self, actions: Any
    ) -> tuple[Any, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Step all environments: what is seen [N, ...], rewards, terminated, truncated, [N] each, and info.

        Raises ValueError for `actions` that are not finite numbers of the shape of the action space, and before the
        first reset, or after an error.
        """
        self._check_open()
        if not self._begun:
            raise ValueError("episodes must have begun: call reset first")
        given = np.asarray(actions)
        if given.shape != self.action_space.shape or not np.isfinite(given).all():
            raise ValueError(f"actions must be finite and of shape {self.action_space.shape}, got {actions!r:.100}")
        self._begun = False
        played = self._play("step", given)
        self._begun = True
        rewards, terminated, truncated, infos = zip(*played, strict=True)
        ends = np.array(terminated, np.bool_), np.array(truncated, np.bool_)
        return self._processes.seen(), np.array(rewards, np.float64), *ends, self._together(infos)

    @property
    def pids(self) -> tuple[int, ...]:
        """The numbers that the system gave to the processes, [P]."""
        return self._processes.pids

    def render(self) -> tuple[Any, ...]:
        """The picture of each environment."""
        return self.call("render")

    def call(self, name: str, *args: Any, **keywords: Any) -> tuple[Any, ...]:
        """Call the method `name` of each environment, or get the attributes of that name.

        Raises AttributeError where there is none, and what the method raises.
        """
        return self.call_some(range(self.num_envs), name, *args, **keywords)

    def call_some(self, numbers: Sequence[int], name: str, *args: Any, **keywords: Any) -> tuple[Any, ...]:
        """The same for the environments with some `numbers`."""
        self._check_open()
        wanted = {*numbers}
        found = self._play("call", [(name, args, keywords) if k in wanted else None for k in range(self.num_envs)])
        return tuple(found[k] for k in numbers)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """The attribute `name` of each environment. Raises AttributeError where there is none."""
        return self.call(name)

    def set_attr(self, name: str, values: Any) -> None:
        """Set the attribute `name`, to one value for all or to a list with one for each. Raises ValueError."""
        self._check_open()
        each = [*values] if isinstance(values, (list, tuple)) else [values] * self.num_envs
        if len(each) != self.num_envs:
            raise ValueError(f"values must be one value, or a list of {self.num_envs}, got {len(each)}")
        self._play("call", [("set_wrapper_attr", (name, value), {}) for value in each])

    def close_extras(self, **_: Any) -> None:
        """End all processes; those that do not within seconds are killed."""
        self._processes.end()

    def _play(self, name: str, each: Any) -> list[Any]:
        """Ask for `name` with what is said of `each` environment: the answers, [N]."""
        details = [
            None if isinstance(part, list) and all(asked is None for asked in part) else (part,)
            for (part,) in self._processes.spread(each)
        ]
        answers = self._processes.ask(name, details, self._patience)
        empty = [[None] * len(part) for (part,) in self._processes.spread(each)]
        return [
            one for answer, none in zip(answers, empty, strict=True) for one in (none if answer is None else answer)
        ]

    def _together(self, infos: Sequence[dict[str, Any] | None]) -> dict[str, Any]:
        """Info of all environments as gymnasium has it: arrays [N], and under _NAME where there is one."""
        made: dict[str, Any] = {}
        for number, info in enumerate(infos):
            if info is not None:
                made = self._add_info(made, info, number)
        return made

    def _check_open(self) -> None:
        if self.closed or self._processes.ended:
            raise ClosedEnvironmentError("the vector environment must be open, got a closed one: make a new one")
