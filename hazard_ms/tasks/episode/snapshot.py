"""Saves and restores everything that ManiSkill's own state leaves out: hazards, damage, rescues, hands and chance.

All entries are tensors [E, N], so that ManiSkill can flatten, record and slice them. Seeds are stored as 16-bit words:
a flat state is float32, which holds whole numbers exactly only up to 2**24.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import torch
from torch import Tensor

from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.tasks.episode.members import Members

WORD = 1 << 16  # number of values of a 16-bit word


def save(episode: Episode) -> dict[str, Any]:
    """All records as tensors [E, N], by name."""
    world = episode.world
    made: dict[str, Any] = {
        name: {k: v.reshape(world.num_envs, -1) for k, v in part.save().items()} for name, part in episode.parts.items()
    }
    chance = world.chance
    words = torch.stack([chance.seed % WORD, chance.seed // WORD], dim=1)
    made["bodies"] = {
        "asleep": world.handles.asleep() if world.handles else torch.zeros(world.num_envs, 0, dtype=torch.bool)
    }
    made["chance"] = {"seed": words, "frame": chance.frame[:, None].clone()}
    return made


def restore(episode: Episode, saved: dict[str, Any], rows: Tensor) -> None:
    """Write the records `saved` by `save`, [R, N], into the environments `rows` [R], and all that follows from them."""
    world = episode.world
    episode.thaw(rows)
    for name, part in episode.parts.items():
        shapes = {k: v.shape[1:] for k, v in part.save().items()}
        part.restore({k: v.reshape(len(rows), *shapes[k]) for k, v in saved[name].items()}, rows)
    if "openings" in episode.parts:
        world.openings.apply()
    words = saved["chance"]["seed"]
    world.chance.restart(rows, words[:, 0] + words[:, 1] * WORD, saved["chance"]["frame"][:, 0])
    episode.sim_error[rows] = False  # only states of a sound simulation are restored
    world.safe[rows] = episode.rescue.safe[rows]
    world.away[rows] = episode.rescue.safe[rows] & episode.safe_place.carried
    index = torch.arange(world.num_bodies, device=world.device)
    world.held[rows] = index == episode.hand.held[rows][:, None]


def put_back(
    episode: Episode,
    members: Members,
    state: dict[str, Any],
    rows: Tensor,
    plain: Callable[[dict[str, Any]], None],
    controllers: Callable[[Any], None],
) -> None:
    """Restore a `state` from `get_state_dict` in the environments `rows` [R].

    `plain` restores ManiSkill's own part, `controllers` the states of controllers; `members`: the robots.
    The state must have been checked: what is wrong with it is found too late here.
    """
    world = episode.world
    restore(episode, state["hazard_ms"], rows)
    episode.loosen()
    plain({k: v for k, v in state.items() if k not in ("hazard_ms", "controller")})
    if "controller" in state:
        controllers(state["controller"])
    world.read()
    members.resume(rows)
    if world.handles is not None:
        world.handles.put_to_sleep(state["hazard_ms"]["bodies"]["asleep"])


def copied(state: Any) -> Any:
    """A copy of nested tensors, [E, ...] each."""
    return {k: copied(v) for k, v in state.items()} if isinstance(state, dict) else state.clone()


def unflatten(flat: Tensor, like: dict[str, Any]) -> dict[str, Any]:
    """The nested state that ManiSkill flattened into `flat`, [E, D] or [D], with the type of `flat`.

    `like` is any state of the same environment. Raises ValueError for a flat state of another length.
    """
    if flat.ndim not in (1, 2):
        raise ValueError(f"the flat state must have shape (E, D) or (D,), got {tuple(flat.shape)}")
    made, end = _take(flat, like, 0)
    if end != flat.shape[-1]:
        raise ValueError(f"the flat state must have {end} numbers, got {flat.shape[-1]}")
    return made


def _take(flat: Tensor, like: dict[str, Any], start: int) -> tuple[dict[str, Any], int]:
    made: dict[str, Any] = {}
    for name, entry in like.items():
        if isinstance(entry, dict):
            made[name], start = _take(flat, entry, start)
        else:
            width = entry.shape[-1]
            made[name] = flat[..., start : start + width]
            start += width
    return made, start
