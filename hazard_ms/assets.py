"""The index of models: what each asset is, how large and heavy, where its files are, and whose work it is.

Files lie in the checkout's `assets/`, or in the installed package; models that the user added lie in the user's own folder, with an
index of the same schema. Every model has its base at z = 0, is centred in x and y, z up, in metres. Scenes are generated from shipped
models only, so that what a user adds changes none of them. No torch, no SAPIEN.
"""

from __future__ import annotations

import json
import math
import os
import re
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from hazard_ms import plain
from hazard_ms.catalogue import CATEGORIES

KINDS = ("object", "fixture", "structure", "texture", "sky")
LICENCES = ("CC0-1.0", "CC-BY-3.0", "CC-BY-3.0-US", "CC-BY-4.0", "own work")
LARGEST = 20.0  # edge of a model, at most [m]
USER_FOLDER = "HAZARD_MS_ASSETS"  # environment variable: the folder of the user's models
LARGEST_INDEX = 4_000_000  # of a user's index [bytes]; a row has 600
LONGEST_TEXT = 2000  # of an entry [characters]
USER_ID = re.compile(r"[a-z][a-z0-9_]{0,39}")
LICENCE = re.compile(r"[A-Za-z0-9][A-Za-z0-9 .+()\-]{0,79}")  # of a user's model: any, but it must be named


@dataclass(frozen=True)
class Support:
    """A level rectangle on which things can be placed, in the asset's frame."""

    z: float  # [m]
    min: tuple[float, float]  # [m]
    max: tuple[float, float]  # [m]
    clearance: float = 2.0  # free height above it [m]


@dataclass(frozen=True)
class Asset:
    """One row of the index."""

    id: str
    kind: str  # one of KINDS
    category: str  # a key of the catalogue; empty for textures and skies
    visual: str  # file below assets/; a user's: its full path
    licence: str  # one of LICENCES; a user's: any
    author: str
    source: str
    changes: str
    hulls: str = ""  # file with several convex pieces
    boxes: tuple[tuple[float, ...], ...] = ()  # centre and half size of hand-made collision boxes [m], six numbers each
    extent: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m]
    mass: float = 0.0  # [kg]
    supports: tuple[Support, ...] = ()
    faces: int = 0
    sha256: tuple[tuple[str, str], ...] = ()  # file, checksum


def root() -> Path:
    """The folder of the assets."""
    here = Path(__file__).resolve().parent
    for folder in (here.parent / "assets", here / "_assets"):
        if (folder / "index.json").is_file():
            return folder
    raise ValueError(f"no assets: neither {here.parent / 'assets'} nor {here / '_assets'} holds an index.json")


@lru_cache(maxsize=1)
def index() -> dict[str, Asset]:
    """All assets by id. Raises ValueError that names the row for anything that is not as it must be."""
    rows = json.loads((root() / "index.json").read_text(encoding="utf-8"))
    made: dict[str, Asset] = {}
    for row in rows:
        found = read_row(row)
        if found.id in made:
            raise ValueError(f"asset {found.id!r} stands in the index twice; ids must differ")
        made[found.id] = found
    return made


def read_row(row: dict[str, Any]) -> Asset:
    """One row of index.json, checked."""
    found = _read(row)
    if found.licence not in LICENCES:
        raise ValueError(f"asset {found.id!r} has licence {found.licence!r}; allowed: {', '.join(LICENCES)}")
    return found


def _read(row: Any) -> Asset:
    if not isinstance(row, dict):
        raise ValueError(f"a row of the index is {row!r:.100}; an object is allowed")
    name = row.get("id", "?")
    unknown = set(row) - {f.name for f in fields(Asset)}
    if unknown:
        raise ValueError(f"asset {name!r:.100} has unknown entries {sorted(unknown)!r:.200}; allowed: {[f.name for f in fields(Asset)]}")
    try:
        found = Asset(**_values(row))
    except (TypeError, ValueError, KeyError, AttributeError) as error:
        raise ValueError(f"asset {name!r:.100} lacks an entry, or has one that cannot be read: {error}") from None
    _check(found)
    return found


def _values(row: dict[str, Any]) -> dict[str, Any]:
    values = dict(row)
    values["boxes"] = tuple(_numbers(box, 6) for box in row.get("boxes") or ())
    values["supports"] = tuple(_support(s) for s in row.get("supports") or ())
    values["extent"] = _numbers(row.get("extent") or (0, 0, 0), 3)
    values["hulls"] = row.get("hulls") or ""
    values["sha256"] = tuple(sorted((row.get("sha256") or {}).items()))
    for entry in ("id", "kind", "category", "visual", "licence", "author", "source", "changes", "hulls"):
        if entry in values and (not isinstance(values[entry], str) or len(values[entry]) > LONGEST_TEXT):
            raise ValueError(f"{entry} is {values[entry]!r:.100}; a text of at most {LONGEST_TEXT} characters is allowed")
    values["mass"], values["faces"] = float(row.get("mass", 0.0)), int(row.get("faces", 0))
    return values


def _support(row: dict[str, Any]) -> Support:
    low, high = _numbers(row["min"], 2), _numbers(row["max"], 2)
    return Support(float(row["z"]), (low[0], low[1]), (high[0], high[1]), float(row.get("clearance", 2.0)))


def _numbers(values: Any, count: int) -> tuple[float, ...]:
    made = tuple(float(v) for v in values)
    if len(made) != count:
        raise ValueError(f"{values!r:.100} is not {count} numbers")
    return made


