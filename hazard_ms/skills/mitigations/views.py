"""Places on the floor with a view of something that no wall hides, and the one with the shortest way to it."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.simulation.walls import blocked
from hazard_ms.skills.context import Stage
from hazard_ms.skills.motor.navigation import Ways

Array = NDArray[np.float64]
SIDES = 16  # directions from the thing in which places are tried [ours]
MARGIN = 0.1  # to each side of what has a view, which must have it, too [m] [ours]
CLOSE = 0.1  # distance from a place at which one stands on it [m] [ours]
ENOUGH = 0.3  # the same where an obstacle is on it [m] [ours]

Place = tuple[float, float]  # [m], world frame


def in_view(stage: Stage, places: Array, aim: Array) -> NDArray[np.bool_]:
    """Whether no wall is between each of `places` [m], [P, 3], and `aim` [m], [3], world frame: [P]."""
    device = stage.world.device
    ends = (torch.as_tensor(p[None], dtype=torch.float32, device=device) for p in (places, aim[None]))
    return np.asarray(~blocked(stage.world.walls, *ends)[0, :, 0].cpu().numpy())


def facing(places: Array, aim: Array, held: Array) -> Array:
    """Places of what is held once the robot at each of `places` [m], [P, 2], faces `aim` [m], [3]: [P, 3].

    `held` [m], [3]: ahead of the middle of the base, to its left, and over the floor.
    """
    way = aim[:2] - places
    ahead = way / np.maximum(np.hypot(*way.T), 1e-9)[:, None]
    left = np.stack([-ahead[:, 1], ahead[:, 0]], axis=-1)
    return np.concatenate([places + held[0] * ahead + held[1] * left, np.full((len(places), 1), held[2])], axis=1)


def sees(stage: Stage, places: Array, aim: Array, held: Array) -> NDArray[np.bool_]:
    """Whether the robot at each of `places` [m], [P, 2], has a view of `aim`, with MARGIN on both sides: [P].

    Arguments as for `facing`.
    """
    right, left = (in_view(stage, facing(places, aim, held + (0.0, side, 0.0)), aim) for side in (-MARGIN, MARGIN))
    return right & left


def nearest_view(
    stage: Stage, aim: Array, distances: Sequence[float], held: Array, without: Collection[Place] = ()
) -> Place | None:
    """The place with the shortest way to it from which `aim` [m], [3], world frame, is in view; None for none.

    Places are `distances` [m] from `aim`, on explored floor; what is `held`, as for `facing`, has the view. Those in
    `without`, and to which no way leads over the map, do not count.
    """
    angles = np.arange(SIDES) * 2.0 * np.pi / SIDES
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    places = np.concatenate([aim[:2] + distance * ring for distance in distances])
    seen = stage.seen
    column, row = np.floor((places - seen.origin) / seen.cell).astype(np.int64).T
    inside = (np.minimum(row, column) >= 0) & (np.maximum(row, column) < len(seen.explored))
    places = places[inside][seen.explored[row[inside], column[inside]]]
    found = [(float(x), float(y)) for x, y in places[sees(stage, places, aim, held)]]
    found = [place for place in found if place not in without]
    if not found:
        return None
    x, y, _ = stage.robot.base()
    # two goals at least: one search for all
    ways = Ways(
        stage.obstacles(),
        seen.explored,
        seen.cell,
        seen.origin,
        (x, y),
        [*found, found[0]],
        stage.robot.build.radius,
    )
    lengths = [_length(ways, place) for place in found]
    best = int(np.argmin(lengths))
    return found[best] if np.isfinite(lengths[best]) else None


def _length(ways: Ways, place: Place) -> float:
    path = ways.path(place, CLOSE, ENOUGH)
    return path.length if path is not None and path.short <= ENOUGH else float("inf")
