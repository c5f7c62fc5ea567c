"""Bad input gets a clear error, early: each function names the bad value and what is allowed.

Torch is imported only where a tensor can be what is checked, so that names can be checked without waiting for it.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

SEED_END = 2**32  # numpy's seeds end there, and ManiSkill draws with numpy
SIM_BACKENDS = ("auto", "cpu", "gpu", "cuda", "physx_cpu", "physx_cuda")
RENDER_BACKENDS = ("auto", "cpu", "gpu", "cuda", "sapien_cpu", "sapien_cuda", "none", "pci")
FAR = 1e9  # no length [m] or angle [rad] that users give is as large [ours]
SHOWN = 12  # names that an error lists; where there are more, it names the nearest
NEAREST = 5  # names that an error suggests where it cannot list all
LEAST_PIXELS = 16  # of a camera's image each way: the hazard image has as many samples
OPTIONS = ("scene", "reconfigure", "env_idx", "reset_to_env_states")
FOREIGN_OPTIONS = ("lerobot_new_rollout",)  # tools give these to every environment; ignored: lerobot-eval since 0.6.1
# torch's numbers that actions and states may hold: all that numpy or learners compute with
PLAIN_DTYPES = {"float16", "bfloat16", "float32", "float64"} | {
    f"{u}int{n}" for u in ("", "u") for n in (8, 16, 32, 64)
}


def one_of(value: Any, allowed: Iterable[str], what: str, listing: str = "", shown: int = SHOWN) -> str:
    """`value` if it is one of the names `allowed`, of which an error lists `shown` at most.

    Raises ValueError that names the nearest of them otherwise; `listing` says how to see all of very many.
    """
    names = list(allowed)
    if isinstance(value, str) and value in names:
        return value
    close = difflib.get_close_matches(str(value), names, n=NEAREST)
    if len(names) <= shown:
        choices = f"one of {', '.join(names)}"
    else:
        choices = f"one of {len(names)} names such as {', '.join(close or names[:NEAREST])}"
    hint = f" (did you mean {close[0]!r}?)" if close else ""
    more = f"; {listing}" if listing and len(names) > shown else ""
    raise ValueError(f"{what} must be {choices}, got {value!r:.100}{hint}{more}")


def whole(value: Any, low: int, high: int, what: str) -> int:
    """`value` as an int in [low, high]. Raises ValueError for anything else, bools and floats among them."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)) or not low <= int(value) <= high:
        raise ValueError(f"{what} must be a whole number from {low} to {high}, got {value!r}")
    return int(value)


def finite(values: Any, count: int, what: str) -> tuple[float, ...]:
    """`count` numbers as floats. Raises ValueError for other things, and for numbers that are not finite."""
    listed = list(values) if isinstance(values, (tuple, list)) else []
    plain = [isinstance(v, (int, float, np.integer, np.floating)) and not isinstance(v, bool) for v in listed]
    if len(listed) != count or not all(plain) or not all(abs(v) < FAR for v in listed):
        raise ValueError(f"{what} must be {count} finite numbers, got {values!r:.100}")
    return tuple(float(v) for v in listed)


def flag(value: Any, what: str) -> bool:
    """`value` if it is True or False. Raises ValueError for anything else, numbers among them."""
    if not isinstance(value, (bool, np.bool_)):
        raise ValueError(f"{what} must be True or False, got {value!r}")
    return bool(value)


def seeds(value: Any, num_envs: int) -> Any:
    """The `seed` of a reset: None, one seed, or a list of one per environment. Raises ValueError for anything else.

    An array without axes, np.array(3), is the seed that it holds.
    """
    if value is None:
        return None
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, (list, tuple, np.ndarray)):
        if len(value) not in (1, num_envs):
            raise ValueError(f"seed must have 1 or {num_envs} (num_envs) entries, got {len(value)}")
        return [whole(s, 0, SEED_END - 1, "seed") for s in value]
    return whole(value, 0, SEED_END - 1, "seed")


def options(value: Any, num_envs: int) -> dict[str, Any]:
    """The `options` of a reset, the rows of `env_idx` as a tensor, without FOREIGN_OPTIONS.

    Raises ValueError for any that no reset knows.
    """
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise ValueError(f"options must be a dict or None, got {value!r}")
    value = {key: given for key, given in value.items() if key not in FOREIGN_OPTIONS}
    for key in value:
        one_of(key, OPTIONS, "a reset option")
    if "scene" in value and value["scene"] is None:
        raise ValueError("reset option 'scene' must be a scene's name or a list of them, got None")
    if "reconfigure" in value:
        flag(value["reconfigure"], "reset option 'reconfigure'")
    if "env_idx" in value:
        return {**value, "env_idx": rows(value["env_idx"], num_envs, "reset option 'env_idx'")}
    return value


def rows(value: Any, num_envs: int, what: str) -> Any:
    """The numbers of some of `num_envs` environments as a tensor, [R]. Raises ValueError for anything else."""
    import torch

    listed = numbers(value, what).tolist() if isinstance(value, (np.ndarray, torch.Tensor)) else value
    known = isinstance(listed, (list, tuple)) and all(type(r) is int and 0 <= r < num_envs for r in listed)
    if not known or not listed or len(set(listed)) < len(listed):
        raise ValueError(f"{what} must be a list of indices from 0 to {num_envs - 1}, got {value!r:.100}")
    return torch.tensor(listed)


