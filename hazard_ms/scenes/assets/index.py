"""Finds assets by name, shipped ones and the user's, and their files. No torch, no SAPIEN."""

from __future__ import annotations

import difflib
from functools import lru_cache
from pathlib import Path

from hazard_ms.scenes.assets import primitives
from hazard_ms.scenes.assets.rows import Asset
from hazard_ms.scenes.assets.shipped import root, shipped_index
from hazard_ms.scenes.assets.user_models import user_index, user_root


def asset(name: str) -> Asset:
    """The asset called `name`: a shipped one, the user's, or a plain shape. Raises ValueError for unknown names."""
    if name in shipped_index():
        return shipped_index()[name]
    if name in user_index():
        return user_index()[name]
    if name.startswith(primitives.PREFIX):
        return _plain(name)
    names = (*shipped_index(), *user_index())
    close = difflib.get_close_matches(name, names, n=3)
    hint = f"did you mean {', '.join(close)}? " if close else ""
    raise ValueError(
        f"asset must be one of {len(names)} models, got {name!r} ({hint}hazard-ms assets list names them; "
        f"hazard-ms assets add puts models of your own into {user_root()})"
    )


@lru_cache(maxsize=1024)
def _plain(name: str) -> Asset:
    """A shape without a file, of edge 1 m: see hazard_ms.scenes.assets.primitives."""
    boxes, source = primitives.boxes_of(name), "hazard_ms.scenes.assets.primitives"
    return Asset(
        name,
        "fixture",
        "",
        "",
        "own work",
        "hazard_ms",
        source,
        "",
        boxes=boxes,
        extent=(1.0, 1.0, 1.0),
        mass=primitives.MASS,
    )


def asset_ids(category: str | None = None, kind: str | None = None, users: bool = False) -> tuple[str, ...]:
    """Ids of the shipped assets of a category, of a kind, or all, in the order of the index.

    With `users`, those of the user's models follow.
    """
    rows = (*shipped_index().values(), *(user_index().values() if users else ()))
    return tuple(
        a.id for a in rows if (category is None or a.category == category) and (kind is None or a.kind == kind)
    )


def asset_path(file: str) -> Path:
    """The full path of a file that the index names."""
    return root() / file
