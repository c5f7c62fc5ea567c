"""Surfaces that do not face the camera, as meshes for a ray-traced picture: water with its waves, and soot."""

from __future__ import annotations

import numpy as np
from sapien.render import RenderMaterial, RenderShapeTriangleMesh

from hazard_ms.effects.meshes import unit
from hazard_ms.effects.raytracing import hits

TRANSPARENT, REFRACTION, SMOOTH = 0.97, 1.33, 0.02  # water's transmission, index of refraction, roughness
WATER_TINT = (0.86, 0.94, 0.93)  # linear, of water at its surface [ours]
WAVE_CELL = 0.06  # of the water's mesh [m] [ours]
MOST_CELLS = 160  # of it along one side of a piece of water
WAVES = 7  # sines that make up the surface [ours]
WAVE_SLOPE = 0.022  # of each sine [ours]

Array = np.ndarray


def shape(
    vertices: Array, faces: Array, normals: Array, places: Array, material: RenderMaterial
) -> RenderShapeTriangleMesh:
    """A mesh with its faces side by side, in which rays find them many times faster."""
    faces = faces[side_by_side(vertices[faces].mean(1))]
    data = (
        np.ascontiguousarray(a, t)
        for a, t in ((vertices, np.float32), (faces, np.uint32), (normals, np.float32), (places, np.float32))
    )
    return RenderShapeTriangleMesh(*data, material)


def side_by_side(points: Array) -> Array:
    """The order, [P] indices, of points, [P, 3], in which each half, half of a half, and so on, is beside the other.

    Mesa's lavapipe puts triangles into its tree as they come; graphics cards sort them anyway.
    """
    order, place = np.arange(len(points)), np.arange(len(points))
    size = 1 << max(len(points) - 1, 0).bit_length()
    while size > 1:
        here, group, first = points[order], place // size, np.arange(0, len(points), size)
        extent = np.maximum.reduceat(here, first) - np.minimum.reduceat(here, first)
        order = order[np.lexsort((here[place, extent.argmax(1)[group]], group))]
        size //= 2
    return order


def water(vertices: Array, data: Array, place: Array, pose: Array, time: float) -> RenderShapeTriangleMesh:
    """The surface: the hazard's level at its corners, then finer cells with waves."""
    level = pose[2, 3] - pose[1, 0] / max(pose[0, 0], 1e-3) * data[:, 0]
    corners = np.column_stack([place, level]).reshape(-1, 4, 3)
    points, faces, first = [], [], 0
    for a, b, c, d in corners:
        if max(a[2], b[2], c[2], d[2]) <= 0.0:
            continue
        wide, deep = (int(np.clip(np.ceil(np.linalg.norm(e[:2] - a[:2]) / WAVE_CELL), 1, MOST_CELLS)) for e in (b, d))
        u, v = np.meshgrid(np.linspace(0, 1, wide + 1), np.linspace(0, 1, deep + 1))
        weights = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], -1).reshape(-1, 4)
        points.append(weights @ np.stack([a, b, c, d]))
        corner = (np.arange(deep)[:, None] * (wide + 1) + np.arange(wide)[None]).reshape(-1, 1)
        faces.append(first + (corner + np.array([[0, 1, wide + 2, 0, wide + 2, wide + 1]])).reshape(-1, 3))
        first += len(points[-1])
    grid = np.concatenate(points)
    normal = _waves(grid, time)
    material = RenderMaterial(base_color=[*WATER_TINT, 1.0], roughness=SMOOTH, specular=0.5)
    material.transmission, material.ior, material.transmission_roughness = TRANSPARENT, REFRACTION, hits.WATER
    return shape(grid, np.concatenate(faces), normal, np.zeros((len(grid), 2)), material)


def _waves(grid: Array, time: float) -> Array:
    """Normals of waves on the surface at the points `grid` [m], [P, 3]; the heights are moved in place."""
    slope = np.zeros((len(grid), 2))
    for k in range(WAVES):
        turn, number = 1.3 * k + 0.4, 5.0 * 1.5**k  # direction [rad], waves per 2 pi metres
        way = np.array([np.cos(turn), np.sin(turn)])
        phase = (
            grid[:, :2] @ way * number
            + time * np.sqrt(9.81 * number) * 0.5
            + 2.0 * np.sin(0.7 * grid[:, (k + 1) % 2] * (k + 1))
        )
        grid[:, 2] += WAVE_SLOPE / number * np.sin(phase)
        slope += WAVE_SLOPE * way * np.cos(phase)[:, None]
    return unit(np.column_stack([-slope, np.ones(len(grid))])).astype(np.float32)


def soot(data: Array, places: Array, effect: RenderMaterial, time: float) -> RenderShapeTriangleMesh:
    """The quads of soot that effects/soot.py describes by `data`, [V, 3], and `places`, [V, 2]; `effect`: their look.

    `time`: of the picture [s].
    """
    corners = np.column_stack([data[:, :2], places[:, 0]])
    code, extent, ceiling = data[:, 2], places[:, 1], np.full(len(data), effect.transmission)
    colour = [*np.asarray(effect.base_color)[:3], 1.0]
    material = RenderMaterial(base_color=colour)
    material.base_color_texture = effect.base_color_texture
    material.base_color = colour  # a texture is only seen after a scalar has been set (SAPIEN 3.0.3)
    material.transmission = 1.0
    material.transmission_roughness = hits.EFFECT + time
    faces = (4 * np.arange(len(data) // 4)[:, None] + np.array([[0, 1, 2, 0, 2, 3]])).reshape(-1, 3)
    return shape(corners, faces, np.column_stack([code, extent, ceiling]), np.zeros_like(places), material)
