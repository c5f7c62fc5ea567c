"""The rooms of a scene, and the openings between them and to the outside, as the smoke of a realistic fire sees them.

Partitions cut a scene into rooms that stand in a row along x or y. Limit: partitions across the first one's direction
are left out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from hazard_ms.spec import Opening, Room

GAP = 0.02  # width of the gaps of a closed door or window [m] [docs/physics.md 4.4]
OUTSIDE = -1  # in place of a room's number


class Part(NamedTuple):
    """One of the rooms in a row."""

    end: float  # where it ends along the row [m]
    area: float  # area of its floor [m^2]
    edge: float  # circumference [m]


class Gap(NamedTuple):
    """An opening between two rooms, or between a room and the outside."""

    width: float  # [m]
    sill: float  # height of its lower end [m]
    top: float  # height of its upper end [m]
    widest: float  # width without panes [m]
    room: int  # number of a room
    other: int  # number of the room behind it, or OUTSIDE


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


def openings(room: Room, standing_open: Sequence[Opening] = ()) -> list[Gap]:
    """Doors and windows, which are closed but for gaps, open doorways, and gaps in partitions that have none.

    Doors that are `standing_open` are as wide as they are; those that the room does not have count, too.
    """
    row = parts(room)
    inner = sorted((p for p in room.partitions if p.axis == room.partitions[0].axis), key=lambda p: p.at)
    names = {p.name: k for k, p in enumerate(inner)}
    found = []
    for o in (*room.openings, *(o for o in standing_open if o not in room.openings)):
        top = o.sill + o.height
        if o.wall in names:
            found.append(Gap(o.width, o.sill, top, o.width, names[o.wall], names[o.wall] + 1))
        elif o.kind != "doorway":
            width = o.width if o in standing_open else GAP
            widest = o.width if o.kind == "window" else width
            found.append(Gap(width, o.sill, top, widest, _part_at(room, row, o), OUTSIDE))
    joined = {g.room for g in found if g.other != OUTSIDE}
    found += [Gap(GAP, 0.0, room.height, GAP, k, k + 1) for k in range(len(row) - 1) if k not in joined]
    return found


def _part_at(room: Room, row: list[Part], opening: Opening) -> int:
    """Number of the room at an opening of an outer wall."""
    ends = {"south": 0, "north": -1} if across(room) else {"west": 0, "east": -1}
    if opening.wall in ends:
        return ends[opening.wall] % len(row)
    return next(k for k, part in enumerate(row) if opening.centre <= part.end)
