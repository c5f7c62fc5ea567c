"""Scenes of the sketch in the cache folder: ways and sight of one take up to 15 seconds to make.

A scene has the name of all that it follows from, the code included. A damaged file is replaced.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from hazard_ms.sketch import array_files
from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.spec.foreign.files import read_foreign
from hazard_ms.spec.storage import files
from hazard_ms.spec.storage.cache import home

FORMAT = 1  # goes up when older files can no longer be read
# folders whose code decides what a scene is, beside that of its timeline
MADE_BY = ("robots", "scenes", "sensing", "sketch", "skills", "spec", "tasks")
PACKAGE = Path(__file__).parents[1]
PLAIN: dict[str, Callable[[Any], Any]] = {  # fields that are no arrays
    "name": str,
    "max_frames": int,
    "heading": float,
    "grid_cell": float,
    "grid_origin": lambda pair: tuple(map(float, pair)),
    "grid_shape": lambda pair: tuple(map(int, pair)),
}


def kept(name: str, follows_from: str, made: Callable[[], SketchScene]) -> SketchScene:
    """The scene called `name` that was kept, or the one that `made` gives, which is kept then.

    `follows_from` tells all that it depends on apart from the code.
    """
    digest = hashlib.sha256(f"{_code()} {follows_from}".encode()).hexdigest()[:16]
    path = home() / "sketch" / f"{name.replace('/', '-')}-{digest}.scene"
    with contextlib.suppress(ValueError):
        return from_bytes(read_foreign(path, array_files.LARGEST))
    scene = made()
    with contextlib.suppress(OSError, ValueError):  # a cache that cannot be written to only costs time
        files.make_folder(path.parent)
        files.write(path, to_bytes(scene))
    return scene


def to_bytes(scene: SketchScene) -> bytes:
    """A scene as the content of a file."""
    return array_files.to_bytes(FORMAT, {f.name: getattr(scene, f.name) for f in dataclasses.fields(scene)})


def from_bytes(content: bytes) -> SketchScene:
    """The scene that `to_bytes` gave. Raises ValueError for any other content."""
    what = "a scene of the sketch"
    return array_files.made_from(SketchScene, what, array_files.from_bytes(what, FORMAT, content), PLAIN)


@functools.lru_cache(maxsize=1)
def _code() -> str:
    """A digest of the code that makes scenes."""
    sources = (path.read_bytes() for name in MADE_BY for path in sorted((PACKAGE / name).rglob("*.py")))
    return hashlib.sha256(b"\0".join(sources)).hexdigest()
