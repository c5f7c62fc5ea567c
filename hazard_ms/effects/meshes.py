"""Quads for effects, and their places on a thing. See shaders/common.py for what a corner carries."""

from __future__ import annotations

import numpy as np
import sapien
from sapien.render import RenderMaterial, RenderShapeTriangleMesh

from hazard_ms.effects.shaders.common import EMBER, FLAME, SCORCH, SMOKE

CORNERS = np.array([[-1, 0], [1, 0], [1, 1], [-1, 1]], np.float32)
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
NOWHERE = -1000.0  # height of effects that are not shown [m]
PUFFS, EMBERS = 7, 14  # per column of smoke
PUFF_SIZE = 0.42  # half width of a puff half way up, before it spreads [m]
EMBER_SIZE = 0.006  # half width [m]
GOLDEN = 0.6180339887  # its multiples mod 1 are evenly spread seeds


def quads(
    anchors: np.ndarray, sizes: np.ndarray, kinds: np.ndarray, seeds: np.ndarray, material: RenderMaterial
) -> RenderShapeTriangleMesh:
    """One mesh of Q quads: anchors [m], [Q, 3]; (half width, height) [m], [Q, 2]; kinds and seeds, [Q]."""
    count = len(anchors)
    data = np.column_stack([sizes, kinds + np.clip(seeds, 0.0, 0.999)]).astype(np.float32)
    faces = (FACES[None] + 4 * np.arange(count, dtype=np.uint32)[:, None, None]).reshape(-1, 3)
    spread = np.repeat(anchors.astype(np.float32), 4, 0)
    return RenderShapeTriangleMesh(spread, faces, np.repeat(data, 4, 0), np.tile(CORNERS, (count, 1)), material)


def spots(vertices: np.ndarray, faces: np.ndarray, count: int) -> np.ndarray:
    """Places [m], [count, 3], spread evenly over the upper faces of a mesh, a few over its sides, none below.

    `vertices` [m], [V, 3]; `faces`: indices, [T, 3].
    """
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    area = np.linalg.norm(across, axis=1)
    upward = across[:, 2] / np.maximum(area, 1e-12)
    weight = area * np.where(upward < -0.3, 0.0, np.clip(upward, 0.04, 1.0)) + 1e-12 * area.sum()
    draw = np.random.default_rng(len(faces))  # of the mesh alone: the same thing burns in the same way
    chosen = draw.choice(len(faces), 24 * count, p=weight / weight.sum())
    u, v = draw.random((2, len(chosen), 1))
    fold = u + v > 1
    u, v = np.where(fold, 1 - u, u), np.where(fold, 1 - v, v)
    cloud = a[chosen] + u * (b - a)[chosen] + v * (c - a)[chosen]
    kept = [int(cloud[:, 2].argmax())]
    apart = np.full(len(cloud), np.inf)
    for _ in range(count - 1):  # farthest point next
        apart = np.minimum(apart, np.linalg.norm(cloud - cloud[kept[-1]], axis=1))
        kept.append(int(apart.argmax()))
    return cloud[kept]


def surface(entity: sapien.Entity) -> tuple[np.ndarray, np.ndarray]:
    """Vertices [m], [V, 3], and faces, [T, 3], of all that is drawn of `entity`, in its frame; empty if nothing is."""
    body = entity.find_component_by_type(sapien.render.RenderBodyComponent)
    points, faces, offset = [np.zeros((0, 3), np.float32)], [np.zeros((0, 3), np.int64)], 0
    for shape in body.render_shapes if body else ():
        mesh = isinstance(shape, RenderShapeTriangleMesh)
        pose = shape.local_pose.to_transformation_matrix()
        scale = np.asarray(shape.scale) if mesh else _primitive_size(shape)
        for part in shape.parts if mesh else (shape,):
            vertices = np.asarray(part.vertices) * scale
            points.append(vertices @ pose[:3, :3].T + pose[:3, 3])
            faces.append(np.asarray(part.triangles).astype(np.int64) + offset)
            offset += len(vertices)
    return np.concatenate(points), np.concatenate(faces)


def _primitive_size(shape: sapien.render.RenderShape) -> np.ndarray:
    """The factors by which SAPIEN scales the unit vertices of a box, sphere or cylinder [m], [3]."""
    if isinstance(shape, sapien.render.RenderShapeBox):
        return np.asarray(shape.half_size)
    if isinstance(shape, sapien.render.RenderShapeSphere):
        return np.full(3, shape.radius)
    if isinstance(shape, sapien.render.RenderShapeCylinder):
        return np.array([shape.half_length, shape.radius, shape.radius])
    return np.ones(3)


def thing_flames(entity: sapien.Entity, material: RenderMaterial) -> RenderShapeTriangleMesh | None:
    """The flames of one thing, in its frame; None for a thing that is not drawn."""
    vertices, faces = surface(entity)
    if len(faces) == 0:
        return None
    size = np.ptp(vertices, axis=0)
    footprint = float(np.sqrt(max(size[0], 0.03) * max(size[1], 0.03)))
    count = int(np.clip(round(3 + 14 * size[0] * size[1] + 2 * size[2]), 3, 14))
    half = float(np.clip(0.75 * footprint / np.sqrt(count), 0.045, 0.16))
    seeds = np.arange(1, count + 1) * GOLDEN % 1
    vary = 0.75 + 0.5 * seeds
    sizes = np.column_stack([half * vary, half * vary * 3.4])
    return quads(spots(vertices, faces, count), sizes, np.full(count, FLAME), seeds, material)


def floor_flames(edge: float, seed: float, material: RenderMaterial) -> RenderShapeTriangleMesh:
    """A burning patch of floor with an `edge` [m]: a scorch mark and three flames."""
    turn = 6.28 * seed + np.array([0.0, 2.1, 4.2])
    place = np.column_stack([0.28 * edge * np.cos(turn), 0.28 * edge * np.sin(turn), np.zeros(3)])
    anchors = np.vstack([[0.0, 0.0, 0.006], place])  # [m] above the floor, against flicker between two equal depths
    size = edge * np.array([[1.0, 1.0], [0.52, 1.7], [0.45, 1.35], [0.40, 1.1]])
    seeds = (seed + np.arange(4) * GOLDEN) % 1
    return quads(anchors, size, np.array([SCORCH, FLAME, FLAME, FLAME]), seeds, material)


def smoke_column(ceiling: float, seed: float, material: RenderMaterial) -> RenderShapeTriangleMesh:
    """A column of smoke: embers, and puffs that rise to `ceiling` [m] and fade."""
    seeds = (seed + np.arange(EMBERS + PUFFS) * GOLDEN) % 1
    turn, out = 6.28 * seeds * 3, 0.12 * seeds
    anchors = np.column_stack([out * np.cos(turn), out * np.sin(turn), np.zeros_like(out)])
    half = np.where(np.arange(EMBERS + PUFFS) < EMBERS, EMBER_SIZE, PUFF_SIZE)
    kinds = np.where(np.arange(EMBERS + PUFFS) < EMBERS, EMBER, SMOKE)
    return quads(anchors, np.column_stack([half, np.full_like(half, ceiling)]), kinds, seeds, material)


def unit(vectors: np.ndarray) -> np.ndarray:
    """`vectors`, [..., 3], as long as 1 [-]; those of no length stay so."""
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9))
