"""Wind rescue: bring the targets into the shopping carts before the wind, which pushes and turns them, has carried them off."""

from __future__ import annotations

from hazard_ms import MAX_FRAMES
from hazard_ms.hazards.presets import wind
from hazard_ms.scenes import splits
from hazard_ms.spec import Task

NAME = "HazardWind-v1"
FAMILY = "outdoor"


def hazard_wind(physics: str = "paper") -> Task:
    """The task HazardWind-v1 with the physics of a preset."""
    return Task(
        name=NAME,
        scenes=lambda split: splits.scene_names(split, FAMILY),
        build=splits.scene,
        hazards=(wind(physics),),
        max_frames=MAX_FRAMES[NAME],
        splits=splits.split_names(FAMILY),
        safe_place="cart",
    )