def _check(a: Asset) -> None:
    if a.kind not in KINDS:
        raise ValueError(f"asset {a.id!r} is of kind {a.kind!r}; allowed: {', '.join(KINDS)}")
    for file in (a.visual, a.hulls):
        if file and (Path(file).is_absolute() or ".." in Path(file).parts or "\\" in file):
            raise ValueError(f"asset {a.id!r} names the file {file!r}; a path inside assets/ is allowed")
    if a.kind in ("object", "fixture") and not all(0.0 < e <= LARGEST for e in a.extent):
        raise ValueError(f"asset {a.id!r} has extent {a.extent}; more than 0 and at most {LARGEST} m is allowed")
    if a.kind == "object" and not 0.0 < a.mass < 1000.0:
        raise ValueError(f"asset {a.id!r} has mass {a.mass}; more than 0 and less than 1000 kg is allowed")


def user_root() -> Path:
    """The folder of the user's models: $HAZARD_MS_ASSETS, else hazard_ms/assets among the user's data. It may not be there yet."""
    if os.environ.get(USER_FOLDER):
        return Path(os.environ[USER_FOLDER]).expanduser().absolute()
    data = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(data).absolute() / "hazard_ms" / "assets"


def user_index() -> dict[str, Asset]:
    """The user's models by id; none where there is no index. Raises ValueError that names the row for anything not as it must be."""
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
            raise ValueError(f"asset {found.id!r} stands twice in {folder / 'index.json'}; ids must differ")
        made[found.id] = found
    return made


def user_rows(folder: Path) -> list[Any]:
    """The rows of the index in `folder`, as they stand there; none where there is no index. Raises ValueError for what is no list."""
    file = confined(folder, "index.json")
    if not file.is_file():
        return []
    if file.stat().st_size > LARGEST_INDEX:
        raise ValueError(f"{file} has {file.stat().st_size} bytes; at most {LARGEST_INDEX} are allowed")
    try:
        rows = json.loads(file.read_bytes())
    except (RecursionError, ValueError) as error:
        raise ValueError(f"{file} is no JSON: {error}") from None
    if not isinstance(rows, list):
        raise ValueError(f"{file} holds {rows!r:.100}; a list of rows is allowed")
    return rows


def read_user_row(row: Any, folder: Path) -> Asset:
    """One row of the user's index, checked; its files as full paths, which must be inside `folder`."""
    a = _read(row)
    if not USER_ID.fullmatch(a.id):
        raise ValueError(f"asset {a.id!r:.100} in {folder}: an id of at most 40 lower-case letters, digits and _ is allowed")
    if a.id in index():
        raise ValueError(f"asset {a.id!r} in {folder} is the name of a shipped one; hazard-ms assets remove {a.id}")
    if a.category not in CATEGORIES or a.kind != CATEGORIES[a.category].kind:
        raise ValueError(f"asset {a.id!r} is of category {a.category!r:.100}, kind {a.kind!r}; allowed: {', '.join(CATEGORIES)}")
    if not LICENCE.fullmatch(a.licence):
        raise ValueError(f"asset {a.id!r} has licence {a.licence!r:.100}; the name of a licence, of at most 80 characters, is allowed")
    numbers = (*(v for box in a.boxes for v in box), *(v for s in a.supports for v in (s.z, *s.min, *s.max, s.clearance)))
    if not all(math.isfinite(v) for v in (*numbers, *a.extent, a.mass)):
        raise ValueError(f"asset {a.id!r} holds numbers that are not finite")
    visual, hulls = (str(confined(folder, file)) if file else "" for file in (a.visual, a.hulls))
    for path in (visual, hulls):
        if path and not Path(path).is_file():
            raise ValueError(f"asset {a.id!r}: there is no file {path}; hazard-ms assets remove {a.id}")
    return replace(a, visual=visual, hulls=hulls)


def confined(folder: Path, file: str) -> Path:
    """The full path of `file` in `folder`. Raises ValueError where it leads out of the folder, by whatever link."""
    path = (folder / file).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise ValueError(f"{file!r:.200} leads out of {folder}; only files inside are allowed")
    return path


def asset(name: str) -> Asset:
    """The asset called `name`, shipped or the user's."""
    if name in index():
        return index()[name]
    if name in user_index():
        return user_index()[name]
    if name.startswith(plain.PREFIX):
        return _plain(name)
    known = ", ".join((*sorted(index()), *sorted(user_index())))
    raise ValueError(f"no asset is called {name!r}; there are {known}. Models of your own belong into {user_root()}: hazard-ms assets add")


@lru_cache(maxsize=1024)
def _plain(name: str) -> Asset:
    """A shape without a file, of edge 1 m: see hazard_ms.plain."""
    boxes, source = plain.boxes_of(name), "hazard_ms.plain"
    return Asset(name, "fixture", "", "", "own work", "hazard_ms", source, "", boxes=boxes, extent=(1.0, 1.0, 1.0), mass=plain.MASS)


def asset_ids(category: str | None = None, kind: str | None = None, users: bool = False) -> tuple[str, ...]:
    """Ids of the shipped assets of a category, of a kind, or all, in the order of the index; with `users`, then the user's."""
    rows = (*index().values(), *(user_index().values() if users else ()))
    return tuple(a.id for a in rows if (category is None or a.category == category) and (kind is None or a.kind == kind))


def asset_path(file: str) -> Path:
    """The full path of a file that the index names."""
    return root() / file
