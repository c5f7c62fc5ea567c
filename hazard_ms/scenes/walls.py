"""The walls of a room: their names, lengths and thicknesses, points on them, and the openings that fit into them.

The inner faces of the outer walls are at x = 0, x = size[0], y = 0, y = size[1].
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from hazard_ms.spec import Opening, Partition, Room, Vec3

WALL_THICKNESS = 0.12  # of the outer walls [m]
WALLS = ("south", "east", "north", "west")
OPENING_KINDS = ("door", "window", "doorway")


def check(room: Room) -> None:
    """Check that partitions and openings fit into the room.

    Raises ValueError for those that do not, and for patches of ground in a room with walls.
    """
    for p in room.partitions:
        across = room.size[1] if p.axis == "x" else room.size[0]
        if p.axis not in ("x", "y") or p.name in WALLS or not 0.02 <= p.thickness <= p.at <= across - p.thickness:
            raise ValueError(
                f"a partition must have axis x or y, its own name and a place in the room of {room.size} m, got {p}"
            )
    for o in room.openings:
        if o.kind not in OPENING_KINDS or min(o.width, o.height) <= 0.0 or o.sill < 0.0:
            raise ValueError(f"an opening must be one of {', '.join(OPENING_KINDS)} of positive size, got {o}")
        wall_length(room, o.wall)
        if (o.kind == "doorway" and o.wall in WALLS) or (o.kind == "window" and o.wall not in WALLS):
            raise ValueError(
                f"a doorway must be in a partition, a window in one of the walls {', '.join(WALLS)}, got {o}"
            )
        if o.open is not None and (o.kind != "door" or not 0.0 <= o.open <= 1.0):
            raise ValueError(f"open must be a share from 0 to 1, and belong to a door, got {o}")
    if room.open_air and (room.openings or room.partitions):
        raise ValueError(
            f"a place in the open must have no openings or partitions, got {(*room.openings, *room.partitions)}"
        )
    if room.patches and not room.open_air:
        raise ValueError(f"patches of ground must be in the open, got {len(room.patches)} of them in a room with walls")


def partition(room: Room, name: str) -> Partition | None:
    """The partition called `name`; None for one of the four walls. Raises ValueError for unknown names."""
    if name in WALLS:
        return None
    for p in room.partitions:
        if p.name == name:
            return p
    names = (*WALLS, *(p.name for p in room.partitions))
    raise ValueError(f"a wall must be one of {', '.join(names)}, got {name!r}")


def wall_length(room: Room, wall: str) -> float:
    """The inner length of a wall or partition [m]."""
    return room.size[0] if runs_along_x(room, wall) else room.size[1]


def runs_along_x(room: Room, wall: str) -> bool:
    """Whether a wall or partition runs from west to east."""
    inner = partition(room, wall)
    return wall in ("south", "north") if inner is None else inner.axis == "x"


def on_wall(room: Room, wall: str, along: float, z: float, depth: float) -> Vec3:
    """The point of a room [m] that is `along` metres from a wall's west or south end and at the height `z` [m].

    It lies `depth` metres behind the wall's inner face; behind the south or west face of a partition.
    """
    x, y = room.size
    inner = partition(room, wall)
    if inner is not None:
        across = inner.at - inner.thickness / 2 + depth
        return (along, across, z) if inner.axis == "x" else (across, along, z)
    points = {
        "south": (along, -depth, z),
        "north": (along, y + depth, z),
        "west": (-depth, along, z),
        "east": (x + depth, along, z),
    }
    return points[wall]


def thickness_of(room: Room, wall: str) -> float:
    """The thickness of a wall or partition [m]."""
    inner = partition(room, wall)
    return WALL_THICKNESS if inner is None else inner.thickness


def angle(share: float) -> float:
    """Angle of a leaf [rad] that leaves `share` of the width open: 0 where it is shut, a quarter turn where open."""
    return math.acos(min(1.0, max(0.0, 1.0 - share)))


def hinge(room: Room, o: Opening) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """The place of the hinge on the floor [m], and the directions of the shut leaf and of its swing, [2] each."""
    start = on_wall(room, o.wall, o.centre - o.width / 2, 0.0, thickness_of(room, o.wall) / 2)
    along = np.array([1.0, 0.0] if runs_along_x(room, o.wall) else [0.0, 1.0])
    return np.array(start[:2]), along, -along[::-1]
