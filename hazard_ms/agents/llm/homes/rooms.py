"""The rooms of a home as its explorer can tell them apart: floor that walls and doors divide, in its own map alone.

A cell is open where it was explored and nothing on it is as high as WALL. Openings that were seen are drawn as walls,
and walls are thickened by a cell, so that gaps in what was seen of them do not join rooms. What is then connected, by
sides of cells, and has at least SMALLEST of floor, is a room. Rooms are numbered as they are found, and each keeps its
number by a cell that was in its middle then: a room of which two parts were found apart has the lower number.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sensing.semantic_map import SemanticMap

WALL = 1.4  # height from which what stands on a cell divides rooms [m] [ours: above tables, below lintels]
SMALLEST = 1.0  # floor of a room, at least [m2] [ours: a store has 5]
BESIDE = 0.8  # distance from the floor of a room within which a place is in it [m] [ours: half a table]
STEP = 0.5  # distance from an opening at which the rooms on its two sides are looked for [m] [ours]


class Rooms:
    """The rooms of one episode; `see` brings them up to date with the map."""

    def __init__(self) -> None:
        self._anchors: dict[int, tuple[int, int]] = {}  # a cell, y and x, of each room by its number
        self._labels = self._near = np.zeros((1, 1), np.int32)  # the room of each cell, [Y, X]; 0: none
        self._origin, self._cell = np.zeros(2), 1.0  # of the map [m]

    def see(self, seen: SemanticMap, openings: tuple[KnownOpening, ...]) -> None:
        """Find the rooms of the map `seen`, which `openings` divide."""
        self._origin, self._cell = np.asarray(seen.origin, np.float64), float(seen.cell)
        walls = (~seen.explored | (seen.height >= WALL)).astype(np.uint8)
        barred = walls.copy()
        for opening in openings:
            self._bar(barred, walls, opening)
        solid = cv2.dilate((barred * seen.explored).astype(np.uint8), np.ones((3, 3), np.uint8))
        clear = ((solid == 0) & (barred == 0)).astype(np.uint8)
        _, parts, stats, centroids = cv2.connectedComponentsWithStats(clear, connectivity=4)
        large = np.flatnonzero(stats[:, cv2.CC_STAT_AREA] * self._cell**2 >= SMALLEST)
        large = large[large > 0]
        numbers = self._numbers(parts, large.tolist(), centroids)
        table = np.zeros(len(stats), np.int32)
        for part, number in numbers.items():
            table[part] = number
        self._labels = table[parts]
        self._near = self._spread()

    def _bar(self, barred: NDArray[np.uint8], walls: NDArray[np.uint8], opening: KnownOpening) -> None:
        """Draw an opening as a wall: along the axis on which more of what is beside it is wall."""
        half = opening.width / 2 + 2 * self._cell
        ends = {}
        for axis in (0, 1):
            step = np.eye(2)[axis] * half
            ends[axis] = [self._at(np.array(opening.position[:2]) + side * step) for side in (-1, 1)]
        count = {axis: sum(int(_patch(walls, *end).any()) for end in pair) for axis, pair in ends.items()}
        axis = max(count, key=lambda a: (count[a], -_open_beyond(walls, ends[a])))
        (y0, x0), (y1, x1) = ends[axis]
        cv2.line(barred, (x0, y0), (x1, y1), 1, 2)

    def _at(self, place: NDArray[np.floating] | tuple[float, ...]) -> tuple[int, int]:
        """The cell, y and x, of a place [m]."""
        x, y = np.floor((np.asarray(place[:2], np.float64) - self._origin) / self._cell).astype(int)
        return int(y), int(x)

    def _numbers(self, parts: NDArray[np.int32], large: list[int], centroids: NDArray[np.float64]) -> dict[int, int]:
        """The numbers of rooms by the `large` connected `parts`; new ones get the next numbers."""
        made: dict[int, int] = {}
        for number, (y, x) in sorted(self._anchors.items()):
            part = int(parts[y, x])
            if part in large:
                made.setdefault(part, number)
        for part in large:
            if part not in made:
                cells = np.argwhere(parts == part)
                middle = cells[np.argmin(((cells - centroids[part][::-1]) ** 2).sum(1))]
                made[part] = 1 + max(self._anchors, default=0)
                self._anchors[made[part]] = int(middle[0]), int(middle[1])
        return made

    def _spread(self) -> NDArray[np.int32]:
        """The room of every cell within BESIDE of one: that of the nearest cell that has one, [Y, X]."""
        free = (self._labels == 0).astype(np.uint8)
        if free.all():
            return self._labels
        away, nearest = cv2.distanceTransformWithLabels(free, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
        of_label = np.zeros(int(nearest.max()) + 1, np.int32)
        of_label[nearest[free == 0]] = self._labels[free == 0]
        return np.where(away * self._cell <= BESIDE, of_label[nearest], 0).astype(np.int32)

    def at(self, place: NDArray[np.floating] | tuple[float, ...]) -> str | None:
        """The name of the room, "room_1", at a `place` [m], [2] or [3], world frame; None where none is known."""
        y, x = self._at(place)
        inside = 0 <= y < self._near.shape[0] and 0 <= x < self._near.shape[1]
        number = int(self._near[y, x]) if inside else 0
        return f"room_{number}" if number else None

    def joined(self, opening: KnownOpening) -> list[str]:
        """The names of the rooms on the two sides of an opening, as far as they are known."""
        found: list[str] = []
        middle = np.array(opening.position[:2])
        for axis in (0, 1):
            sides = [self.at(middle + side * STEP * np.eye(2)[axis]) for side in (-1, 1)]
            names = [name for name in sides if name is not None]
            if len(set(names)) > len(set(found)):
                found = sorted(set(names), key=lambda name: int(name.rpartition("_")[2]))
        return found


def _patch(walls: NDArray[np.uint8], y: int, x: int) -> NDArray[np.uint8]:
    """The cells around one, [3, 3]."""
    return walls[max(y - 1, 0) : y + 2, max(x - 1, 0) : x + 2]


def _open_beyond(walls: NDArray[np.uint8], ends: list[tuple[int, int]]) -> int:
    """The number of cells around `ends` that are no wall."""
    return int(sum((_patch(walls, *end) == 0).sum() for end in ends))
