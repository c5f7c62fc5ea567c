"""Boxes whose texture keeps its true size: floors and walls of any extent show the same planks and the same plaster."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import sapien

from hazard_ms.scenes.assets.index import asset, asset_ids, asset_path
from hazard_ms.scenes.materials import MATERIALS

TEXTURE_EDGE = 2.0  # edge of the square that one texture covers [m]
ROUGHNESS = {"tile": 0.35, "metal": 0.3, "glass": 0.1, "wood": 0.55}  # from 0 to 1; 0.85 for all other materials


@lru_cache(maxsize=64)
def _texture(name: str) -> Any:
    """The texture of a shell material, or None where the assets have none."""
    if name not in asset_ids(kind="texture"):
        return None
    return sapien.render.RenderTexture2D(str(asset_path(asset(name).visual)), mipmap_levels=6)


def surface_material(name: str) -> sapien.render.RenderMaterial:
    """A new render material for the shell material `name`: textured if the assets have a texture, else plain."""
    glow = [0.55, 0.7, 0.85, 1.0] if name == "glass" else [0.0, 0.0, 0.0, 0.0]  # daylight behind panes
    material = sapien.render.RenderMaterial(
        base_color=[*MATERIALS[name], 1.0], roughness=ROUGHNESS.get(name, 0.85), specular=0.3, emission=glow
    )
    texture = _texture(name)
    if texture is not None:
        material.base_color_texture = texture
    return material


def textured_box(size: tuple[float, float, float], material: sapien.render.RenderMaterial) -> Any:
    """A box of `size` [m] around its origin, with texture coordinates in units of TEXTURE_EDGE."""
    vertices: list[np.ndarray] = []
    normals: list[np.ndarray] = []
    uvs: list[list[float]] = []
    triangles: list[list[int]] = []
    half = np.array(size) / 2
    for axis in range(3):
        u, v = [(1, 2), (0, 2), (0, 1)][axis]
        for side in (-1.0, 1.0):
            first = len(vertices)
            for su, sv in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                corner = np.zeros(3)
                corner[axis], corner[u], corner[v] = side * half[axis], su * half[u], sv * half[v]
                vertices.append(corner)
                normals.append(np.eye(3)[axis] * side)
                uvs.append([(corner[u] + half[u]) / TEXTURE_EDGE, (corner[v] + half[v]) / TEXTURE_EDGE])
            flip = (side > 0) == (axis == 1)  # counter-clockwise as seen from outside
            quad = [[0, 2, 1], [0, 3, 2]] if flip else [[0, 1, 2], [0, 2, 3]]
            triangles += [[first + i for i in t] for t in quad]
    return sapien.render.RenderShapeTriangleMesh(
        np.array(vertices, np.float32),
        np.array(triangles, np.uint32),
        np.array(normals, np.float32),
        np.array(uvs, np.float32),
        material,
    )
