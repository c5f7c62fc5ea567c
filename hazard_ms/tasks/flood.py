"""Flood rescue: bring the targets into the bag before the water, rising and advancing from one side, drowns or carries them off."""

from __future__ import annotations

from hazard_ms import MAX_FRAMES
from hazard_ms.hazards.presets import flood
from hazard_ms.scenes import splits
from hazard_ms.spec import Task

NAME = "HazardFlood-v1"


def hazard_flood(physics: str = "paper") -> Task:
    """The task HazardFlood-v1 with the physics of a preset."""
    return Task(
        name=NAME,
        scenes=splits.scene_names,
        build=splits.scene,
        hazards=(flood(physics),),
        max_frames=MAX_FRAMES[NAME],
        splits=splits.split_names(),
    )
