"""The rows of an index of models: one asset each, checked when it is read.

Every model has its base at z = 0, is centred in x and y, z up, in metres.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

KINDS = ("object", "fixture", "structure", "texture", "sky")
LARGEST = 20.0  # edge of a model, at most [m]
HEAVIEST = 1000.0  # [kg] [ours]
LONGEST_TEXT = 2000  # of an entry [characters]


@dataclass(frozen=True)
class Support:
    """A level rectangle on which things can be placed, in the asset's frame."""

    z: float  # [m]
    min: tuple[float, float]  # [m]
    max: tuple[float, float]  # [m]
    clearance: float = 2.0  # free height above it [m]


@dataclass(frozen=True)
class Asset:
    """A model, texture or sky: one row of an index."""

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


def read_row(row: Any) -> Asset:
    """The asset in one row of an index. Raises ValueError that names the row and what is wrong with it."""
    if not isinstance(row, dict):
        raise ValueError(f"a row of the index must be an object, got {row!r:.100}")
    name = row.get("id", "?")
    known = [f.name for f in fields(Asset)]
    unknown = sorted(set(row) - set(known))
    if unknown:
        raise ValueError(f"entries of asset {name!r:.100} must be among {', '.join(known)}, got {unknown!r:.200}")
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
            raise ValueError(f"{entry} must be a text of at most {LONGEST_TEXT} characters, got {values[entry]!r:.100}")
    values["mass"], values["faces"] = float(row.get("mass", 0.0)), int(row.get("faces", 0))
    return values


def _support(row: dict[str, Any]) -> Support:
    low, high = _numbers(row["min"], 2), _numbers(row["max"], 2)
    return Support(float(row["z"]), (low[0], low[1]), (high[0], high[1]), float(row.get("clearance", 2.0)))


def _numbers(values: Any, count: int) -> tuple[float, ...]:
    made = tuple(float(v) for v in values)
    if len(made) != count:
        raise ValueError(f"an entry must be {count} numbers, got {values!r:.100}")
    return made


def _check(a: Asset) -> None:
    if a.kind not in KINDS:
        raise ValueError(f"kind of asset {a.id!r} must be one of {', '.join(KINDS)}, got {a.kind!r}")
    for file in (a.visual, a.hulls):
        if file and (Path(file).is_absolute() or ".." in Path(file).parts or "\\" in file):
            raise ValueError(f"files of asset {a.id!r} must be paths inside its folder, got {file!r}")
    if a.kind in ("object", "fixture") and not all(0.0 < e <= LARGEST for e in a.extent):
        raise ValueError(f"extent of asset {a.id!r} must be above 0 and at most {LARGEST} m, got {a.extent}")
    if a.kind == "object" and not 0.0 < a.mass < HEAVIEST:
        raise ValueError(f"mass of asset {a.id!r} must be above 0 and below {HEAVIEST:g} kg, got {a.mass}")
