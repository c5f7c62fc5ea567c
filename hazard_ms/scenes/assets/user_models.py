"""The models that the user has added: a folder with an index like the shipped one, read with suspicion."""

from __future__ import annotations

import math
import os
import re
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from hazard_ms.scenes.assets.rows import Asset, read_row
from hazard_ms.scenes.assets.shipped import shipped_index
from hazard_ms.spec.catalogue import CATEGORIES
from hazard_ms.spec.foreign.files import printable, read_foreign
from hazard_ms.spec.foreign.plain import parse

USER_FOLDER = "HAZARD_MS_ASSETS"  # environment variable: the folder of the user's models
LARGEST_INDEX = 4_000_000  # of a user's index [bytes]; a row has 600
USER_ID = re.compile(r"[a-z][a-z0-9_]{0,39}")
LICENCE = re.compile(r"[A-Za-z0-9][A-Za-z0-9 .+()\-]{0,79}")  # of a user's model: any, but it must be named


def user_root() -> Path:
    """The folder of the user's models: $HAZARD_MS_ASSETS, else hazard_ms/scenes/assets among the user's data.

    It may not be there yet.
    """
    if os.environ.get(USER_FOLDER):
        return Path(os.environ[USER_FOLDER]).expanduser().absolute()
    data = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(data).absolute() / "hazard_ms" / "assets"


def user_index() -> dict[str, Asset]:
    """The user's models by id; empty if there is no index.

    Raises ValueError that names the row for anything that is not as it must be.
    """
    folder = user_root()
    try:
        found = (folder / "index.json").stat()
    except (FileNotFoundError, NotADirectoryError):
        return {}
    return _user_index(folder, (found.st_mtime_ns, found.st_size, found.st_ino))


@lru_cache(maxsize=4)
def _user_index(folder: Path, state: tuple[int, int, int]) -> dict[str, Asset]:
    """The index in `folder`; `state` of the file tells when it must be read again."""
    made: dict[str, Asset] = {}
    for row in user_rows(folder):
        found = read_user_row(row, folder)
        if found.id in made:
            raise ValueError(f"ids in {folder / 'index.json'} must differ, got {found.id!r} twice")
        made[found.id] = found
    return made


def user_rows(folder: Path) -> list[Any]:
    """The rows of the index in `folder`, unchecked; empty if there is no index.

    Raises ValueError for an index that is too large, not a regular file, or not a list.
    """
    file = confined(folder, "index.json")
    if not file.exists():
        return []
    rows = parse(read_foreign(file, LARGEST_INDEX), printable(str(file)))
    if not isinstance(rows, list):
        raise ValueError(f"{file} must hold a list of rows, got {rows!r:.100}")
    return rows


def read_user_row(row: Any, folder: Path) -> Asset:
    """The asset in one row of the user's index, with full paths of its files, which must be inside `folder`.

    Raises ValueError that names the row and what is wrong with it.
    """
    a = read_row(row)
    if not USER_ID.fullmatch(a.id):
        raise ValueError(f"ids in {folder} must have at most 40 lower-case letters, digits and _, got {a.id!r:.100}")
    if a.id in shipped_index():
        raise ValueError(
            f"ids in {folder} must not be those of shipped models, got {a.id!r}: hazard-ms assets remove {a.id}"
        )
    if a.category not in CATEGORIES or a.kind != CATEGORIES[a.category].kind:
        raise ValueError(
            f"category of asset {a.id!r} must be one of {', '.join(CATEGORIES)} with the asset's kind, got "
            f"{a.category!r:.100} with kind {a.kind!r}"
        )
    if not LICENCE.fullmatch(a.licence):
        raise ValueError(f"licence of asset {a.id!r} must be a name of at most 80 characters, got {a.licence!r:.100}")
    numbers = (
        *(v for box in a.boxes for v in box),
        *(v for s in a.supports for v in (s.z, *s.min, *s.max, s.clearance)),
    )
    if not all(math.isfinite(v) for v in (*numbers, *a.extent, a.mass)):
        raise ValueError(f"numbers of asset {a.id!r} must be finite, got {numbers!r:.200}")
    for file, suffix in ((a.visual, ".glb"), (a.hulls, ".ply")):
        if file and not file.endswith(suffix):
            raise ValueError(
                f"files of asset {a.id!r} must be a .glb and a .ply, got {file!r:.100}: hazard-ms assets remove {a.id}"
            )
    visual, hulls = (str(confined(folder, file)) if file else "" for file in (a.visual, a.hulls))
    for path in (visual, hulls):
        if path and not Path(path).is_file():
            raise ValueError(f"files of asset {a.id!r} must exist, got no file {path}: hazard-ms assets remove {a.id}")
    return replace(a, visual=visual, hulls=hulls)


def confined(folder: Path, file: str) -> Path:
    """The full path of `file` in `folder`. Raises ValueError if it leads out of the folder, through links included."""
    path = (folder / file).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise ValueError(f"files must be inside {folder}, got {file!r:.200}, which leads out of it")
    return path
