"""The rooms of a scene, and the openings between them and to the outside, as the smoke of a realistic fire sees them.

Partitions cut a scene into a grid of rooms, numbered along x and then along y. Rooms without an opening between them
share nothing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from hazard_ms.scenes.walls import runs_along_x
from hazard_ms.spec import Opening, Partition, Room

OUTSIDE = -1  # in place of a room's number
SIDES = {"south": (1, 0), "west": (0, 0), "north": (1, -1), "east": (0, -1)}  # outer walls: axis and place along it


class Part(NamedTuple):
    """One of the rooms."""

    area: float  # of its floor [m^2]
    edge: float  # circumference [m]


def _cuts(room: Room, axis: int) -> list[Partition]:
    """The partitions that lie one behind the other along an axis: 0 x, 1 y."""
    return sorted((p for p in room.partitions if (p.axis == "x") == (axis == 1)), key=lambda p: p.at)


def ends(room: Room, axis: int) -> list[float]:
    """Coordinates at which rooms end along an axis, 0 x, 1 y [m]; the last ones end nowhere."""
    return [*(p.at for p in _cuts(room, axis)), math.inf]


def parts(room: Room) -> list[Part]:
    """The rooms of a scene by their numbers."""
    sizes = []
    for axis in (0, 1):
        walls = _cuts(room, axis)
        faces = [0.0, *(p.at + side * p.thickness / 2 for p in walls for side in (-1, 1)), room.size[axis]]
        sizes.append([max(stop - start, 0.1) for start, stop in zip(faces[::2], faces[1::2], strict=True)])
    return [Part(x * y, 2.0 * (x + y)) for y in sizes[1] for x in sizes[0]]


def joined(room: Room, openings: Sequence[Opening]) -> list[tuple[int, int]]:
    """The rooms on both sides of each of the `openings`, the second OUTSIDE in outer walls."""
    counts = [len(ends(room, axis)) for axis in (0, 1)]
    found = []
    for o in openings:
        along = 0 if runs_along_x(room, o.wall) else 1  # the axis of its wall
        place = [0, 0]
        place[along] = next(k for k, end in enumerate(ends(room, along)) if o.centre <= end)
        if o.wall in SIDES:
            across, at = SIDES[o.wall]
            place[across] = at % counts[across]
            found.append((place[0] + counts[0] * place[1], OUTSIDE))
        else:
            across = 1 - along
            place[across] = [p.name for p in _cuts(room, across)].index(o.wall)
            first = place[0] + counts[0] * place[1]
            found.append((first, first + (1, counts[0])[across]))
    return found
