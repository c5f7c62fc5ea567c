"""The ground around a place that is taken: the place itself, its roads, and the lots that are built on."""

from __future__ import annotations

import math
from typing import NamedTuple

from hazard_ms.effects.streets.mesh import Frame
from hazard_ms.spec import Room

ROADS = ("asphalt", "pavement", "gravel")  # materials of patches on which nobody builds
FARTHEST = 15.0  # a road leads at least this far out of the place [m]
MARGIN = 0.02  # [m]

Rectangle = tuple[float, float, float, float]  # left, lower, right, upper [m]


class Strip(NamedTuple):
    """A road that leads out of one side: from `low` to `high` along the side [m]."""

    low: float
    high: float
    asphalt: tuple[float, float] | None  # the part on which vehicles drive
    paved: bool  # whether it has a pavement or asphalt: houses stand beside it


class Lots:
    """The ground that is taken so far."""

    def __init__(self, room: Room) -> None:
        self._room = room
        (x, y), beyond = room.size, room.beyond
        self._taken: list[Rectangle] = [(-beyond, -beyond, x + beyond, y + beyond)]
        self._taken += [(*p.min, *p.max) for p in room.patches if p.material in ROADS]

    def take(self, at: Frame, width: float, depth: float) -> bool:
        """Take a lot with its front at `at`, `depth` [m] behind it, if it is free."""
        corners = at.at([(-width / 2, 0, 0), (width / 2, depth, 0)])
        a, b = corners[:, :2].min(0) + MARGIN, corners[:, :2].max(0) - MARGIN
        lot = float(a[0]), float(a[1]), float(b[0]), float(b[1])
        if any(lot[0] < r[2] and r[0] < lot[2] and lot[1] < r[3] and r[1] < lot[3] for r in self._taken):
            return False
        self._taken.append(lot)
        return True

    def material(self, at: Frame) -> str:
        """The material of the ground at a place."""
        found = self._room.floor
        for p in self._room.patches:
            if p.min[0] <= at.x <= p.max[0] and p.min[1] <= at.y <= p.max[1]:
                found = p.material
        return found


def strips(room: Room, frame: Frame, edge: float) -> tuple[Strip, ...]:
    """The roads that cross the line `edge` [m] outwards from the middle, in the frame of that side."""
    back = Frame(0.0, 0.0, -frame.turn)
    spans: list[tuple[float, float, str]] = []
    for p in room.patches:
        if p.material not in ROADS:
            continue
        corners = back.at(
            [(p.min[0] - frame.x, p.min[1] - frame.y, 0.0), (p.max[0] - frame.x, p.max[1] - frame.y, 0.0)]
        )
        (a, c), (b, d) = (sorted(float(v) for v in corners[:, k]) for k in (0, 1))
        if b < edge and d > edge + FARTHEST:
            spans.append((a, c, p.material))
    made: list[Strip] = []
    for a, c, material in sorted(spans):
        drive = (a, c) if material == "asphalt" else None
        if made and a < made[-1].high + 0.3:
            last = made[-1]
            made[-1] = Strip(last.low, max(last.high, c), drive or last.asphalt, last.paved or material != "gravel")
        else:
            made.append(Strip(a, c, drive, material != "gravel"))
    return tuple(s for s in made if math.isfinite(s.low))
