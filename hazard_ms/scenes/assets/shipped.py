"""The models that come with the package. Scenes are generated from these only, so that no scene differs between users.

Files lie in the checkout's `assets/`, or in the installed package.
"""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path
from typing import Any

from hazard_ms.scenes.assets.rows import Asset, read_row

LICENCES = ("CC0-1.0", "CC-BY-3.0", "CC-BY-3.0-US", "CC-BY-4.0", "own work")


@lru_cache(maxsize=1)
def root() -> Path:
    """The folder of the shipped assets. Raises ValueError if there is none."""
    here = Path(__file__).resolve().parents[2]
    for folder in (here.parent / "assets", here / "_assets"):
        if (folder / "index.json").is_file():
            return folder
    raise ValueError(f"{here.parent / 'assets'} or {here / '_assets'} must hold an index.json, got neither")


@lru_cache(maxsize=1)
def shipped_index() -> dict[str, Asset]:
    """The shipped assets by id. Raises ValueError that names the row for anything that is not as it must be."""
    rows = json.loads((root() / "index.json").read_text(encoding="utf-8"))
    made: dict[str, Asset] = {}
    for row in rows:
        found = read_shipped_row(row)
        if found.id in made:
            raise ValueError(f"ids in the index must differ, got {found.id!r} twice")
        made[found.id] = found
    return made


def read_shipped_row(row: Any) -> Asset:
    """The asset in one row of the shipped index. Raises ValueError that names the row and what is wrong with it."""
    found = read_row(row)
    if found.licence not in LICENCES:
        raise ValueError(f"licence of asset {found.id!r} must be one of {', '.join(LICENCES)}, got {found.licence!r}")
    return found
