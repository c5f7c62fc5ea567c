"""Turns a model into our frame: metres, z up, base at z = 0, centred in x and y, facing -y."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from hazard_ms.scenes.assets.rows import LARGEST

SMALLEST = 0.0005  # edge of a model [m]
AXES = {"x": (1, 0, 0), "-x": (-1, 0, 0), "y": (0, 1, 0), "-y": (0, -1, 0), "z": (0, 0, 1), "-z": (0, 0, -1)}
CREASE = np.radians(40)  # sharper edges are seen as edges
ROUGHNESS = 0.6  # of materials that do not say [-]

Matrix = NDArray[np.float64]


def frame(up: str, front: str) -> Matrix:
    """The rotation, [4, 4], that turns `up` of the file to +z and `front` to -y.

    Raises ValueError unless they are axes at a right angle.
    """
    for word in (up, front):
        if word not in AXES:
            raise ValueError(f"an axis must be one of {', '.join(AXES)}, got {word!r}")
    z, y = np.array(AXES[up], float), -np.array(AXES[front], float)
    if abs(z @ y) > 0.5:
        raise ValueError(f"up and front must not lie on one axis, got {up!r} and {front!r}")
    turn = np.eye(4)
    turn[:3, :3] = np.stack([np.cross(y, z), y, z])
    return turn


def shaped(scene: trimesh.Scene, size: float | None) -> trimesh.Scene:
    """The scene, already turned, in metres and on its base; its longest edge becomes `size` [m] unless that is None.

    Raises ValueError for sizes out of the limits.
    """
    low, high = scene.bounds
    edges = high - low
    if not np.isfinite(edges).all() or edges.max() <= 0.0:
        raise ValueError(f"the longest edge of the model must be finite and above 0, got {edges.max()}")
    if size is not None:
        scene.apply_transform(np.diag([size / edges.max()] * 3 + [1.0]))
        edges *= size / edges.max()
    if not (SMALLEST <= edges.min() and edges.max() <= LARGEST):
        words = " x ".join(f"{e:.4g}" for e in edges)
        raise ValueError(
            f"edges of the model must be from {SMALLEST} to {LARGEST} m, got {words} m: give --size in metres"
        )
    low, high = scene.bounds
    shift = np.eye(4)
    shift[:3, 3] = [-(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, -low[2]]
    scene.apply_transform(shift)
    return scene


def creased(part: trimesh.Trimesh) -> trimesh.Trimesh:
    """The part, whose file holds no normals, with sharp edges where faces meet at more than CREASE."""
    welded = part.copy()
    welded.merge_vertices()
    return trimesh.graph.smooth_shade(welded, angle=CREASE)


def painted(scene: trimesh.Scene) -> trimesh.Scene:
    """The scene with transforms baked in, and one metal-rough material for each part."""
    return trimesh.Scene([_painted(part) for part in pieces(scene)])


def pieces(scene: trimesh.Scene) -> list[trimesh.Trimesh]:
    """The triangle meshes of the scene, transforms baked in."""
    return [part for part in scene.dump() if isinstance(part, trimesh.Trimesh) and len(part.faces)]


def _painted(part: trimesh.Trimesh) -> trimesh.Trimesh:
    uv = getattr(part.visual, "uv", None)
    if uv is None or len(uv) != len(part.vertices) or not np.isfinite(uv).all():
        uv = np.zeros((len(part.vertices), 2))
    visual = TextureVisuals(uv=uv, material=_material(part.visual))
    normals = np.nan_to_num(part.vertex_normals)
    return trimesh.Trimesh(np.round(part.vertices, 5), part.faces, vertex_normals=normals, visual=visual, process=False)


def _material(visual: Any) -> PBRMaterial:
    material = getattr(visual, "material", None)
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    alpha, metal, rough, gloss = 1.0, 0.0, ROUGHNESS, None
    if isinstance(material, PBRMaterial):
        color = _color(material.baseColorFactor)
        metal, rough = _share(material.metallicFactor), _share(material.roughnessFactor)
        gloss = material.metallicRoughnessTexture
        alpha = color[3] if material.alphaMode == "BLEND" else 1.0
    elif material is not None:
        color = [1.0, 1.0, 1.0, 1.0] if image is not None else _linear(material.main_color)
    else:
        color = _linear(visual.main_color)
    return PBRMaterial(
        baseColorFactor=[*color[:3], alpha],
        baseColorTexture=None if image is None else texture(image),
        metallicRoughnessTexture=None if gloss is None else texture(gloss),
        metallicFactor=metal,
        roughnessFactor=rough,
        alphaMode="BLEND" if alpha < 1.0 else None,
    )


def _color(factor: Any) -> list[float]:
    """A glTF factor as linear colour; white if it is absent. trimesh hands out bytes or fractions."""
    if factor is None:
        return [1.0, 1.0, 1.0, 1.0]
    values = np.asarray(factor, float) / (255.0 if np.asarray(factor).dtype.kind in "ui" else 1.0)
    return [float(v) for v in np.clip(np.nan_to_num(np.r_[values, 1.0][:4]), 0.0, 1.0)]


def _share(value: Any) -> float:
    """A glTF factor; one if it is absent."""
    return 1.0 if value is None or not np.isfinite(value) else float(np.clip(value, 0.0, 1.0))


def _linear(srgb: Any) -> list[float]:
    """The linear colour of sRGB bytes (IEC 61966-2-1)."""
    c = np.asarray(srgb, float)[:3] / 255.0
    return [*np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4).round(5).tolist(), 1.0]


def texture(image: Image.Image) -> Image.Image:
    """The image, made small when it was read, as JPEG, or as PNG if parts are cut out."""
    image = image.convert("RGBA")
    data = io.BytesIO()
    if np.asarray(image)[..., 3].min() < 250:
        image.save(data, "PNG")
    else:
        image.convert("RGB").save(data, "JPEG", quality=85)
    return Image.open(io.BytesIO(data.getvalue()), formats=("PNG", "JPEG"))


def write(scene: trimesh.Scene, path: Path) -> None:
    """Write the scene as a GLB file."""
    path.write_bytes(scene.export(file_type="glb", include_normals=True))


def solid(scene: trimesh.Scene) -> trimesh.Trimesh:
    """All parts as one bare mesh with welded corners: seams of textures would leave it in pieces."""
    bare = [trimesh.Trimesh(np.round(p.vertices, 5), p.faces, process=False) for p in pieces(scene)]
    whole: Any = trimesh.util.concatenate(bare)
    return trimesh.Trimesh(whole.vertices, whole.faces, process=True)
