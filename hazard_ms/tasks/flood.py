"""Flood rescue: bring the targets into the bag before the water, rising and advancing from one side, drowns them."""

from __future__ import annotations

from hazard_ms.hazards.presets import flood
from hazard_ms.spec import Task
from hazard_ms.spec.severity import USUAL
from hazard_ms.tasks.rescue import rescue


def hazard_flood(physics: str = "paper", severity: str = USUAL) -> Task:
    """The task HazardFlood-v1 with the physics of a preset. Raises ValueError for unknown names."""
    return rescue([flood(physics, severity)])
