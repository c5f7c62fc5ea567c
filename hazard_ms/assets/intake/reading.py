"""Reads a model file that may be broken or hostile: its files must lie beside it, and all is counted before loading.

Formats are glb, gltf (version 2), obj, stl and ply, without archives, addresses and compression.
"""

from __future__ import annotations

import base64
import binascii
import io
import json
import re
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import trimesh
from PIL import Image

from hazard_ms.assets.user_models import confined

FORMATS = (".glb", ".gltf", ".obj", ".stl", ".ply")
LARGEST_FILE = 64_000_000  # of a model, and of each file that it names [bytes] [ours]
LARGEST_JSON = 8_000_000  # of what describes a glTF [bytes] [ours]
MOST_FACES = 200_000  # the shipped models have 8,200 at most [ours]
MOST_FILES = 64  # beside a model [ours]
MOST_NODES = 10_000  # of a glTF [ours]
LARGEST_IMAGE = 8192  # edge of a texture [pixels] [ours]
EXTENSIONS = ("KHR_materials_", "KHR_lights_punctual")  # of those that a glTF may require: they do not change its shape
Image.MAX_IMAGE_PIXELS = LARGEST_IMAGE**2


def read_model(path: Path) -> trimesh.Scene:
    """The model in `path`, in its own frame. Raises ValueError that names what is wrong with it."""
    kind = path.suffix.lower()
    if kind not in FORMATS:
        raise ValueError(f"a model must be a file {', '.join(FORMATS)}, got {path.name}")
    data = read_bytes(path, path.name)
    CHECKS[kind](data, path.name)
    beside = Beside(path.parent)
    try:
        scene = trimesh.load_scene(io.BytesIO(data), file_type=kind[1:], resolver=beside, process=False)
    except Exception as error:  # of whatever kind trimesh raises for broken files
        if not beside.refused:
            raise ValueError(f"{path.name} cannot be read: {type(error).__name__}: {error}") from None
    if beside.refused:  # trimesh goes on without what it did not get
        raise ValueError(f"{path.name}: {beside.refused[0]}")
    _check(scene, path.name)
    return scene


def read_bytes(path: Path, name: str) -> bytes:
    """The content of a file. Raises ValueError if there is none, or if it is too large."""
    if not path.is_file():
        raise ValueError(f"there is no file {name}")
    if path.stat().st_size > LARGEST_FILE:
        raise ValueError(f"{name} must have at most {LARGEST_FILE} bytes, got {path.stat().st_size}")
    return path.read_bytes()


