"""Collision shapes of a model: a few convex hulls that stand on a flat foot, within the limits of PhysX."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import coacd
import numpy as np
import trimesh
from numpy.typing import NDArray

MAX_VERTICES = 64  # of a convex hull: PhysX on the GPU takes no more
MAX_HULLS = 8  # of a model [ours]
MIN_THICKNESS = 0.006  # [m] thinner shapes slip through floors at 120 Hz
FOOT = 0.03  # of the height: what lies lower is pressed flat, so that things stand and do not roll
UNEVEN = 0.005  # hulls are drawn in by up to this share, by chance
COARSE_CELLS = 96  # along the longest edge: the mesh is coarsened so far before it is taken apart [ours]
SEED = 1  # of all random choices here
FAST = {  # about ten times faster than CoACD's defaults, a quarter of the hulls
    "threshold": 0.1,
    "max_convex_hull": MAX_HULLS,
    "preprocess_resolution": 30,
    "resolution": 1000,
    "mcts_iterations": 60,
    "mcts_nodes": 12,
    "mcts_max_depth": 2,
    "max_ch_vertex": MAX_VERTICES,
    "decimate": True,
    "seed": SEED,
}

Points = NDArray[np.float64]


def decompose(mesh: trimesh.Trimesh) -> list[trimesh.Trimesh]:
    """Convex hulls that cover `mesh` [m] within its bounds. Raises ValueError if the limits allow none."""
    low, high = np.array(mesh.bounds[0]), np.array(mesh.bounds[1])
    rough = coarse(mesh)
    clouds = [np.asarray(mesh.vertices)]
    if len(rough.faces) >= 4 and rough.extents.min() > 0.0:
        coacd.set_log_level("error")
        clouds = [np.asarray(v) for v, _ in coacd.run_coacd(coacd.Mesh(rough.vertices, rough.faces), **FAST)]
    high = np.maximum(high, low + [0.0, 0.0, MIN_THICKNESS])
    hulls = [_hull(np.clip(cloud, low, high), low, high) for cloud in clouds if len(cloud) > 3]
    if not 0 < len(hulls) <= MAX_HULLS or any(len(h.vertices) > MAX_VERTICES or h.volume <= 0.0 for h in hulls):
        raise ValueError(
            f"a model must split into 1 to {MAX_HULLS} convex pieces of at most {MAX_VERTICES} corners each, got "
            f"{len(hulls)} pieces"
        )
    return hulls


def coarse(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """The mesh with its corners merged in cubes of its longest edge / COARSE_CELLS.

    Without this, CoACD takes minutes for 100,000 triangles.
    """
    cell = float(mesh.extents.max()) / COARSE_CELLS
    _, first, of = np.unique(np.round(mesh.vertices / cell).astype(int), axis=0, return_index=True, return_inverse=True)
    faces = of.ravel()[mesh.faces]
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    faces = faces[np.unique(np.sort(faces, axis=1), axis=0, return_index=True)[1]]
    return trimesh.Trimesh(mesh.vertices[first], faces, process=False)


def _hull(points: Points, low: Points, high: Points) -> trimesh.Trimesh:
    """Convex hull of at most MAX_VERTICES of `points`; its lowest part becomes a flat foot at the height low[2]."""
    near = points[:, 2] < low[2] + max(0.001, FOOT * (high[2] - low[2]))
    foot = points[near] * [1, 1, 0] + [0, 0, low[2]]
    body = points[~near]
    if len(body) == 0 or np.ptp(points[:, 2]) < MIN_THICKNESS:  # too thin: a slab as high as is needed
        body = points * [1, 1, 0] + [0, 0, min(low[2], points[:, 2].min()) + MIN_THICKNESS]
    chosen = body[_extreme(body, _sphere(40))]
    # points in one plane can crash PhysX's cooking
    inward = np.random.default_rng(SEED).uniform(0.0, UNEVEN, (len(chosen), 1))
    chosen = chosen + inward * (chosen.mean(axis=0) - chosen)
    if len(foot):
        angle = np.linspace(0, 2 * np.pi, 16, endpoint=False)
        chosen = np.vstack([chosen, foot[_extreme(foot, np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1))]])
    return trimesh.Trimesh(np.unique(chosen.round(5), axis=0), [], process=False).convex_hull


def _extreme(points: Points, directions: Points) -> NDArray[np.int64]:
    """Indices of the points that reach farthest in each direction."""
    return np.unique((points @ directions.T).argmax(axis=0))


def _sphere(count: int) -> Points:
    """Directions spread over the sphere (Fibonacci lattice), and the six axes."""
    k = np.arange(count) + 0.5
    z, angle = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    r = np.sqrt(1 - z**2)
    return np.vstack([np.stack([r * np.cos(angle), r * np.sin(angle), z], 1), np.eye(3), -np.eye(3)])


def write(hulls: list[trimesh.Trimesh], path: Path) -> None:
    """Write one PLY file whose connected pieces are the hulls: SAPIEN makes a convex shape of each.

    It is in words: SAPIEN's reader of binary ones skips a first byte that is a line feed, -0.04 m for example, and
    crashes.
    """
    whole: Any = trimesh.util.concatenate(hulls)
    path.write_bytes(whole.export(file_type="ply", vertex_normal=False, encoding="ascii"))


def cook(path: Path) -> int:
    """The number of convex shapes that PhysX makes of the hulls in `path`.

    Degenerate hulls can crash PhysX: call this in a process of its own.
    """
    import sapien

    material = sapien.physx.PhysxMaterial(0.5, 0.5, 0.0)
    return len(sapien.physx.PhysxCollisionShapeConvexMesh.load_multiple(str(path), [1, 1, 1], material))
