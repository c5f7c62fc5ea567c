"""Things as solids: size, mass and parts, boxes turned in any way, the distance of two. All lengths are in metres."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.boxes import matrix_of
from hazard_ms.spec import Body, Fixture

Corners = NDArray[np.float64]  # [8, 3]; corner 4 i + 2 j + k is at the ends i, j, k of the box's own axes

_UNIT = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (0.0, 1.0)])


def corners_of(thing: Body | Fixture) -> Corners:
    """The corners of the box around a thing, turned like it, in the world [m], [8, 3]."""
    size = np.array(asset(thing.asset).extent) * thing.scale
    return np.asarray((_UNIT * size) @ matrix_of(thing.rotation).T + thing.position)


def extent_of(thing: Body | Fixture) -> tuple[float, float, float]:
    """Edge lengths of the thing's box along its own axes [m]."""
    x, y, z = (size * factor for size, factor in zip(asset(thing.asset).extent, thing.scale, strict=True))
    return x, y, z


def half_size(thing: Body | Fixture) -> NDArray[np.float64]:
    """Half the edge lengths of the box around a thing, along its own axes [m], [3]."""
    return np.asarray(np.array(asset(thing.asset).extent) * thing.scale / 2)


def mass_of(thing: Body | Fixture) -> float:
    """Mass of the thing [kg]: the scene's own, else the asset's, scaled with its volume."""
    if isinstance(thing, Body) and thing.mass is not None:
        return thing.mass
    return asset(thing.asset).mass * float(np.prod(thing.scale))


def parts_of(thing: Body | Fixture) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """The boxes that a thing's model is made of, turned like it: middles in the world and half sizes [m], [3] each.

    A model that has none is the box around it.
    """
    turn, (x, y, z) = matrix_of(thing.rotation), np.array(asset(thing.asset).extent) / 2
    boxes = np.array(asset(thing.asset).boxes or [(0.0, 0.0, z, x, y, z)])
    middles = (boxes[:, :3] * thing.scale) @ turn.T + thing.position
    return list(zip(middles, boxes[:, 3:] * thing.scale, strict=True))


def gap(a: Corners, b: Corners) -> float:
    """The distance of two boxes, [8, 3] each, along the axis that parts them best [m]; negative if they overlap."""
    edges = [box[[4, 2, 1]] - box[0] for box in (a, b)]
    axes = np.concatenate([*edges, np.cross(edges[0][:, None], edges[1][None]).reshape(-1, 3)])
    length = np.linalg.norm(axes, axis=1)
    axes = axes[length > 1e-9] / length[length > 1e-9, None]
    p, q = a @ axes.T, b @ axes.T
    return float(np.maximum(q.min(0) - p.max(0), p.min(0) - q.max(0)).max())
