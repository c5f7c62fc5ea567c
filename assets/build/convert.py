"""Turns furniture models into GLB files in our frame: metres, z up, base at z = 0, centred in x and y."""

from __future__ import annotations

import io
import re
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from source import Model

TEXTURE_SIZE = 512  # longest edge [pixels]
CREASE = np.radians(40)  # sharper edges are seen as edges
Y_UP_TO_Z_UP = trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0])


def load(model: Model, row: dict[str, Any]) -> trimesh.Scene:
    """The model at its catalogue size, z up, with the parts and the paint that `row` asks for."""
    text = select(model.read(Path(model.path).name).decode("utf-8", "replace"), row.get("keep"), row.get("drop"))
    scene = trimesh.load_scene(io.BytesIO(text.encode()), file_type="obj", resolver=_Files(model))
    if model.rotation:
        turn = np.eye(4)
        turn[:3, :3] = np.array(model.rotation).reshape(3, 3)
        scene.apply_transform(turn)
    scene.apply_transform(Y_UP_TO_Z_UP)
    if not row.get("keep"):  # the catalogue's size is that of the whole model
        _stretch(scene, np.array(model.size_cm) / 100.0)
    parts = scene.dump()
    for part in parts:
        known = part.visual if isinstance(part.visual, TextureVisuals) else TextureVisuals()
        uv = np.zeros((len(part.vertices), 2)) if known.uv is None else known.uv
        part.visual = TextureVisuals(uv=uv, material=paint(known.material, row.get("paint", {}), model))
    if "\nvn " not in text:
        parts = [creased(part) for part in parts]
    return trimesh.Scene(parts)


def creased(part: trimesh.Trimesh) -> trimesh.Trimesh:
    """The same faces with normals that are smooth only between faces that meet at less than CREASE."""
    corner, flat = part.faces.ravel(), np.repeat(part.face_normals, 3, axis=0)
    place = np.unique(part.vertices.round(6), axis=0, return_inverse=True)[1].ravel()[corner]
    order = np.argsort(place, kind="stable")
    count = np.bincount(place)
    many = count[place[order]]  # of corners at the place of each corner
    first = np.repeat(np.cumsum(count) - count, count)
    own = np.repeat(np.arange(len(order)), many)
    other = order[np.repeat(first, many) + np.arange(len(own)) - np.repeat(np.cumsum(many) - many, many)]
    own = order[own]
    near = (flat[own] * flat[other]).sum(axis=1) > np.cos(CREASE)
    weight = np.repeat(part.area_faces, 3)[other[near]]
    normal = np.stack([np.bincount(own[near], weight * flat[other[near], k], len(corner)) for k in range(3)], axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-12)[:, None]
    rows = np.c_[part.vertices[corner], part.visual.uv[corner], normal]
    rows, index = np.unique(rows.round(5), axis=0, return_inverse=True)
    visual = TextureVisuals(uv=rows[:, 3:5], material=part.visual.material)
    return trimesh.Trimesh(rows[:, :3], index.reshape(-1, 3), vertex_normals=rows[:, 5:], visual=visual, process=False)


def select(text: str, keep: str | None, drop: str | None) -> str:
    """The OBJ text without the faces of objects, groups or materials that do not match `keep` or that match `drop`."""
    if not keep and not drop:
        return text
    out, names = [], {"o": "", "g": "", "usemtl": ""}
    for line in text.splitlines():
        word, _, rest = line.partition(" ")
        if word in names:
            names[word] = rest.strip()
        label = " ".join(names.values())
        hidden = (keep and not re.search(keep, label)) or (drop and re.search(drop, label))
        if word not in ("f", "l", "p") or (word == "f" and not hidden):
            out.append(line)
    return "\n".join(out)


def paint(material: Any, paints: dict[str, dict[str, Any]], model: Model) -> PBRMaterial:
    """A metal-rough material; `paints` maps a pattern of material names to color, texture, cover, rough, metal."""
    name = getattr(material, "name", "") or ""
    shine = getattr(material, "glossiness", None) or 10.0  # Phong exponent
    image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
    color = getattr(material, "diffuse", getattr(material, "main_color", (200, 200, 200, 255)))
    want = next((p for pattern, p in paints.items() if re.search(pattern, name)), {})
    if "texture" in want:
        image = Image.open(io.BytesIO(model.read(want["texture"])))
    if image is not None and "cover" in want:  # marks of makers
        image = covered(image, want["cover"])
    if "color" in want:
        image, color = None, [int(want["color"][i : i + 2], 16) for i in (1, 3, 5)]
    alpha = want.get("alpha", 1.0)
    return PBRMaterial(
        name=name,
        baseColorFactor=[*linear(color[:3]), alpha] if image is None else [1.0, 1.0, 1.0, 1.0],
        baseColorTexture=None if image is None else texture(image),
        metallicFactor=want.get("metal", 0.0),
        roughnessFactor=want.get("rough", float(np.clip((2.0 / (shine + 2.0)) ** 0.25, 0.25, 1.0))),
        alphaMode="BLEND" if alpha < 1.0 else None,
    )