class Beside(trimesh.resolvers.Resolver):
    """Hands out files of one folder, and remembers what it refused. Raises ValueError for all other files."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.refused: list[str] = []
        self.count = 0

    def get(self, key: str) -> bytes:
        """The content of the file that the model names `key`. Raises ValueError if that is not a file beside it."""
        try:
            return self._get(str(key))
        except (ValueError, OSError) as error:
            self.refused.append(str(error))
            raise ValueError(str(error)) from None

    def _get(self, key: str) -> bytes:
        self.count += 1
        name = unquote(key).strip().replace("\\", "/")
        if (
            re.match(r"[A-Za-z][A-Za-z0-9+.\-]*:", name)
            or name.startswith("/")
            or ".." in name.split("/")
            or "\0" in name
        ):
            raise ValueError(f"files that a model names must lie beside it, got {key!r:.200}")
        if self.count > MOST_FILES:
            raise ValueError(f"a model must name at most {MOST_FILES} files, got more")
        return read_bytes(confined(self.folder, name), name)

    def keys(self) -> list[str]:
        return []

    def namespaced(self, namespace: str) -> Beside:
        """Refuse another folder. Always raises ValueError."""
        raise ValueError(f"files that a model names must lie beside it, got the folder {namespace!r:.200}")

    def write(self, name: str, data: Any) -> None:
        """Refuse to write. Always raises ValueError."""
        raise ValueError(f"a model that is read must write nothing, got {name!r:.200}")


def _check(scene: trimesh.Scene, name: str) -> None:
    """Refuse models without faces, with too many, or with corners that are nowhere.

    Nothing has been multiplied by instances yet.
    """
    meshes = {k: g for k, g in scene.geometry.items() if isinstance(g, trimesh.Trimesh) and len(g.faces)}
    if not meshes:
        raise ValueError(f"{name} must hold triangles, got none")
    try:
        placed = [scene.graph[node] for node in scene.graph.nodes_geometry]
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{name}: its parts cannot be placed: {error}") from None
    _few(sum(len(meshes[geometry].faces) for _, geometry in placed if geometry in meshes), name)
    for matrix, geometry in placed:
        if geometry in meshes:
            mesh = meshes[geometry]
            if not (np.isfinite(mesh.vertices).all() and np.isfinite(matrix).all()):
                raise ValueError(f"corners and placements in {name} must be finite, got some that are not finite")
            if mesh.faces.min() < 0 or mesh.faces.max() >= len(mesh.vertices):
                raise ValueError(f"triangles in {name} must join corners that it has, got others")


def _few(faces: int, name: str) -> None:
    if faces > MOST_FACES:
        raise ValueError(f"{name} must have at most {MOST_FACES} triangles, got {faces}: simplify it first")


def _check_glb(data: bytes, name: str) -> None:
    if len(data) < 20 or data[:4] != b"glTF":
        raise ValueError(f"{name} must be a GLB file, got something else")
    version, _, length, chunk = struct.unpack("<IIII", data[4:20])
    if version != 2 or chunk != 0x4E4F534A or length > len(data) - 20:
        raise ValueError(f"{name} must be a GLB file of version 2 with a whole JSON chunk first, got something else")
    _check_gltf(data[20 : 20 + length], name)


def _check_gltf(data: bytes, name: str) -> None:
    """Refuse a glTF whose JSON already says that it is too large, or needs an extension that we do not read."""
    if len(data) > LARGEST_JSON:
        raise ValueError(f"the JSON of {name} must have at most {LARGEST_JSON} bytes, got {len(data)}")
    try:
        tree = json.loads(data)
        needed = [e for e in tree.get("extensionsRequired", []) if not e.startswith(EXTENSIONS)]
        counts = [int(a["count"]) for a in tree.get("accessors", [])]
        nodes = len(tree.get("nodes", []))
        uris = [str(each["uri"]) for what in ("buffers", "images") for each in tree.get(what, []) if "uri" in each]
    except (ValueError, RecursionError, AttributeError, KeyError, TypeError, UnicodeDecodeError) as error:
        raise ValueError(f"{name} must be a valid glTF, got {type(error).__name__}: {error}") from None
    if needed:
        raise ValueError(
            f"{name} must be saved without compression and the like, got {', '.join(map(str, needed))!r:.200}"
        )
    if any(c < 0 for c in counts) or sum(counts) > 12 * MOST_FACES:
        raise ValueError(
            f"{name} must hold at most {12 * MOST_FACES} numbers of corners, got {sum(counts)}: simplify it first"
        )
    if nodes > MOST_NODES:
        raise ValueError(f"{name} must have at most {MOST_NODES} nodes, got {nodes}")
    for uri in uris:
        if uri.startswith("data:"):
            _check_data(uri, name)


def _check_data(uri: str, name: str) -> None:
    try:
        base64.b64decode(uri.partition(",")[2], validate=True)
    except binascii.Error as error:
        raise ValueError(f"data URIs of {name} must be base64: {error}") from None


def _check_obj(data: bytes, name: str) -> None:
    _few(len(re.findall(rb"(?m)^\s*f\s", data)), name)


def _check_stl(data: bytes, name: str) -> None:
    """Count the triangles of an STL file: the length of a binary one says how many follow."""
    if len(data) >= 84 and len(data) == 84 + 50 * struct.unpack("<I", data[80:84])[0]:
        return _few((len(data) - 84) // 50, name)
    if not data.lstrip()[:5].lower() == b"solid":
        raise ValueError(f"{name} must be a whole binary STL or one in words, got neither")
    return _few(data.count(b"endfacet"), name)


def _check_ply(data: bytes, name: str) -> None:
    head = data[:65536].partition(b"end_header")[0]
    counts = {k.decode(): int(n) for k, n in re.findall(rb"element\s+(\w+)\s+(\d{1,18})", head)}
    if not data.startswith(b"ply") or "face" not in counts:
        raise ValueError(f"{name} must be a PLY file with faces, got something else")
    _few(counts["face"], name)
    if max(counts.values()) > 3 * MOST_FACES or sum(counts.values()) > len(data):
        raise ValueError(
            f"{name} must hold at most {3 * MOST_FACES} elements, and no more than bytes, "
            f"got {max(counts.values())} in {len(data)} bytes"
        )


CHECKS = {".glb": _check_glb, ".gltf": _check_gltf, ".obj": _check_obj, ".stl": _check_stl, ".ply": _check_ply}