def backends(num_envs: int, sim: Any, render: Any) -> None:
    """Check the names of backends, and what `num_envs` asks of them. Raises ValueError for impossible combinations."""
    one_of(sim.split(":")[0] if isinstance(sim, str) else sim, SIM_BACKENDS, "sim_backend")
    one_of(render.split(":")[0] if isinstance(render, str) else render or "none", RENDER_BACKENDS, "render_backend")
    import torch

    if num_envs > 1 and (sim in ("cpu", "physx_cpu") or not torch.cuda.is_available()):
        raise ValueError(
            f"num_envs must be 1 without a CUDA GPU, got {num_envs}; on a CPU, several environments run in processes: "
            f"hazard_ms.vector.make(..., num_envs={num_envs})"
        )


def render_mode(value: str | None, allowed: Iterable[str], display: str | None) -> None:
    """Check `render_mode`, which may be None. Raises ValueError for a window where there is no `display`."""
    if value == "human" and not display:
        names = ", ".join(m for m in allowed if m != "human")
        raise ValueError(f"render_mode must be one of {names} without a display (DISPLAY is not set), got 'human'")
    if value is not None:
        one_of(value, allowed, "render_mode")


def cameras(configs: Any) -> None:
    """Check the sizes of cameras in ManiSkill's `sensor_configs`. Raises ValueError for less than LEAST_PIXELS."""
    for part in (configs, *configs.values()) if isinstance(configs, dict) else ():
        for name in ("width", "height") if isinstance(part, dict) else ():
            if name in part:
                whole(part[name], LEAST_PIXELS, 2**15, f"{name} in sensor_configs")


def action(value: Any, num_envs: int, mode: str, sizes: Callable[[str], int], modes: Iterable[str] = ()) -> Any:
    """A low-level action as float32, [E, D]; None (no new command) stays None, a dict keeps its control mode.

    `mode` is the present control mode, `sizes` gives the length D of an action in each of the `modes`. Raises
    ValueError for another type or shape, and for numbers that are not finite in float32.
    """
    if value is None:
        return None
    if not isinstance(value, dict):
        return _commands(value, num_envs, mode, sizes(mode))
    if set(value) != {"control_mode", "action"}:
        raise ValueError(f"an action dict must have control_mode and action, got {sorted(map(str, value))}")
    mode = one_of(value["control_mode"], modes, "control_mode")
    return {"control_mode": mode, "action": _commands(value["action"], num_envs, mode, sizes(mode))}


def _commands(value: Any, num_envs: int, mode: str, size: int) -> Any:
    plain = type(value) is np.ndarray and value.dtype == np.float32
    if plain and num_envs == 1 and value.shape in ((size,), (1, size)):  # what most frames get
        made = value.reshape(1, size).copy()
        if np.isfinite(made).all():
            import torch

            return torch.from_numpy(made)
    given = numbers(value, "action")
    shapes = [(num_envs, size)] + ([(size,)] if num_envs == 1 else [])
    if tuple(given.shape) not in shapes:
        allowed = " or ".join(map(str, shapes))
        raise ValueError(f"action must have shape {allowed} in control mode {mode!r}, got {tuple(given.shape)}")
    made = given.float().reshape(num_envs, size)
    finite = made.isfinite()
    if not bool(finite.all()):
        worst = given.reshape(num_envs, size)[~finite][0].item()
        raise ValueError(f"action must hold numbers that are finite in float32, got {worst}")
    return made


def numbers(value: Any, what: str, flags: bool = False) -> Any:
    """An array or tensor of plain numbers, [...], as a tensor of its own; with `flags` also one of booleans.

    Raises ValueError for other types, for numbers of other types, and for tensors that are not dense.
    """
    import torch

    kinds = ("iufb" if flags else "iuf", PLAIN_DTYPES | {"bool"} if flags else PLAIN_DTYPES)
    if type(value) is np.ndarray and value.dtype == np.float32:
        return torch.from_numpy(value.copy(order="C"))
    if isinstance(value, np.ma.MaskedArray) or not isinstance(value, (np.ndarray, torch.Tensor)):
        raise ValueError(f"{what} must be a numpy array or a torch tensor, got {type(value).__name__}")
    if isinstance(value, torch.Tensor) and (value.layout is not torch.strided or value.is_nested or value.is_meta):
        raise ValueError(f"{what} must be a dense tensor with numbers in it, got {value.layout} on {value.device}")
    plain = value.dtype.kind in kinds[0] if isinstance(value, np.ndarray) else str(value.dtype)[6:] in kinds[1]
    if not plain:
        raise ValueError(f"{what} must hold floating-point or whole numbers, got dtype {value.dtype}")
    if isinstance(value, torch.Tensor):
        return value.detach().clone()
    # torch knows neither swapped bytes nor long double, nor the second name that numpy has for some types
    dtype = np.dtype(f"{value.dtype.kind}{min(value.dtype.itemsize, 8)}")
    made = np.empty(value.shape, dtype)
    with np.errstate(over="ignore"):
        made[...] = value
    return torch.from_numpy(made)
