"""The state in which the hazards have brought each thing: the attributes of annotations.

They are read from the quantities that the hazards themselves declare, so that those of third parties are captured, too:
each hazard adds its level at the thing, under its own name.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from hazard_ms.simulation.world import rotate

STATUS = ("normal", "burning", "burnt")  # the meaning of a fire's quantity `status`
MOVING = 0.05  # speed from which a thing counts as moving [m/s] [ours]
OFF_THE_FLOOR = 0.01  # height of its base from which a thing in water floats [m] [ours]
EDGES = torch.tensor([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])  # corners of a box
LAYERS = 32  # of a box whose share under water is asked for, along each edge [ours]


class Watch:
    """A record of what only the whole episode tells: which things were ever under water."""

    def __init__(self, env: Any) -> None:
        """Watch the first environment of `env` from now on."""
        self._env = env
        self.wet = torch.zeros(env.world.num_bodies, dtype=torch.bool)

    def look(self) -> None:
        """Note what is under water now."""
        self.wet |= submerged(self._env.world) > 0.0


def submerged(world: Any) -> Tensor:
    """Share of each thing's box that is below the water, float32 [B], in the first scene; 0 without a flood."""
    position, rotation, extent = world.position[0].cpu(), world.rotation[0].cpu(), world.extent[0].cpu()
    if "water" not in world.fields:
        return torch.zeros(len(position))
    level = world.fields["water"](world.position)[0].cpu()
    corners = position[:, None] + rotate(rotation[:, None].expand(-1, 8, -1), EDGES * extent[:, None])
    low, high = corners[..., 2].amin(1), corners[..., 2].amax(1)
    share = ((level - low) / (high - low).clamp(min=1e-6)).clamp(0.0, 1.0)
    cut = torch.nonzero((share > 0.0) & (share < 1.0) & (level > 0.0)).flatten()
    if len(cut):  # the corners' share is that of an upright box; a tilted one is counted point by point
        edge = (torch.arange(LAYERS) + 0.5) / LAYERS - 0.5
        points = torch.cartesian_prod(edge, edge, edge)  # [P, 3]
        for b in cut.tolist():
            if not _upright(rotation[b]):
                placed = rotate(rotation[b].expand(len(points), 4), points * extent[b])
                share[b] = float((placed[:, 2] + position[b, 2] < level[b]).float().mean())
    return torch.where(level > 0.0, share, 0.0) * world.exists[0].cpu()


def _upright(rotation: Tensor) -> bool:
    """Whether a box is turned about the vertical axis alone."""
    return float(rotation[1].abs() + rotation[2].abs()) < 1e-3


def attributes(env: Any, watch: Watch) -> list[dict[str, Any]]:
    """The state of each thing of the first environment now, [B] rows."""
    world, episode = env.world, env.episode
    under, speed = submerged(world), world.velocity[0].norm(dim=-1).cpu()
    corners = world.position[0, :, None] + rotate(
        world.rotation[0, :, None].expand(-1, 8, -1), EDGES.to(world.device) * world.extent[0, :, None]
    )
    base = corners[..., 2].amin(1).cpu()
    floating = world.movable[0].cpu() & (under > 0.0) & (base > OFF_THE_FLOOR)
    columns: dict[str, list[Any]] = {
        "target": world.target[0].tolist(),
        "wet": (watch.wet | (under > 0.0)).tolist(),
        "submerged": _rounded(under, 4),
        "floating": floating.tolist(),
        "speed_mps": _rounded(speed, 4),
        "damaged": episode.damage.damaged[0].tolist(),
        "held": world.held[0].tolist(),
        **_of_fire(env),
    }
    levels = episode.levels(world.position)[0].cpu()
    names = [hazard.name for hazard in episode.hazards]
    told = [_rounded(row, 3) for row in levels]
    return [
        {**{key: column[b] for key, column in columns.items()}, "levels": dict(zip(names, values, strict=True))}
        for b, values in enumerate(zip(*told, strict=True))
    ]


def _of_fire(env: Any) -> dict[str, list[Any]]:
    """Temperature, status and share of the burning time that is over; those of air and intact things without a fire."""
    bodies = env.world.num_bodies
    made: dict[str, list[Any]] = {"temperature_c": [None] * bodies, "status": [STATUS[0]] * bodies}
    made["burn_share"] = [0.0] * bodies
    for hazard in env.episode.hazards:
        state = env.episode.states[hazard.name]
        if not all(hasattr(state, name) for name in ("temperature", "status", "burn_updates")):
            continue
        made["temperature_c"] = _rounded(state.temperature[0], 2)
        made["status"] = [STATUS[s] for s in state.status[0].tolist()]
        if hasattr(state, "burn_age"):  # the realistic fire counts in seconds
            share = state.burn_age[0] / state.burn_end[0]
        else:
            share = state.burn_updates[0] / hazard.burn_updates
        made["burn_share"] = _rounded(share.clamp(0.0, 1.0), 4)
    return made


def _rounded(values: Tensor, digits: int) -> list[float | None]:
    """Numbers with so many digits, None for those that are not finite."""
    return [round(v, digits) if abs(v) < 1e30 else None for v in values.double().cpu().tolist()]


def stirred(row: dict[str, Any]) -> bool:
    """Whether a hazard can be seen at work on a thing: it burns, is under water, or moves."""
    return row["status"] == "burning" or row["submerged"] > 0.0 or row["speed_mps"] > MOVING
