"""The rooms of a scene, and the openings between them and to the outside, as the smoke of a realistic fire sees them.

Partitions cut a scene into rooms that stand in a row along x or y; rooms without an opening between them share nothing.
Limit: partitions across the first one's direction are left out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from hazard_ms.scenes.walls import WALLS
from hazard_ms.spec import Opening, Room

OUTSIDE = -1  # in place of a room's number


class Part(NamedTuple):
    """One of the rooms in a row."""

    end: float  # where it ends along the row [m]
    area: float  # area of its floor [m^2]
    edge: float  # circumference [m]


def across(room: Room) -> bool:
    """Whether the rooms stand in a row along y; else along x."""
    return bool(room.partitions) and room.partitions[0].axis == "x"


def parts(room: Room) -> list[Part]:
    """The rooms of a scene, in a row from west to east or from south to north."""
    length, wide = reversed(room.size) if across(room) else room.size
    walls = sorted((p.at, p.thickness) for p in room.partitions if p.axis == room.partitions[0].axis)
    starts = [0.0, *(at + thick / 2 for at, thick in walls)]
    stops = [*(at - thick / 2 for at, thick in walls), length]
    ends = [*(at for at, _ in walls), math.inf]
    sizes = [max(stop - start, 0.1) for start, stop in zip(starts, stops, strict=True)]
    return [Part(end, size * wide, 2.0 * (size + wide)) for end, size in zip(ends, sizes, strict=True)]


def joined(room: Room, openings: Sequence[Opening]) -> list[tuple[int, int]]:
    """The rooms on both sides of each of the `openings`, the second OUTSIDE in outer walls.

    Those in a partition that is left out join a room with itself, and pass nothing.
    """
    row = parts(room)
    inner = sorted((p for p in room.partitions if p.axis == room.partitions[0].axis), key=lambda p: p.at)
    names = {p.name: k for k, p in enumerate(inner)}
    outer = {*WALLS}
    return [
        (names[o.wall], names[o.wall] + 1)
        if o.wall in names
        else (_part_at(room, row, o), OUTSIDE)
        if o.wall in outer
        else (0, 0)
        for o in openings
    ]


def _part_at(room: Room, row: list[Part], opening: Opening) -> int:
    """Number of the room at an opening of an outer wall."""
    ends = {"south": 0, "north": -1} if across(room) else {"west": 0, "east": -1}
    if opening.wall in ends:
        return ends[opening.wall] % len(row)
    return next(k for k, part in enumerate(row) if opening.centre <= part.end)
