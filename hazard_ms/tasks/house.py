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
# Water of `paper` in homes: it comes in at the outer doors, rises by a step in EVERY frames, and its surface slopes by
# SLOPE [degrees]. In rooms it takes 10 frames and 3 degrees, but homes have four times the floor (72 to 120 m2), and at
# 3 degrees it would have to stand 0.5 m deep at a door to get 10 m into a home. At 60 frames a step, rescues alone save
# three quarters of what is at risk, at 40 three fifths [ours; results/scenes.md]
EVERY, SLOPE = 40, 1.0


def hazard_house_fire(physics: str = "paper", severity: str = USUAL) -> Task:
    """The task HazardHouseFire-v1 with the physics of a preset. Raises ValueError for unknown names."""
    return _in_homes("house", [fire(physics, severity)], "extinguish")


def hazard_house_flood(physics: str = "paper", severity: str = USUAL) -> Task:
    """The task HazardHouseFlood-v1 with the physics of a preset. Raises ValueError for unknown names."""
    water = flood(physics, severity)
    made = dataclasses.replace(water, every=EVERY, through_doors=True, slope=SLOPE) if physics == "paper" else water
    return _in_homes("house_flood", [made], "put_on", "block")


def _in_homes(family: str, hazards: Sequence[Hazard], *mitigations: str) -> Task:
    made = rescue(hazards, family, MOST_VALUE)
    return dataclasses.replace(made, several_rooms=True, mitigations=(*DOORS, *mitigations), averted=True)
