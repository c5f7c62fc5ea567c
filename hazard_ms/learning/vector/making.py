"""Makes vector environments: in one batch on a GPU, in the sketch, or else in processes."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

import gymnasium as gym
from gymnasium.vector import AutoresetMode, VectorEnv

from hazard_ms.learning.vector.processes import PATIENCE, ProcessVectorEnv
from hazard_ms.machine.cores import cores
from hazard_ms.spec.checks import one_of, whole
from hazard_ms.spec.registry.announce import ENVIRONMENT, SKILLS

if TYPE_CHECKING:
    from hazard_ms.learning.vector.stable_baselines import SB3VecEnv

MOST = 2**20  # environments: any larger number must be a mistake [-] [ours]
MODES = {mode.value: mode for mode in AutoresetMode}


def make(
    env_id: str,
    num_envs: int = 1,
    *,
    autoreset_mode: AutoresetMode | str | None = None,
    processes: int | None = None,
    patience: float = PATIENCE,
    **keywords: Any,
) -> VectorEnv[Any, Any, Any]:
    """Many environments at once, as a vector environment of gymnasium with arrays of numpy.

    On a GPU they are one batch of ManiSkill's; with backend="sketch" one batch of the sketch; else they are shared out
    among processes. On a processor, environment k gives the bits that a single one with its seed gives.

    Args:
        env_id: What gym.make takes: "HazardFire-v1", "HazardFireSkills-v1", "module:Name-v0".
        num_envs: Number of environments.
        autoreset_mode: What follows the end of an episode: "NextStep" (the default, as in gymnasium: the step after it
            resets), "SameStep" or "Disabled". The sketch knows only "SameStep", its default.
        processes: Number of processes; by default as many as there are cores, or environments if these are fewer.
        patience: Longest time of a step or a reset in a process [s].
        **keywords: Those of gym.make.

    Raises:
        ValueError: For numbers and keywords that are not allowed, with the message that gym.make gives.
        gymnasium.error.Error: For a name that does not exist, as gym.make does.
        LostEnvironmentError: Later, if a process dies or hangs.
    """
    whole(num_envs, 1, MOST, "num_envs")
    wanted = whole(processes, 1, MOST, "processes") if processes is not None else cores()
    mode = None if autoreset_mode is None else MODES[one_of(_text(autoreset_mode), MODES, "autoreset_mode")]
    if not patience > 0:
        raise ValueError(f"patience must be positive, got {patience!r}")
    module, _, name = env_id.rpartition(":")
    if module:
        importlib.import_module(module)
    spec = gym.spec(name)
    if spec.entry_point == SKILLS and keywords.get("backend") == "sketch":
        if mode not in (None, AutoresetMode.SAME_STEP):
            raise ValueError(f"autoreset_mode must be SameStep with backend='sketch', got {mode.value!r}")
        return gym.make_vec(env_id, num_envs, vectorization_mode="vector_entry_point", **keywords)
    mode = mode or AutoresetMode.NEXT_STEP
    if spec.entry_point == ENVIRONMENT and num_envs > 1 and _on_gpu(keywords.get("sim_backend", "auto")):
        from hazard_ms.learning.vector.batched import BatchedEnv

        return BatchedEnv(gym.make(env_id, num_envs=num_envs, **keywords), mode)
    made = ProcessVectorEnv(env_id, num_envs, min(wanted, num_envs), keywords, mode, patience)
    made.spec = spec
    return made


def make_for_sb3(env_id: str, num_envs: int = 1, **keywords: Any) -> SB3VecEnv:
    """The same for learners of Stable-Baselines3. Raises what `make` raises."""
    from hazard_ms.learning.vector.stable_baselines import SB3VecEnv

    return SB3VecEnv(make(env_id, num_envs, autoreset_mode=AutoresetMode.SAME_STEP, **keywords))


def _text(mode: AutoresetMode | str) -> str:
    return mode.value if isinstance(mode, AutoresetMode) else mode


def _on_gpu(sim_backend: Any) -> bool:
    """Whether this backend simulates many environments in one batch on this machine."""
    import torch

    return sim_backend not in ("cpu", "physx_cpu") and torch.cuda.is_available()
