"""Finds where things can be placed on a model: level rectangles with free air above."""

from __future__ import annotations

import numpy as np
import trimesh

CELL = 0.01  # [m]
MARGIN = 0.01  # kept free along the edges of a surface [m]
LEVEL = 0.006  # [m] faces within this of a height belong to it
OPEN = 2.0  # [m] clearance of a surface with nothing above it


def heights(mesh: trimesh.Trimesh, least: float = 0.03) -> list[tuple[float, float]]:
    """Heights [m] at which at least `least` square metres look up, with that area, largest first."""
    up = mesh.face_normals[:, 2] > 0.98
    z = mesh.triangles_center[up, 2]
    area = mesh.area_faces[up]
    bins = np.round(z / LEVEL).astype(int)
    found = [(float(np.average(z[bins == b], weights=area[bins == b])), float(area[bins == b].sum())) for b in np.unique(bins)]
    return sorted([f for f in found if f[1] >= least], key=lambda f: -f[1])


def support(mesh: trimesh.Trimesh, z: float, clearance: float) -> dict[str, object]:
    """The largest rectangle at the height `z` [m] with at least `clearance` metres of air, in the asset frame."""
    points, faces = trimesh.sample.sample_surface(mesh, 200_000, seed=1)
    up = mesh.face_normals[faces, 2] > 0.9
    low = mesh.bounds[0, :2]
    shape = np.ceil(mesh.extents[:2] / CELL).astype(int) + 1
    cell = ((points[:, :2] - low) / CELL).astype(int)
    floor, blocked = np.zeros(shape, bool), np.zeros(shape, bool)
    on = up & (abs(points[:, 2] - z) < LEVEL)
    floor[tuple(cell[on].T)] = True
    floor = _close(floor)
    above = (points[:, 2] > z + LEVEL) & (points[:, 2] < z + clearance)
    blocked[tuple(cell[above].T)] = True
    x0, x1, y0, y1 = _largest(floor & ~blocked)
    corner, other = low + CELL * np.array([x0, y0]) + MARGIN, low + CELL * np.array([x1, y1]) - MARGIN
    inside = ((points[:, :2] > corner) & (points[:, :2] < other)).all(axis=1) & (points[:, 2] > z + LEVEL)
    air = float(points[inside, 2].min() - z) if inside.any() else OPEN
    return {
        "z": round(z, 4),
        "min": corner.round(3).tolist(),
        "max": other.round(3).tolist(),
        "clearance": round(air, 3),
    }


def _close(mask: np.ndarray) -> np.ndarray:
    """Fills the holes that sampling leaves, up to two cells wide."""
    from scipy.ndimage import binary_closing

    padded = np.pad(mask, 4)
    return binary_closing(padded, iterations=3)[4:-4, 4:-4]


def _largest(mask: np.ndarray) -> tuple[int, int, int, int]:
    """Largest all-true rectangle, as half-open ranges x0, x1, y0, y1."""
    best, area = (0, 0, 0, 0), 0
    run = np.zeros(mask.shape[1], int)
    for x, row in enumerate(mask):
        run = np.where(row, run + 1, 0)
        for y in range(len(run)):
            least = run[y]
            for end in range(y, len(run)):
                least = min(least, run[end])
                if least == 0:
                    break
                if least * (end - y + 1) > area:
                    area, best = least * (end - y + 1), (x - least + 1, x + 1, y, end + 1)
    return best
