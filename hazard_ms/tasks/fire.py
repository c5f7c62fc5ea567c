"""Fire rescue: bring the targets into the bag before the fire, which spreads over the floor and from thing to thing."""

from __future__ import annotations

from hazard_ms.hazards.presets import fire
from hazard_ms.spec import Task
from hazard_ms.spec.severity import USUAL
from hazard_ms.tasks.rescue import rescue


def hazard_fire(physics: str = "paper", severity: str = USUAL) -> Task:
    """The task HazardFire-v1 with the physics of a preset. Raises ValueError for unknown names."""
    return rescue([fire(physics, severity)])
