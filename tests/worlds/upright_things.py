"""The space that things of a scene occupy, and what they stand on, computed in another way than the package does."""

from __future__ import annotations

import math

import numpy as np

from hazard_ms.scenes.assets.index import asset
from hazard_ms.spec import Body, Fixture, SceneSpec


def corners(thing: Body | Fixture) -> np.ndarray:
    """The eight corners of what a thing occupies [m], [8, 3], by the full rotation matrix."""
    x, y, z = np.array(asset(thing.asset).extent) * thing.scale
    box = np.array([[i * x / 2, j * y / 2, k * z] for i in (-1, 1) for j in (-1, 1) for k in (0, 1)])
    return box @ rotation(thing).T + thing.position


def rotation(thing: Body | Fixture) -> np.ndarray:
    w, v = thing.rotation[0], np.array(thing.rotation[1:])
    skew = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + 2 * w * skew + 2 * skew @ skew


def gap(a: np.ndarray, b: np.ndarray) -> float:
    """Distance of two boxes, given by corners, along the best of the 15 separating axes [m].

    Negative: they overlap.
    """
    edges = [[box[4] - box[0], box[2] - box[0], box[1] - box[0]] for box in (a, b)]
    axes = [*edges[0], *edges[1], *(np.cross(e, f) for e in edges[0] for f in edges[1])]
    best = -math.inf
    for axis in axes:
        length = np.linalg.norm(axis)
        if length > 1e-9:
            p, q = a @ axis / length, b @ axis / length
            best = max(best, q.min() - p.max(), p.min() - q.max())
    return best


def radius_2d(thing: Body | Fixture) -> float:
    return math.hypot(*asset(thing.asset).extent[:2]) / 2


def standing_on(spec: SceneSpec, body: Body) -> list[str]:
    """Names of what is just below the body: fixtures with a support there, or the floor."""
    found = ["floor"] if abs(body.position[2]) <= 0.002 else []
    for f in spec.fixtures:
        for s in asset(f.asset).supports:
            local = (corners(body) - f.position) @ rotation(f)  # into the fixture's frame
            inside = (local[:, :2] >= np.array(s.min) - 1e-6).all() and (local[:, :2] <= np.array(s.max) + 1e-6).all()
            if inside and 0.0 <= body.position[2] - (f.position[2] + s.z) <= 0.002:
                found.append(f.name)
    return found
