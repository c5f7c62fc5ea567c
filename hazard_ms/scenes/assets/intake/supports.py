"""Finds the surfaces of a model on which things can be placed: level rectangles with free air above."""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.ndimage import binary_closing

GRID_STEP = 0.01  # edge of a cell of the map of a surface [m]
MOST_CELLS = 200  # along an edge: of large things the cells are larger
EDGE_MARGIN = 0.01  # kept free along the edges of a surface [m]
LEVEL = 0.006  # [m] faces within this of a height belong to it
OPEN = 2.0  # [m] clearance of a surface with nothing above it
LEAST_AIR = 0.1  # above a surface that is worth the name [m] [ours]
LEAST_EDGE = 0.1  # of a rectangle [m] [ours]
MOST = 6  # surfaces of a thing [ours]
POINTS = 200_000  # looked at on the model
SEED = 1  # of the points on the model


def supports(mesh: trimesh.Trimesh) -> list[dict[str, Any]]:
    """The surfaces of `mesh`, largest first, as the index holds them; in its own frame [m]."""
    points, faces = trimesh.sample.sample_surface(mesh, POINTS, seed=SEED)
    up = mesh.face_normals[faces, 2] > 0.9
    found = [rectangle(mesh, points, up, z) for z, _ in heights(mesh)[:MOST]]
    return [s for s in found if s is not None]


def heights(mesh: trimesh.Trimesh, least: float = 0.03) -> list[tuple[float, float]]:
    """Heights [m] at which at least `least` square metres look up, with that area, largest first."""
    up = mesh.face_normals[:, 2] > 0.98
    z, area = mesh.triangles_center[up, 2], mesh.area_faces[up]
    bins = np.round(z / LEVEL).astype(int)
    found = [
        (float(np.average(z[bins == b], weights=area[bins == b])), float(area[bins == b].sum()))
        for b in np.unique(bins)
    ]
    return sorted([f for f in found if f[1] >= least], key=lambda f: -f[1])


def rectangle(
    mesh: trimesh.Trimesh, points: NDArray[np.float64], up: NDArray[np.bool_], z: float
) -> dict[str, Any] | None:
    """The largest rectangle at the height `z` [m] with LEAST_AIR above it; None if it is smaller than LEAST_EDGE.

    `points`: on the model [m], [P, 3]; `up`: whether they look up, [P].
    """
    cell_size = max(GRID_STEP, float(mesh.extents[:2].max()) / MOST_CELLS)
    low = mesh.bounds[0, :2]
    shape = np.ceil(mesh.extents[:2] / cell_size).astype(int) + 1
    cell = ((points[:, :2] - low) / cell_size).astype(int)
    floor, blocked = np.zeros(shape, bool), np.zeros(shape, bool)
    floor[tuple(cell[up & (np.abs(points[:, 2] - z) < LEVEL)].T)] = True
    floor = binary_closing(np.pad(floor, 4), iterations=3)[4:-4, 4:-4]  # sampling leaves holes up to two cells wide
    blocked[tuple(cell[(points[:, 2] > z + LEVEL) & (points[:, 2] < z + LEAST_AIR)].T)] = True
    x0, x1, y0, y1 = largest(floor & ~blocked)
    top = mesh.bounds[1, :2]
    corner = low + cell_size * np.array([x0, y0]) + EDGE_MARGIN
    other = np.minimum(low + cell_size * np.array([x1, y1]), top) - EDGE_MARGIN
    if (other - corner).min() < LEAST_EDGE:
        return None
    inside = ((points[:, :2] > corner) & (points[:, :2] < other)).all(axis=1) & (points[:, 2] > z + LEVEL)
    air = float(points[inside, 2].min() - z) if inside.any() else OPEN
    sides = {"min": corner.round(3).tolist(), "max": other.round(3).tolist()}
    return {"z": round(z, 4), **sides, "clearance": round(min(air, OPEN), 3)}


def largest(mask: NDArray[np.bool_]) -> tuple[int, int, int, int]:
    """The largest all-true rectangle of `mask`, [X, Y], as half-open ranges x0, x1, y0, y1: indices of cells."""
    best, area = (0, 0, 0, 0), 0
    run = np.zeros(mask.shape[1], int)  # how many true cells end at this row, for each column
    for x, row in enumerate(mask):
        run = np.where(row, run + 1, 0)
        stack: list[tuple[int, int]] = []  # columns at which a rectangle of that height could begin, heights ascending
        for y, height in enumerate([*run.tolist(), 0]):
            start = y
            while stack and stack[-1][1] >= height:
                start, tall = stack.pop()
                if tall * (y - start) > area:
                    area, best = tall * (y - start), (x - tall + 1, x + 1, start, y)
            stack.append((start, height))
    return best
