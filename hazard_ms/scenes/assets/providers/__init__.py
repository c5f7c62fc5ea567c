"""Models of other collections, for users who have downloaded them; the shipped models remain the default."""

from __future__ import annotations

from hazard_ms.scenes.assets.providers.base import Provider
from hazard_ms.scenes.assets.providers.objaverse import Objaverse
from hazard_ms.scenes.assets.providers.partnet import PartNetMobility
from hazard_ms.scenes.assets.providers.ycb import Ycb

PROVIDERS: dict[str, type[Provider]] = {p.name: p for p in (Ycb, PartNetMobility, Objaverse)}


def provider(name: str) -> Provider:
    """The provider called `name`, with its data where its download puts them. Raises ValueError for unknown names."""
    if name not in PROVIDERS:
        raise ValueError(f"provider must be one of {', '.join(PROVIDERS)}, got {name!r:.100}")
    return PROVIDERS[name]()
