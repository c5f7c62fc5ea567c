"""Models and scenes from other collections, for users who have downloaded them. The shipped models remain the default."""

from __future__ import annotations

from hazard_ms.providers.base import Provider
from hazard_ms.providers.objaverse import Objaverse
from hazard_ms.providers.partnet import PartNetMobility
from hazard_ms.providers.scenes import ArchitecThor, ReplicaCad, RoboCasa
from hazard_ms.providers.ycb import Ycb

PROVIDERS: dict[str, type[Provider]] = {p.name: p for p in (Ycb, PartNetMobility, Objaverse, ReplicaCad, ArchitecThor, RoboCasa)}


def provider(name: str) -> Provider:
    """The provider called `name`, with its data where its download puts them."""
    if name not in PROVIDERS:
        raise ValueError(f"no provider is called {name!r}; there are {', '.join(PROVIDERS)}")
    return PROVIDERS[name]()
