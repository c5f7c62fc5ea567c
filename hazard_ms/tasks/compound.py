"""Hazards that act together: any of fire, flood and wind in one rescue. With wind it is played in the open, with carts; else in rooms.

Water puts fires out and keeps what it has wetted from burning; wind drives fire over the ground (hazard_ms.hazards.together).
"""

from __future__ import annotations

from collections.abc import Sequence

from hazard_ms import MAX_FRAMES
from hazard_ms.hazards.presets import HAZARDS
from hazard_ms.scenes import splits
from hazard_ms.spec import Task

NAME = "HazardCompound-v1"
ORDER = ("flood", "wind", "fire")  # those that tell others something come first
USUAL = ("flood", "fire")


def hazard_compound(physics: str = "paper", hazards: Sequence[str] = USUAL) -> Task:
    """The task HazardCompound-v1 with these `hazards`, each with the physics of a preset.

    Raises ValueError for none, unknown ones, and the same one twice.
    """
    if isinstance(hazards, str) or not hazards or len(set(hazards)) < len(hazards) or set(hazards) - set(ORDER):
        raise ValueError(f"hazards is {hazards!r}; some of {', '.join(ORDER)}, each once, are allowed")
    family = "outdoor" if "wind" in hazards else "indoor"
    return Task(
        name=NAME,
        scenes=lambda split: splits.scene_names(split, family),
        build=splits.scene,
        hazards=tuple(HAZARDS[name](physics) for name in ORDER if name in hazards),
        max_frames=MAX_FRAMES[NAME],
        splits=splits.split_names(family),
        safe_place="cart" if "wind" in hazards else "bag",
    )
