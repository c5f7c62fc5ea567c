"""Wind rescue: bring the targets into the shopping carts before the wind pushes, turns and carries them off."""

from __future__ import annotations

from hazard_ms.hazards.presets import wind
from hazard_ms.spec import Task
from hazard_ms.spec.severity import USUAL
from hazard_ms.tasks.rescue import rescue


def hazard_wind(physics: str = "paper", severity: str = USUAL) -> Task:
    """The task HazardWind-v1 with the physics of a preset. Raises ValueError for unknown names."""
    return rescue([wind(physics, severity)])
