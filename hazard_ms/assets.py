"""The index of models: what each asset is, how large and heavy, where its files are, and whose work it is.

Files lie in the checkout's `assets/`, or in the installed package. Every model has its base at z = 0, is centred in x and y, z up, in
metres. No torch, no SAPIEN.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from functools import lru_cache
from pathlib import Path
from typing import Any

KINDS = ("object", "fixture", "structure", "texture", "sky")
LICENCES = ("CC0-1.0", "CC-BY-3.0", "CC-BY-3.0-US", "CC-BY-4.0", "own work")
LARGEST = 20.0  # edge of a model, at most [m]


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
    visual: str  # file below assets/
    licence: str  # one of LICENCES
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
    name = row.get("id", "?")
    unknown = set(row) - {f.name for f in fields(Asset)}
    if unknown:
        raise ValueError(f"asset {name!r} has unknown entries {sorted(unknown)}; allowed: {[f.name for f in fields(Asset)]}")
    values = dict(row)
    values["boxes"] = tuple(tuple(float(v) for v in box) for box in row.get("boxes") or ())
    values["supports"] = tuple(
        Support(s["z"], tuple(s["min"]), tuple(s["max"]), s.get("clearance", 2.0)) for s in row.get("supports") or ()
    )
    values["extent"] = tuple(float(v) for v in row.get("extent") or (0, 0, 0))
    values["hulls"] = row.get("hulls") or ""
    values["sha256"] = tuple(sorted((row.get("sha256") or {}).items()))
    try:
        found = Asset(**values)
    except TypeError as error:
        raise ValueError(f"asset {name!r} lacks an entry: {error}") from None
    _check(found)
    return found


def _check(a: Asset) -> None:
    if a.kind not in KINDS:
        raise ValueError(f"asset {a.id!r} is of kind {a.kind!r}; allowed: {', '.join(KINDS)}")
    if a.licence not in LICENCES:
        raise ValueError(f"asset {a.id!r} has licence {a.licence!r}; allowed: {', '.join(LICENCES)}")
    for file in (a.visual, a.hulls):
        if file and (Path(file).is_absolute() or ".." in Path(file).parts):
            raise ValueError(f"asset {a.id!r} names the file {file!r}; a path inside assets/ is allowed")
    if a.kind in ("object", "fixture") and not all(0.0 < e <= LARGEST for e in a.extent):
        raise ValueError(f"asset {a.id!r} has extent {a.extent}; more than 0 and at most {LARGEST} m is allowed")
    if a.kind == "object" and not 0.0 < a.mass < 1000.0:
        raise ValueError(f"asset {a.id!r} has mass {a.mass}; more than 0 and less than 1000 kg is allowed")


def asset(name: str) -> Asset:
    """The asset called `name`."""
    if name not in index():
        raise ValueError(f"no asset is called {name!r}; there are {', '.join(sorted(index()))}")
    return index()[name]


def asset_ids(category: str | None = None, kind: str | None = None) -> tuple[str, ...]:
    """Ids of the assets of a category, of a kind, or all, in the order of the index."""
    return tuple(a.id for a in index().values() if (category is None or a.category == category) and (kind is None or a.kind == kind))


def asset_path(file: str) -> Path:
    """The full path of a file that the index names."""
    return root() / file
