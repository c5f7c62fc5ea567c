"""Save and restore everything that ManiSkill's own state leaves out: hazards, damage, rescue, hand and chance.

All entries are [E, k] tensors, so that ManiSkill can flatten, record and slice them. Seeds are stored in 16-bit words: a flat state is
float32, which holds whole numbers exactly only up to 2**24.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import torch
from torch import Tensor

if TYPE_CHECKING:
    from hazard_ms.env import HazardEnv

WORD = 1 << 16


def save(env: HazardEnv) -> dict[str, Any]:
    """All records as [E, k] tensors."""
    made: dict[str, Any] = {
        name: {k: v.reshape(env.num_envs, -1) for k, v in part.save().items()} for name, part in env.episode.parts.items()
    }
    chance = env.world.chance
    words = torch.stack([chance.seed % WORD, chance.seed // WORD], dim=1)
    made["bodies"] = {"asleep": env.world.handles.asleep() if env.world.handles else torch.zeros(env.num_envs, 0, dtype=torch.bool)}
    made["chance"] = {"seed": words, "frame": chance.frame[:, None].clone()}
    return made


def restore(env: HazardEnv, saved: dict[str, Any] | None, rows: Tensor) -> None:
    """Write `saved` into the environments `rows`, and what follows from it into the world. Nothing is written if anything is amiss."""
    if saved is None:
        raise ValueError("the state has no entry 'hazard_ms': it is not one that get_state_dict of this environment gave")
    episode, ready = env.episode, {}
    for name, part in episode.parts.items():
        now = part.save()
        if set(saved.get(name, {})) != set(now):
            raise ValueError(f"the state's {name!r} has {sorted(saved.get(name, {}))}; this environment needs {sorted(now)}")
        sizes = {k: v[0].numel() for k, v in now.items()}
        for k, size in sizes.items():
            if torch.as_tensor(saved[name][k]).numel() != size * len(rows):
                raise ValueError(
                    f"the state's {name}.{k} is of another scene: this environment needs {size} numbers for each of {len(rows)}"
                )
        ready[name] = {k: torch.as_tensor(saved[name][k]).reshape(len(rows), *now[k].shape[1:]) for k in now}
    episode.thaw(rows)
    for name, part in episode.parts.items():
        part.restore(ready[name], rows)
    chance, words = env.world.chance, torch.as_tensor(saved["chance"]["seed"]).reshape(len(rows), 2).long()
    chance.seed[rows] = (words[:, 0] + words[:, 1] * WORD).to(chance.seed)
    chance.frame[rows] = torch.as_tensor(saved["chance"]["frame"]).reshape(len(rows)).to(chance.frame)
    env._elapsed_steps[rows] = chance.frame[rows].to(env._elapsed_steps)
    episode.sim_error[rows] = False  # what is restored was good
    env.world.safe[rows] = episode.rescue.safe[rows]
    env.world.away[rows] = episode.rescue.safe[rows] & (episode.carts is None)
    index = torch.arange(env.world.num_bodies, device=env.device)
    env.world.held[rows] = index == episode.hand.held[rows][:, None]


def put_back(env: HazardEnv, state: dict[str, Any], env_idx: Tensor | None, plain: Callable[..., None]) -> None:
    """Restore what `get_state_dict` gave; `plain`: ManiSkill's own way of doing it."""
    rows = torch.arange(env.num_envs, device=env.device) if env_idx is None else env_idx
    state = batched(state)
    restore(env, state.get("hazard_ms"), rows)
    plain({k: v for k, v in state.items() if k not in ("hazard_ms", "controller")}, env_idx)
    if "controller" in state:
        env.agent.set_controller_state(state["controller"])
    env.world.read()
    env._read_agent()
    env.episode.freeze(env.agent.gripper_pose())
    if env.world.handles is not None:
        env.world.handles.put_to_sleep(torch.as_tensor(state["hazard_ms"]["bodies"]["asleep"]))


def batched(state: Any) -> Any:
    """`state` with a batch axis before every entry that has none: recorded states of one environment come without."""
    if isinstance(state, dict):
        return {k: batched(v) for k, v in state.items()}
    value = torch.as_tensor(state)
    return value[None] if value.ndim == 1 else value


def unflatten(flat: Tensor, like: dict[str, Any]) -> dict[str, Any]:
    """The nested state that ManiSkill flattened into `flat`, [E, D]; `like` is any state of the same environment."""
    made, end = _take(flat, like, 0)
    if end != flat.shape[-1]:
        raise ValueError(f"the flat state has {flat.shape[-1]} numbers; this environment's has {end}")
    return made


def _take(flat: Tensor, like: dict[str, Any], start: int) -> tuple[dict[str, Any], int]:
    made: dict[str, Any] = {}
    for name, entry in like.items():
        if isinstance(entry, dict):
            made[name], start = _take(flat, entry, start)
        else:
            width = entry.shape[-1]
            made[name] = flat[..., start : start + width].to(entry.dtype)
            start += width
    return made, start
