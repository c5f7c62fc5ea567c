"""Compound rescue: any of the registered hazards act together.

It is played in the open with carts if one of the hazards needs that, else in rooms with the bag. A hazard that tells
others something (`provides`) advances before those that use it (`uses`): water puts fires out and keeps what it has
wetted from burning, and wind drives fire over the ground (hazard_ms.hazards.fire.coupling).
"""

from __future__ import annotations

from collections.abc import Sequence

from hazard_ms.hazards.base import Hazard
from hazard_ms.hazards.presets import hazard
from hazard_ms.spec import Task
from hazard_ms.spec.registry import HAZARDS
from hazard_ms.spec.severity import USUAL
from hazard_ms.tasks.rescue import rescue

DEFAULT = ("flood", "fire")  # hazards of the task unless others are asked for


def hazard_compound(physics: str = "paper", hazards: Sequence[str] = DEFAULT, severity: str = USUAL) -> Task:
    """The task HazardCompound-v1 with these `hazards`, each with the physics of a preset.

    Raises ValueError for no hazards, unknown ones, the same one twice, and ones that use each other's fields.
    """
    if isinstance(hazards, (list, tuple)) and not hazards:
        raise ValueError(f"hazards must be some of {', '.join(HAZARDS)}, each once, got {hazards!r}")
    return rescue(acting(hazards, physics, severity))


def acting(hazards: Sequence[str], physics: str, severity: str = USUAL) -> tuple[Hazard, ...]:
    """The hazards called `hazards`, each with the physics of a preset, in the order in which they advance.

    Raises ValueError for unknown ones, the same one twice, and ones that use each other's fields.
    """
    known = isinstance(hazards, (list, tuple)) and all(isinstance(h, str) and h in HAZARDS for h in hazards)
    if not known or len(set(hazards)) < len(hazards):
        raise ValueError(f"hazards must be some of {', '.join(HAZARDS)}, each once, got {hazards!r}")
    return in_order([hazard(name, physics, severity) for name in HAZARDS if name in hazards])


def in_order(hazards: Sequence[Hazard]) -> tuple[Hazard, ...]:
    """`hazards` in such an order that each comes after those whose fields it uses, and otherwise unchanged.

    Raises ValueError for hazards that use each other's fields.
    """
    left, done = list(hazards), list[Hazard]()
    while left:
        ready = [h for h in left if not any(set(h.uses) & set(other.provides) for other in left if other is not h)]
        if not ready:
            raise ValueError(f"hazards must not use each other's fields in a circle, got {[h.name for h in left]}")
        done.append(ready[0])
        left.remove(ready[0])
    return tuple(done)
