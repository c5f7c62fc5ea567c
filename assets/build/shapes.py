"""Primitives of our own models: metres, z up, each with texture coordinates and one material."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import trimesh
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from convert import linear

Mesh = trimesh.Trimesh
turn = trimesh.transformations.rotation_matrix


def material(color: str = "#ffffff", rough: float = 0.6, metal: float = 0.0, image: Image.Image | None = None) -> PBRMaterial:
    """`color` as on a screen; an `image` takes its place."""
    rgb = [int(color[i : i + 2], 16) for i in (1, 3, 5)]
    factor = [1.0] * 4 if image is not None else [*linear(rgb), 1.0]
    return PBRMaterial(baseColorFactor=factor, baseColorTexture=image, roughnessFactor=rough, metallicFactor=metal)


def dressed(mesh: Mesh, of: PBRMaterial, uv: np.ndarray | None = None) -> Mesh:
    mesh.visual = TextureVisuals(uv=np.zeros((len(mesh.vertices), 2)) if uv is None else uv, material=of)
    return mesh


def moved(mesh: Mesh, at: Sequence[float] = (0, 0, 0), about: str = "", degrees: float = 0.0) -> Mesh:
    """Turned about an axis of its own frame, then shifted; the mesh itself is changed and returned."""
    if about:
        mesh.apply_transform(turn(np.radians(degrees), {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}[about]))
    mesh.apply_translation(at)
    return mesh


def lathe(profile: Any, of: PBRMaterial, sides: int = 36) -> Mesh:
    """Revolves (radius, height) points about z; u runs around, v along the profile from its end to its start."""
    p = np.array(profile, dtype=float)
    along = np.r_[0, np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))]
    angle = np.linspace(0, 2 * np.pi, sides + 1)
    ring = np.stack([np.cos(angle), np.sin(angle)], 1)
    vertices = np.concatenate([np.c_[r * ring, np.full(sides + 1, z)] for r, z in p])
    uv = np.stack([np.tile(angle / (2 * np.pi), len(p)), np.repeat(along / along[-1], sides + 1)], 1)
    faces = []
    for i in range(len(p) - 1):
        for j in range(sides):
            a, c = i * (sides + 1) + j, (i + 1) * (sides + 1) + j
            if p[i, 0] > 1e-7:
                faces.append([a, a + 1, c + 1])
            if p[i + 1, 0] > 1e-7:
                faces.append([a, c + 1, c])
    return dressed(Mesh(vertices, faces, process=False), of, uv)


def disc(radius: float, height: float, of: PBRMaterial, bevel: float = 0.0, sides: int = 36) -> Mesh:
    """An upright cylinder from z = 0, edges bevelled."""
    b = bevel
    rim = [(radius - b, 0), (radius, b), (radius, height - b), (radius - b, height)] if b else [(radius, 0), (radius, height)]
    return lathe([(0, 0), *rim, (0, height)], of, sides)


def spline(points: Any, count: int = 24) -> np.ndarray:
    """A smooth curve through `points` that swings no farther than they do."""
    from scipy.interpolate import PchipInterpolator

    p = np.array(points, dtype=float)
    along = np.r_[0, np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))]
    return PchipInterpolator(along, p)(np.linspace(0, along[-1], count))


def block(extent: Sequence[float], of: PBRMaterial, radius: float = 0.0, smooth: int = 1, tile: float = 0.0) -> Mesh:
    """A box around its origin with edges rounded by `radius`; textures repeat every `tile` metres, or fill each side once."""
    e = np.array(extent, dtype=float)
    if radius > 0.0:
        ball = trimesh.creation.icosphere(subdivisions=smooth, radius=radius).vertices
        corners = np.array(np.meshgrid(*[[-1, 1]] * 3)).T.reshape(-1, 3) * (e / 2 - radius)
        mesh = trimesh.convex.convex_hull(np.concatenate([ball + c for c in corners]))
    else:
        mesh = trimesh.creation.box(e)
    return dressed(*_sides_apart(mesh, of, e, tile))


def _sides_apart(mesh: Mesh, of: PBRMaterial, e: np.ndarray, tile: float) -> tuple[Mesh, PBRMaterial, np.ndarray]:
    """Projects textures from the six sides; smooth shading is kept by the normals of the whole mesh."""
    normals = np.array(mesh.vertex_normals) if len(mesh.faces) > 12 else None
    side = np.abs(mesh.face_normals / e).argmax(axis=1) if len(mesh.faces) > 12 else np.abs(mesh.face_normals).argmax(axis=1)
    corner = mesh.faces.ravel()
    vertices, axis = mesh.vertices[corner], np.repeat(side, 3)
    planes = np.array([[1, 2], [0, 2], [0, 1]])[axis]
    flat = np.take_along_axis(vertices, planes, axis=1)
    uv = flat / tile if tile else flat / np.take_along_axis(np.tile(e, (len(axis), 1)), planes, axis=1) + 0.5
    given = normals[corner] if normals is not None else np.repeat(mesh.face_normals, 3, axis=0)
    return Mesh(vertices, np.arange(len(corner)).reshape(-1, 3), vertex_normals=given, process=False), of, uv


def bulge(extent: Sequence[float], sharp: tuple[float, float], of: PBRMaterial, n: int = 32, repeat: float = 1.0) -> Mesh:
    """A superellipsoid: cushions, bags. `sharp`: exponents from the side and from above, 1 round, 0 square."""
    u, v = np.meshgrid(np.linspace(-np.pi, np.pi, n + 1), np.linspace(-np.pi / 2, np.pi / 2, n // 2 + 1))

    def power(wave: np.ndarray, e: float) -> np.ndarray:
        return np.sign(wave) * np.abs(wave) ** e

    side, above = sharp
    unit = np.stack(
        [
            power(np.cos(v), side) * power(np.cos(u), above),
            power(np.cos(v), side) * power(np.sin(u), above),
            power(np.sin(v), side),
        ],
        axis=-1,
    ).reshape(-1, 3)
    faces = [
        t
        for i in range(n // 2)
        for j in range(n)
        for a in [i * (n + 1) + j]
        for t in ([a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1])
    ]
    uv = (unit[:, [0, 1]] / 2 + 0.5) * repeat
    return dressed(Mesh(unit * np.array(extent) / 2, faces, process=False), of, uv)


def tube(path: Any, radius: Any, of: PBRMaterial, sides: int = 12) -> Mesh:
    """Sweeps a circle along a path; `radius` is one number or one for each point. Ends are closed."""
    p = np.array(path, dtype=float)
    ahead = np.gradient(p, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1)[:, None]
    up = np.array([0, 0, 1.0]) if abs(ahead[0, 2]) < 0.9 else np.array([1.0, 0, 0])
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    rings = []
    for point, t, r in zip(p, ahead, np.broadcast_to(radius, len(p)), strict=True):
        a = np.cross(t, up)
        a /= np.linalg.norm(a)
        up = np.cross(a, t)  # carried along, so that the ring does not twist
        rings.append(point + r * (np.outer(np.cos(angle), a) + np.outer(np.sin(angle), up)))
    vertices = np.concatenate([*rings, p[:1], p[-1:]])
    faces = []
    for i in range(len(p) - 1):
        for j in range(sides):
            a, b = i * sides + j, i * sides + (j + 1) % sides
            faces += [[a, b, a + sides], [b, b + sides, a + sides]]
    first, last, end = len(vertices) - 2, len(vertices) - 1, (len(p) - 1) * sides
    for j in range(sides):
        k = (j + 1) % sides
        faces += [[first, k, j], [last, end + j, end + k]]
    mesh = Mesh(vertices, faces, process=False)
    mesh.fix_normals()
    return dressed(mesh, of)


def panel(width: float, depth: float, of: PBRMaterial) -> Mesh:
    """A rectangle that looks up; its texture is upright as seen from above with +y away."""
    x, y = width / 2, depth / 2
    mesh = Mesh([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]], [[0, 1, 2], [0, 2, 3]], process=False)
    return dressed(mesh, of, np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float))


def cut(body: Mesh, *holes: Mesh) -> Mesh:
    """`body` without `holes` (both closed); it keeps its material, as a plain colour."""
    keep = body.visual.material
    clean = [Mesh(np.round(m.vertices, 6), m.faces, process=True) for m in (body, *holes)]
    made = trimesh.boolean.difference(clean, engine="manifold")
    made.unmerge_vertices()
    return dressed(made, keep)


def joined(parts: Sequence[Mesh]) -> trimesh.Scene:
    return trimesh.Scene(list(parts))
