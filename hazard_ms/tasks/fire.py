"""Fire rescue: bring the targets into the bag before the fire, spreading over the floor and from thing to thing, damages them."""

from __future__ import annotations

from hazard_ms import MAX_FRAMES
from hazard_ms.hazards.presets import fire
from hazard_ms.scenes import splits
from hazard_ms.spec import Task

NAME = "HazardFire-v1"


def hazard_fire(physics: str = "paper") -> Task:
    """The task HazardFire-v1 with the physics of a preset."""
    return Task(
        name=NAME,
        scenes=splits.scene_names,
        build=splits.scene,
        hazards=(fire(physics),),
        max_frames=MAX_FRAMES[NAME],
        splits=splits.split_names(),
    )
