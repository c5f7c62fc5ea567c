"""Tasks as vectors of environments, as an `env.py` of LeRobot's EnvHub makes them."""

from __future__ import annotations

from functools import partial
from typing import Any

import gymnasium as gym
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv, VectorEnv

from hazard_ms.lerobot import ENV_ID
from hazard_ms.spec.checks import flag, whole

MOST_ENVS = 1024  # any larger number must be a mistake [ours]
SUITE = "hazard"


def make_env(
    n_envs: int = 1, use_async_envs: bool = False, cfg: Any = None, **keywords: Any
) -> dict[str, dict[int, VectorEnv]]:
    """`n_envs` environments `HazardRobot-v1` side by side, as {suite: {number of the task: vector}}.

    `use_async_envs`: each in a process of its own. `cfg`: settings of the environment type `hazard`, or None;
    `keywords` are those of `hazard_ms.lerobot.environment.RobotEnv`, and go before these.

    Raises ValueError for numbers and keywords that are not allowed.
    """
    whole(n_envs, 1, MOST_ENVS, "n_envs")
    asked = {**getattr(cfg, "gym_kwargs", {}), **keywords}
    made = [partial(gym.make, f"hazard_ms.lerobot:{ENV_ID}", **asked)] * n_envs
    if flag(use_async_envs, "use_async_envs") and n_envs > 1:
        return {SUITE: {0: AsyncVectorEnv(made, context="forkserver", autoreset_mode=AutoresetMode.SAME_STEP)}}
    return {SUITE: {0: SyncVectorEnv(made, autoreset_mode=AutoresetMode.SAME_STEP)}}
