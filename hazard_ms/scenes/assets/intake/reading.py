"""Reads a model file that may be broken or hostile: its files must lie beside it, and all is counted before loading.

Formats are glb, gltf (version 2), obj, stl and ply, without archives, addresses and compression.
"""

from __future__ import annotations

import io
import re
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import trimesh

from hazard_ms.scenes.assets.intake.gltf import prepared_glb, prepared_gltf
from hazard_ms.scenes.assets.intake.textures import Textures
from hazard_ms.scenes.assets.user_models import confined
from hazard_ms.spec.foreign.files import printable, read_foreign

FORMATS = (".glb", ".gltf", ".obj", ".stl", ".ply")
LARGEST_FILE = 64_000_000  # of a model, and of each file that it names [bytes] [ours]
MOST_FACES = 200_000  # the shipped models have 8,200 at most [ours]
MOST_FILES = 64  # beside a model [ours]
MOST_CORNERS = 600_000  # of all parts, each as often as it is placed [ours]
LONGEST_REASON = 300  # of what a library says about a broken file [characters] [ours]


def read_model(path: Path) -> trimesh.Scene:
    """The model in `path`, in its own frame, its pictures small. Raises ValueError that names what is wrong with it."""
    kind, name = path.suffix.lower(), printable(path.name)
    if kind not in FORMATS:
        raise ValueError(f"a model must be a file {', '.join(FORMATS)}, got {name}")
    data = read_foreign(path, LARGEST_FILE, name)
    textures = Textures()
    beside = Beside(path.parent, textures, BEFORE_PICTURES[kind])
    if kind in CHECKS:
        CHECKS[kind](data, name)
    else:
        prepared = prepared_glb if kind == ".glb" else prepared_gltf
        data = prepared(data, name, beside.get, textures)
    try:
        scene = trimesh.load_scene(io.BytesIO(data), file_type=kind[1:], resolver=beside, process=False)
    except Exception as error:  # of whatever kind trimesh raises for broken files
        if not beside.refused:
            reason = printable(f"{type(error).__name__}: {error}")[:LONGEST_REASON]
            raise ValueError(f"{name} cannot be read: {reason}") from None
    if beside.refused:  # trimesh goes on without what it did not get
        raise ValueError(f"{name}: {beside.refused[0]}")
    _check(scene, name)
    return scene


class Beside(trimesh.resolvers.Resolver):
    """Hands out files of one folder, and remembers what it refused. Raises ValueError for all other files.

    The first `plain` files are handed out as they are; all that are asked for later are pictures, and become small.
    """

    def __init__(self, folder: Path, textures: Textures, plain: int) -> None:
        self.folder = folder
        self.refused: list[str] = []
        self._textures = textures
        self._plain = plain
        self._count = 0
        self._pictures: dict[str, bytes] = {}

    def get(self, key: str) -> bytes:
        """The content of the file that the model names `key`. Raises ValueError if that is not a file beside it."""
        try:
            return self._get(str(key))
        except (ValueError, OSError) as error:
            self.refused.append(str(error))
            raise ValueError(str(error)) from None

    def _get(self, key: str) -> bytes:
        name = unquote(key).strip().replace("\\", "/")
        if (
            re.match(r"[A-Za-z][A-Za-z0-9+.\-]*:", name)
            or name.startswith("/")
            or ".." in name.split("/")
            or "\0" in name
        ):
            raise ValueError(f"files that a model names must lie beside it, got {key!r:.200}")
        if name in self._pictures:
            return self._pictures[name]
        if self._count == MOST_FILES:
            raise ValueError(f"a model must name at most {MOST_FILES} files, got more")
        self._count += 1
        data = read_foreign(confined(self.folder, name), LARGEST_FILE, name[:LONGEST_REASON])
        if self._count <= self._plain:
            return data
        self._pictures[name] = self._textures.small(data, name)
        return self._pictures[name]

    def keys(self) -> list[str]:
        return []

    def namespaced(self, namespace: str) -> Beside:
        """Refuse another folder. Always raises ValueError."""
        raise ValueError(f"files that a model names must lie beside it, got the folder {namespace!r:.200}")

    def write(self, name: str, data: Any) -> None:
        """Refuse to write. Always raises ValueError."""
        raise ValueError(f"a model must not write anything while it is read, got {name!r:.200}")


def _check(scene: trimesh.Scene, name: str) -> None:
    """Refuse models without faces, with too many, or with corners that are nowhere.

    Nothing has been multiplied by instances yet.
    """
    meshes = {k: g for k, g in scene.geometry.items() if isinstance(g, trimesh.Trimesh) and len(g.faces)}
    if not meshes:
        raise ValueError(f"{name} must hold triangles, got none")
    try:
        placed = [scene.graph[node] for node in scene.graph.nodes_geometry]
    except Exception as error:  # likewise
        raise ValueError(f"{name}: its parts cannot be placed: {error!r:.200}") from None
    shown = [meshes[geometry] for _, geometry in placed if geometry in meshes]
    _few(sum(len(mesh.faces) for mesh in shown), name)
    corners = sum(len(mesh.vertices) for mesh in shown)
    if corners > MOST_CORNERS:
        raise ValueError(f"{name} must have at most {MOST_CORNERS} corners, got {corners}: simplify it first")
    for matrix, geometry in placed:
        if geometry in meshes:
            mesh = meshes[geometry]
            if not (np.isfinite(mesh.vertices).all() and np.isfinite(matrix).all()):
                raise ValueError(f"corners and placements in {name} must be finite, got NaN or infinity")
            if mesh.faces.min() < 0 or mesh.faces.max() >= len(mesh.vertices):
                raise ValueError(f"triangles in {name} must join corners that exist, got others")


def _few(faces: int, name: str) -> None:
    if faces > MOST_FACES:
        raise ValueError(f"{name} must have at most {MOST_FACES} triangles, got {faces}: simplify it first")


def _check_obj(data: bytes, name: str) -> None:
    _few(len(re.findall(rb"(?m)^\s*f\s", data)), name)


def _check_stl(data: bytes, name: str) -> None:
    """Count the triangles of an STL file: the length of a binary one says how many follow."""
    if len(data) >= 84 and len(data) == 84 + 50 * struct.unpack("<I", data[80:84])[0]:
        return _few((len(data) - 84) // 50, name)
    if not data.lstrip()[:5].lower() == b"solid":
        raise ValueError(f"{name} must be a complete binary STL file or an ASCII one, got neither")
    return _few(data.count(b"endfacet"), name)


def _check_ply(data: bytes, name: str) -> None:
    head = data[:65536].partition(b"end_header")[0]
    counts = {k.decode(): int(n) for k, n in re.findall(rb"element\s+(\w+)\s+(\d{1,18})", head)}
    if not data.startswith(b"ply") or "face" not in counts:
        raise ValueError(f"{name} must be a PLY file with faces, got something else")
    _few(counts["face"], name)
    if max(counts.values()) > 3 * MOST_FACES or sum(counts.values()) > len(data):
        raise ValueError(
            f"{name} must have at most {3 * MOST_FACES} elements, and no more than it has bytes, got "
            f"{max(counts.values())} in {len(data)} bytes"
        )


CHECKS = {".obj": _check_obj, ".stl": _check_stl, ".ply": _check_ply}
BEFORE_PICTURES = {  # files that a format asks for before its pictures: buffers, the library of materials
    ".glb": MOST_FILES,
    ".gltf": MOST_FILES,
    ".obj": 1,
    ".stl": 0,
    ".ply": 0,
}
