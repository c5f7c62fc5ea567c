"""The agent's start in the original's scenes: exactly there, unless our wider robots would be stuck in furniture."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy import ndimage

from hazard_ms.scenes import boxes
from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.floor import RUG_HEIGHT, Grid, cell_of, free_for
from hazard_ms.spec import AgentStart, Body, Fixture, Room, Vec2
from hazard_ms.spec.catalogue import CATEGORIES

START_HEADING = math.pi / 2  # the original's agent looks along +z [rad]
ROBOT_RADIUS = 0.29  # of the widest robot, Fetch [m]
CLEARANCE_HEIGHT = 1.2  # what hangs higher is above a robot [m]
STEP, FARTHEST = 0.05, 1.5  # between the places that are tried, and of the last from the original's [m] [ours]
DIRECTIONS = 24  # directions that are tried
POCKET = 0.1  # parts of the free floor smaller than this share of it are no place to start from [-] [ours]


def start(wanted: Vec2, room: Room, things: Sequence[Body | Fixture]) -> tuple[AgentStart, str]:
    """The start nearest to `wanted` [m] where the robot touches no furniture and is not shut in by it.

    Returns it with a note, which is empty if the start is exactly there.
    """
    standing = [boxes.box_of(t, asset(t.asset).extent) for t in things if CATEGORIES[t.category].kind == "fixture"]
    obstacles = [b for b in standing if b.low < CLEARANCE_HEIGHT and b.high > RUG_HEIGHT]
    wide = _wide(room, obstacles)
    for ring in range(round(FARTHEST / STEP) + 1):
        for k in range(DIRECTIONS if ring else 1):
            angle = 2.0 * math.pi * k / DIRECTIONS
            at = (
                round(wanted[0] + ring * STEP * math.cos(angle), 6),
                round(wanted[1] + ring * STEP * math.sin(angle), 6),
            )
            if _free(at, room, obstacles) and _within(wide, at):
                note = f"the agent starts {ring * STEP:.2f} m from its place, where furniture is in its way"
                return AgentStart(at, START_HEADING), note if ring else ""
    return AgentStart(wanted, START_HEADING), "the agent starts in the furniture: there is no place near"


def _free(at: Vec2, room: Room, obstacles: Sequence[Box]) -> bool:
    if not room.open_air and not all(ROBOT_RADIUS <= at[k] <= room.size[k] - ROBOT_RADIUS for k in (0, 1)):
        return False
    x, y = np.array(at[0]), np.array(at[1])
    return all(b.distance(x, y) >= ROBOT_RADIUS for b in obstacles)


def _wide(room: Room, obstacles: Sequence[Box]) -> Grid:
    """The free floor without its pockets, a cell wider than it is, [X, Y]; all of it where nothing is free."""
    free = free_for(room, obstacles, [], ROBOT_RADIUS)
    label, _ = ndimage.label(free)
    sizes = np.bincount(label.ravel())
    large = (sizes >= POCKET * sizes[1:].sum())[label] & free
    return ndimage.binary_dilation(large, np.ones((3, 3))) if large.any() else np.ones_like(free)


def _within(part: Grid, at: Vec2) -> bool:
    """Whether `at` [m] lies in the mask `part`, [X, Y], or outside of the grid, which is open ground."""
    i, j = cell_of(at)
    return not (0 <= i < part.shape[0] and 0 <= j < part.shape[1]) or bool(part[i, j])
