"""The agent's start in the original's scenes: exactly there, unless our wider robot would stand in the furniture."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from hazard_ms.assets.index import asset
from hazard_ms.scenes import boxes
from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.floor import RUG_HEIGHT
from hazard_ms.spec import AgentStart, Body, Fixture, Room, Vec2
from hazard_ms.spec.catalogue import CATEGORIES

START_HEADING = math.pi / 2  # the original's agent looks along +z [rad]
ROBOT_HALF_WIDTH = 0.25  # half the width of a robot's base, nearly: it may touch [m] [ours]
CLEARANCE_HEIGHT = 1.2  # what hangs higher is above a robot [m]
STEP, FARTHEST = 0.05, 1.5  # between the places that are tried, and of the last from the original's [m] [ours]
DIRECTIONS = 24  # directions that are tried


def start(wanted: Vec2, room: Room, things: Sequence[Body | Fixture]) -> tuple[AgentStart, str]:
    """The start nearest to `wanted` [m] where the robot touches no furniture, and a note if that is another place."""
    standing = [boxes.box_of(t, asset(t.asset).extent) for t in things if CATEGORIES[t.category].kind == "fixture"]
    obstacles = [b for b in standing if b.low < CLEARANCE_HEIGHT and b.high > RUG_HEIGHT]
    for ring in range(round(FARTHEST / STEP) + 1):
        for k in range(DIRECTIONS if ring else 1):
            angle = 2.0 * math.pi * k / DIRECTIONS
            at = (
                round(wanted[0] + ring * STEP * math.cos(angle), 6),
                round(wanted[1] + ring * STEP * math.sin(angle), 6),
            )
            if _free(at, room, obstacles):
                note = f"the agent starts {ring * STEP:.2f} m from its place, which is in the furniture" if ring else ""
                return AgentStart(at, START_HEADING), note
    return AgentStart(wanted, START_HEADING), "the agent starts in the furniture: there is no place near"


def _free(at: Vec2, room: Room, obstacles: Sequence[Box]) -> bool:
    if not room.open_air and not all(ROBOT_HALF_WIDTH <= at[k] <= room.size[k] - ROBOT_HALF_WIDTH for k in (0, 1)):
        return False
    x, y = np.array(at[0]), np.array(at[1])
    return all(b.distance(x, y) >= ROBOT_HALF_WIDTH for b in obstacles)