def covered(image: Image.Image, patches: list[list[Any]]) -> Image.Image:
    """The image with rectangles painted over: left, top, right, bottom as fractions, and a colour."""
    image = image.convert("RGBA")
    w, h = image.size
    for left, top, right, bottom, color in patches:
        image.paste(color, (round(left * w), round(top * h), round(right * w), round(bottom * h)))
    return image


def linear(srgb: Any) -> list[float]:
    """Linear colour from sRGB bytes: glTF factors are linear, MTL colours are what a screen shows (IEC 61966-2-1)."""
    c = np.asarray(srgb, dtype=float) / 255.0
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4).round(5).tolist()


def texture(image: Image.Image, pixels: int = TEXTURE_SIZE) -> Image.Image:
    """Longest edge at most `pixels`; JPEG, or PNG where parts are cut out."""
    scale = pixels / max(image.size)
    image = image.convert("RGBA")
    if scale < 1.0:
        image = image.resize([max(1, round(s * scale)) for s in image.size], Image.Resampling.LANCZOS)
    cut = np.asarray(image)[..., 3].min() < 250
    data = io.BytesIO()
    if cut:
        image.quantize(128).convert("RGBA").save(data, "PNG")
    else:
        image.convert("RGB").save(data, "JPEG", quality=85)
    return Image.open(io.BytesIO(data.getvalue()))


def fit(scene: trimesh.Scene, row: dict[str, Any]) -> None:
    """Turn as `row["turn"]` says, scale to `row["size"]` (a longest edge, or three edges [m]), put the base on z = 0."""
    for axis, degrees in row.get("turn", []):
        about = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}[axis]
        scene.apply_transform(trimesh.transformations.rotation_matrix(np.radians(degrees), about))
    size = row.get("size")
    if isinstance(size, list):
        _stretch(scene, np.array(size))
    elif size:
        scene.apply_transform(np.diag([size / scene.extents.max()] * 3 + [1.0]))
    low, high = scene.bounds
    shift = np.eye(4)
    shift[:3, 3] = [-(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, -low[2]]
    scene.apply_transform(shift)


def write(scene: trimesh.Scene, path: Path, faces: int, pixels: int, gltfpack: list[str]) -> trimesh.Scene:
    """Write `path`, reduced to about `faces` and to textures of at most `pixels`; returns what was written."""
    have = count(scene)
    if have > faces:
        scene = reduce(scene, faces / have, gltfpack)
        if count(scene) > 1.15 * faces:
            scene = reduce(scene, faces / count(scene), [*gltfpack, "-sa"])
    fit(scene, {})
    final = trimesh.Scene(scene.dump())  # transforms baked in
    for part in final.geometry.values():
        normals = part.vertex_normals.copy()
        part.vertices = np.round(part.vertices, 5)
        part.vertex_normals = normals
        material = part.visual.material
        if material.baseColorTexture is not None:  # last, because copies forget the image format
            material.baseColorTexture = texture(material.baseColorTexture, pixels)
    data = final.export(file_type="glb", include_normals=True)
    path.write_bytes(data)
    subprocess.run(
        [gltfpack[0], "-i", str(path), "-o", str(path), "-noq"], check=True, stdout=subprocess.DEVNULL
    )  # short indices
    return trimesh.load_scene(path)


def reduce(scene: trimesh.Scene, ratio: float, gltfpack: list[str]) -> trimesh.Scene:
    with tempfile.TemporaryDirectory() as folder:
        before, after = Path(folder, "before.glb"), Path(folder, "after.glb")
        before.write_bytes(scene.export(file_type="glb", include_normals=True))
        job = [gltfpack[0], "-i", str(before), "-o", str(after), "-noq", "-si", f"{ratio:.4f}", *gltfpack[1:]]
        subprocess.run(job, check=True, stdout=subprocess.DEVNULL)
        return trimesh.load_scene(io.BytesIO(after.read_bytes()), file_type="glb")


def count(scene: trimesh.Scene) -> int:
    return sum(len(part.faces) for part in scene.dump())


def solid(scene: trimesh.Scene) -> trimesh.Trimesh:
    """All parts as one bare mesh with welded corners (UV seams would leave it in thousands of pieces)."""
    parts = scene.dump()
    starts = np.cumsum([0] + [len(p.vertices) for p in parts])
    faces = np.concatenate([p.faces + s for p, s in zip(parts, starts[:-1], strict=True)])
    return trimesh.Trimesh(np.round(np.concatenate([p.vertices for p in parts]), 5), faces, process=True)


def _stretch(scene: trimesh.Scene, size: np.ndarray) -> None:
    scene.apply_transform(np.diag([*(size / np.maximum(scene.extents, 1e-9)), 1.0]))


class _Files(trimesh.resolvers.Resolver):
    """Files beside a model, read when asked for."""

    def __init__(self, model: Model) -> None:
        self.model = model

    def keys(self) -> list[str]:
        return self.model.names()

    def namespaced(self, namespace: str) -> _Files:
        raise NotImplementedError("models have no folders inside")

    def write(self, name: str, data: bytes) -> None:
        raise NotImplementedError("the package is only read")

    def get(self, name: str) -> bytes:
        return self.model.read(name.strip().replace("\\", "/").removeprefix("./"))
