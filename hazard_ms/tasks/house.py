"""Rescues in homes of several rooms: fire and water spread from room to room, and act on the rescuer, too.

The targets have values of their own, 1 to 20, and an episode lasts 3,000 frames (docs/benchmark.md 1.1).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from hazard_ms.hazards.base import Hazard
from hazard_ms.hazards.presets import fire, flood
from hazard_ms.spec import Task
from hazard_ms.spec.catalogue import MOST_VALUE
from hazard_ms.spec.severity import USUAL
from hazard_ms.tasks.rescue import rescue

DOORS = ("open", "shut")
# frames from one rise of the water by 1 cm to the next in `paper`: a home has four times the floor of a room, for which
# it is 10 (docs/physics.md 1.2) [ours]
RISES_EVERY = 40


def hazard_house_fire(physics: str = "paper", severity: str = USUAL) -> Task:
    """The task HazardHouseFire-v1 with the physics of a preset. Raises ValueError for unknown names."""
    return _in_homes([fire(physics, severity)], "extinguish")


def hazard_house_flood(physics: str = "paper", severity: str = USUAL) -> Task:
    """The task HazardHouseFlood-v1 with the physics of a preset. Raises ValueError for unknown names."""
    made = flood(physics, severity)
    made = dataclasses.replace(made, every=RISES_EVERY) if physics == "paper" else made
    return _in_homes([made], "put_on")


def _in_homes(hazards: Sequence[Hazard], *mitigations: str) -> Task:
    made = rescue(hazards, "house", MOST_VALUE)
    return dataclasses.replace(made, several_rooms=True, mitigations=(*DOORS, *mitigations), averted=True)
