"""The part of a convex body under a plane, in float64 and by no formula of the package.

The corners below and all cuts, in a hull.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

Points = NDArray[np.float64]


def box(half: Points) -> Points:
    """The corners of a box of half edges `half` [m]."""
    return np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float) * half


def cylinder(half: Points, sides: int = 48) -> Points:
    """An upright prism of the cylinder's volume."""
    angle = np.arange(sides) * 2 * np.pi / sides
    out = np.sqrt(2 * np.pi / sides / np.sin(2 * np.pi / sides))
    ring = out * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.array([[x, y, z] for x, y in ring for z in (-1, 1)]) * half


def turned(points: Points, quaternion: Points, centre: Points) -> Points:
    """`points` turned by w x y z and moved."""
    return Rotation.from_quat(np.roll(quaternion, -1)).apply(points) + centre


def below(points: Points, level: float, slope: tuple[float, float] = (0.0, 0.0)) -> tuple[float, Points]:
    """Volume [m^3] and middle [m] of the part of the convex hull of `points` under z = level + slope . (x, y)."""
    above = points[:, 2] - level - points[:, :2] @ np.array(slope)
    low, high = points[above <= 0], points[above > 0]
    a, b = above[above <= 0], above[above > 0]
    share = a[:, None] / (a[:, None] - b[None])
    cuts = low[:, None] + share[..., None] * (high[None] - low[:, None])
    kept = np.concatenate([low, cuts.reshape(-1, 3)])
    if len(low) == 0:
        return 0.0, np.zeros(3)
    return solid(kept)


def solid(points: Points) -> tuple[float, Points]:
    """Volume and middle of the convex hull of `points`: the sum over its faces of tetrahedra with one corner inside."""
    inside = points.mean(0)
    hull = ConvexHull(points, qhull_options="QJ Pp" if len(points) > 400 else "Qt Pp")
    faces = points[hull.simplices] - inside
    volume = np.abs(np.linalg.det(faces)) / 6
    return float(volume.sum()), inside + (volume[:, None] * faces.sum(1) / 4).sum(0) / volume.sum()
