"""Bad input gets a clear error, early: each function names the bad value and what is allowed."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any

import numpy as np
import torch

SEED_END = 2**32  # numpy's seeds end there, and ManiSkill draws with numpy
SIM_BACKENDS = ("auto", "cpu", "gpu", "cuda", "physx_cpu", "physx_cuda")
RENDER_BACKENDS = ("auto", "cpu", "gpu", "cuda", "sapien_cpu", "sapien_cuda", "none", "pci")
OPTIONS = ("scene", "reconfigure", "env_idx", "reset_to_env_states")


def one_of(value: Any, allowed: Iterable[str], what: str) -> str:
    """`value` if it is one of the names `allowed`."""
    names = list(allowed)
    if not isinstance(value, str) or value not in names:
        close = difflib.get_close_matches(str(value), names, n=1)
        hint = f" (did you mean {close[0]!r}?)" if close else ""
        shown = ", ".join(names[:40]) + (f", ... ({len(names)} in all)" if len(names) > 40 else "")
        raise ValueError(f"{what} {value!r} is unknown{hint}; allowed: {shown}")
    return value


def whole(value: Any, low: int, high: int, what: str) -> int:
    """`value` as an int in [low, high]; bools and floats are refused."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)) or not low <= int(value) <= high:
        raise ValueError(f"{what} is {value!r}; a whole number from {low} to {high} is allowed")
    return int(value)


def flag(value: Any, what: str) -> bool:
    """`value` if it is True or False; numbers are refused."""
    if not isinstance(value, (bool, np.bool_)):
        raise ValueError(f"{what} is {value!r}; True or False is allowed")
    return bool(value)


def seeds(value: Any, num_envs: int) -> Any:
    """`seed` of a reset: None, one seed, or a list of one per environment."""
    if value is None:
        return None
    if isinstance(value, (list, tuple, np.ndarray)):
        if len(value) not in (1, num_envs):
            raise ValueError(f"seed has {len(value)} entries; 1 or {num_envs} (num_envs) are allowed")
        return [whole(s, 0, SEED_END - 1, "seed") for s in value]
    return whole(value, 0, SEED_END - 1, "seed")


def options(value: Any, num_envs: int) -> dict[str, Any]:
    """`options` of a reset."""
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise ValueError(f"options is {value!r}; a dict or None is allowed")
    for key in value:
        one_of(key, OPTIONS, "reset option")
    if "reconfigure" in value:
        flag(value["reconfigure"], "reset option 'reconfigure'")
    if "env_idx" in value:
        rows = value["env_idx"].tolist() if isinstance(value["env_idx"], (np.ndarray, torch.Tensor)) else value["env_idx"]
        if (
            not isinstance(rows, (list, tuple))
            or not rows
            or not all(type(r) is int and 0 <= r < num_envs for r in rows)
            or len(set(rows)) < len(rows)
        ):
            raise ValueError(f"reset option 'env_idx' is {value['env_idx']!r}; a list of indices from 0 to {num_envs - 1} is allowed")
        return {**value, "env_idx": torch.tensor(rows)}
    return dict(value)


def backends(num_envs: int, sim: Any, render: Any) -> None:
    """Names of backends, and what `num_envs` asks of them."""
    one_of(sim.split(":")[0] if isinstance(sim, str) else sim, SIM_BACKENDS, "sim_backend")
    one_of(render.split(":")[0] if isinstance(render, str) else render or "none", RENDER_BACKENDS, "render_backend")
    if num_envs > 1 and (sim in ("cpu", "physx_cpu") or not torch.cuda.is_available()):
        raise ValueError(f"num_envs is {num_envs}; 1 is allowed without a CUDA GPU (for more, use gymnasium's AsyncVectorEnv)")


def action(value: Any, space: Any, num_envs: int, modes: Iterable[str] = ()) -> Any:
    """A low-level action: None (no new command), an array of the action space's shape, or ManiSkill's dict with a control mode."""
    if value is None:
        return value
    if isinstance(value, dict):
        if set(value) != {"control_mode", "action"}:
            raise ValueError(f"action is a dict with {sorted(map(str, value))}; control_mode and action are allowed")
        one_of(value["control_mode"], modes, "control_mode")
        _numbers(value["action"])
        return value
    array = _numbers(value)
    shapes = [(num_envs, *space.shape)] + ([space.shape] if num_envs == 1 else [])
    if tuple(array.shape) not in shapes:
        raise ValueError(f"action has shape {tuple(array.shape)}; allowed: {' or '.join(map(str, shapes))}")
    return value


def _numbers(value: Any) -> torch.Tensor:
    if not isinstance(value, (np.ndarray, torch.Tensor)):
        raise ValueError(f"action is a {type(value).__name__}; a numpy array or torch tensor is allowed")
    array = torch.as_tensor(value)
    if array.dtype == torch.bool or array.is_complex():
        raise ValueError(f"action has dtype {array.dtype}; floating-point or integer numbers are allowed")
    if not bool(torch.isfinite(array).all()):
        raise ValueError(f"action holds {_first_bad(array)}; finite numbers are allowed")
    return array


def _first_bad(array: torch.Tensor) -> str:
    bad = array[~torch.isfinite(array)]
    return str(float(bad[0]))
