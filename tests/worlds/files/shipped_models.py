"""The shipped models as meshes, read for tests in another way than the package does."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import trimesh

from hazard_ms.scenes.assets.index import asset, asset_ids, asset_path
from hazard_ms.scenes.assets.rows import Asset


def models() -> list[Asset]:
    return [asset(i) for i in asset_ids() if asset(i).visual.endswith(".glb")]


@cache
def mesh_of(file: str) -> trimesh.Trimesh:
    """Vertices and faces of a file, transforms applied, in one mesh."""
    scene = trimesh.load_scene(asset_path(file), process=False)
    parts = scene.dump()
    starts = np.cumsum([0] + [len(p.vertices) for p in parts])
    faces = np.concatenate([p.faces + s for p, s in zip(parts, starts[:-1], strict=True)])
    return trimesh.Trimesh(np.concatenate([p.vertices for p in parts]), faces, process=False)


@cache
def hulls_of(file: str) -> list[trimesh.Trimesh]:
    whole = trimesh.load(asset_path(file), force="mesh", process=False)
    return list(whole.split(only_watertight=False))


def collision_bounds(a: Asset) -> np.ndarray:
    """Lowest and highest corner of the collision shapes [m], [2, 3]."""
    if a.hulls:
        return mesh_of(a.hulls).bounds
    boxes = np.array(a.boxes)
    return np.array([(boxes[:, :3] - boxes[:, 3:]).min(axis=0), (boxes[:, :3] + boxes[:, 3:]).max(axis=0)])


def collision_volume(a: Asset) -> float:
    """Volume of the collision shapes [m^3]; where they overlap it counts twice."""
    if a.hulls:
        return sum(h.convex_hull.volume for h in hulls_of(a.hulls))
    return float(sum(8 * np.prod(b[3:]) for b in a.boxes))


def crossings(mesh: trimesh.Trimesh, x: float, y: float) -> np.ndarray:
    """Heights [m] at which the vertical line through (x, y) meets the mesh."""
    a, b, c = (mesh.triangles[:, k] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        v = ((x - a[:, 0]) * (c[:, 1] - a[:, 1]) - (y - a[:, 1]) * (c[:, 0] - a[:, 0])) / area
        w = ((b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (b[:, 1] - a[:, 1]) * (x - a[:, 0])) / area
        hit = (np.abs(area) > 1e-12) & (v >= 0) & (w >= 0) & (v + w <= 1)
    return a[hit, 2] + v[hit] * (b[hit, 2] - a[hit, 2]) + w[hit] * (c[hit, 2] - a[hit, 2])


def images_of(path: Path) -> list[tuple[int, int]]:
    """Sizes of the pictures inside a GLB."""
    scene = trimesh.load_scene(path)
    materials = [g.visual.material for g in scene.geometry.values() if hasattr(g.visual, "material")]
    return [m.baseColorTexture.size for m in materials if getattr(m, "baseColorTexture", None) is not None]
