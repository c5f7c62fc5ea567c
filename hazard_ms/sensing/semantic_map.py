"""What an agent has seen so far, on a grid of the floor: height, explored, object, hazard level; and its memory of objects.

The grid is centred on the agent's start and does not know the room. It is written from depth images alone: every pixel becomes a
point of the world and marks the cell below it. Arrays are [Y, X]: `height[y, x]` belongs to the square of edge `cell` whose
south-west corner is `origin + cell * (x, y)`. As in the original, points 2.5 m above the floor or higher are dropped.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.camera import AGENT, NOTHING
from hazard_ms.sensing.view import View

CELL = 0.1  # edge of a cell [m] (benchmark rules 2)
CELLS = 256  # along each side, at least: 25.6 m, room enough around any start in a room of 12 m
CEILING = 2.5  # points from here upwards are dropped [m] (original utils/model.py:282)
GRID = 128  # columns of the image that mark cells: with 120 degrees one per 0.1 m at 4 m; rows see the floor at a flat angle, so
# of them all are used in the lower half, where the floor is, and GRID / 2 in the upper
EYESHOT = 4.0  # how far around a scene's area things are worth remembering [m] [ours]
ENOUGH = 3  # pixels from which a thing counts as seen: a key at 2 m has about that many in an image of 256 x 256
OWN_RADIUS = 0.45  # of the robot with its arm tucked; its own points are dropped here when no labels tell them [m]
SLACK = 0.1  # a median that moves by less may be due to the angle of view [m]
REMEMBERED = 256  # hazard levels kept per object, the newest


def cells_for(size: tuple[float, float], cell: float = CELL) -> int:
    """Cells along each side of a map that holds an area of `size` [m], wherever in it the agent starts."""
    return max(CELLS, 2 * round((max(size) + EYESHOT) / cell))


@dataclass(frozen=True)
class Sighting:
    """What is remembered of one thing."""

    position: NDArray[np.float32]  # median of the points seen of it, [3] [m]
    radius: float  # horizontal distance of the farthest of these points from the median [m]
    top: float  # height of the highest of them [m]
    frame: int  # when it was last seen
    pixels: int  # that its position rests on
    hazard: float = float("nan")  # mean level over it when last seen [C] or [m]
    damaged: bool = False  # when last seen
    history: tuple[tuple[int, float], ...] = ()  # (frame, level), oldest first


class SemanticMap:
    """Map and memory of one episode.

    height     [Y, X]  highest point seen [m]; 0 where nothing was
    explored   [Y, X]  bool; a point was seen there
    object_id  [Y, X]  index of the uppermost thing seen there; -1: none
    hazard     [Y, X]  level when last seen [C] or [m]; NaN where never seen
    objects            index of a thing -> Sighting
    """

    def __init__(self, centre: tuple[float, float], loose: NDArray[np.bool_], cell: float = CELL, cells: int = CELLS) -> None:
        """`centre`: where the agent starts [m]; `loose` [B]: which things can be moved, so that old traces of them are wiped."""
        if cell <= 0.0 or cells < 1:
            raise ValueError(f"a map of {cells} cells of {cell} m is none; both must be positive")
        self.cell = cell
        self.origin = np.round(np.asarray(centre, dtype=np.float64) / cell).astype(np.int64) * cell - cells // 2 * cell
        self.loose = np.asarray(loose, dtype=bool)
        shape = (cells, cells)
        self._firm = np.zeros(shape, np.float32)  # height of what stays
        self._light = np.zeros(shape, np.float32)  # height of what can be moved
        self.explored = np.zeros(shape, bool)
        self.object_id = np.full(shape, -1, np.int32)
        self.hazard = np.full(shape, np.nan, np.float32)
        self.objects: dict[int, Sighting] = {}
        self.frame = -1  # of the last update

    @property
    def height(self) -> NDArray[np.float32]:
        """Highest point seen in each cell [m], [Y, X]; 0 where nothing was."""
        return np.maximum(self._firm, self._light)

    @property
    def in_view(self) -> tuple[int, ...]:
        """Things seen in the last update."""
        return tuple(i for i, s in self.objects.items() if s.frame == self.frame)

    @property
    def seen_damaged(self) -> frozenset[int]:
        """Things that were damaged when they were last seen."""
        return frozenset(i for i, s in self.objects.items() if s.damaged)

    def cell_of(self, position: NDArray[np.floating] | tuple[float, ...]) -> tuple[int, int]:
        """(y, x) of the cell below `position` [m]; may lie outside the map."""
        x, y = np.floor((np.asarray(position[:2]) - self.origin) / self.cell).astype(int)
        return int(y), int(x)

    def centre_of(self, y: int, x: int) -> tuple[float, float]:
        """Middle of a cell [m], world frame."""
        return float(self.origin[0] + (x + 0.5) * self.cell), float(self.origin[1] + (y + 0.5) * self.cell)

    def update(
        self,
        view: View,
        frame: int,
        agent: tuple[float, float],
        ignore: Collection[int] = (),
        damaged: NDArray[np.bool_] | None = None,
    ) -> None:
        """Enter one `view`. `agent`: where it stands [m]; `ignore`: things not to map (in its hand, rescued); `damaged` [B]."""
        if frame < self.frame:
            raise ValueError(f"a view of frame {frame} comes after one of frame {self.frame}; views must come in order")
        self.frame = frame
        if view.labels is not None:
            self._see_objects(view, frozenset(ignore), damaged)
        self._mark(view, *_pixels(*view.depth.shape), agent, ignore)

    def _see_objects(self, view: View, ignore: frozenset[int], damaged: NDArray[np.bool_] | None) -> None:
        labels = view.labels
        assert labels is not None
        flat = np.flatnonzero((labels.ravel() >= 0) & (view.depth.ravel() > 0.0))
        label = labels.ravel()[flat]
        counts = np.bincount(label, minlength=len(self.loose))
        order = np.argsort(label, kind="stable")
        ends = np.cumsum(counts)
        for index in np.flatnonzero(counts >= ENOUGH).tolist():
            if index in ignore:
                continue
            pixels = flat[order[ends[index] - counts[index] : ends[index]]]
            pixels = pixels[:: max(1, len(pixels) // 400)]  # a median of 400 is as good as one of 20,000
            seen = self._sighting(view, pixels, int(counts[index]), damaged is not None and bool(damaged[index]))
            self._remember(index, seen)

    def _sighting(self, view: View, pixels: NDArray[np.int64], count: int, damaged: bool) -> Sighting:
        row, column = np.divmod(pixels, view.depth.shape[1])
        points = view.points(row, column)
        middle = np.median(points, axis=0)
        radius = float(np.hypot(*(points[:, :2] - middle[:2]).T).max())
        level = view.level_at(row, column)
        mean = float("nan") if level is None else float(level.mean())
        return Sighting(middle, radius, float(points[:, 2].max()), self.frame, count, mean, damaged, ((self.frame, mean),))

    def _remember(self, index: int, seen: Sighting) -> None:
        """Keep the better of two views of a thing that stayed where it was; follow one that moved."""
        known = self.objects.get(index)
        if known is not None:
            moved = float(np.linalg.norm(seen.position - known.position)) > known.radius + SLACK
            history = (*known.history, *seen.history)[-REMEMBERED:]
            if not moved and seen.pixels < known.pixels // 2:
                seen = replace(known, frame=seen.frame, hazard=seen.hazard, damaged=seen.damaged)
            seen = replace(seen, history=history)
        self.objects[index] = seen
        if self.loose[index]:
            self._wipe(index)
            self._stamp(index, seen)

    def _stamp(self, index: int, seen: Sighting) -> None:
        """Mark the cell of a thing that may be smaller than the spacing of the pixels that mark cells."""
        y, x = self.cell_of(seen.position)
        if 0 <= y < len(self.explored) and 0 <= x < len(self.explored) and seen.top < CEILING:
            self.object_id[y, x] = index
            self._light[y, x] = max(float(self._light[y, x]), seen.top)

    def _mark(
        self, view: View, row: NDArray[np.int64], column: NDArray[np.int64], agent: tuple[float, float], ignore: Collection[int]
    ) -> None:
        label = np.full(row.shape, NOTHING) if view.labels is None else view.labels[row, column]
        points = view.points(row, column)
        x, y = np.floor((points[:, :2] - self.origin) / self.cell).astype(np.int64).T
        size = len(self.explored)
        keep = (view.depth[row, column] > 0.0) & (points[:, 2] < CEILING) & (label != AGENT)
        keep &= (x >= 0) & (x < size) & (y >= 0) & (y < size)
        if view.labels is None:
            keep &= np.hypot(points[:, 0] - agent[0], points[:, 1] - agent[1]) > OWN_RADIUS
        if ignore:
            keep &= ~np.isin(label, list(ignore))
        x, y, label, z = x[keep], y[keep], label[keep], points[keep, 2]
        loose = np.zeros(len(label), bool)
        loose[label >= 0] = self.loose[label[label >= 0]]
        np.maximum.at(self._firm, (y[~loose], x[~loose]), z[~loose])
        np.maximum.at(self._light, (y[loose], x[loose]), z[loose])
        self.explored[y, x] = True
        self._mark_objects(y, x, z, label)
        level = view.level_at(row[keep], column[keep])
        if level is not None:
            self._mark_hazard(y * size + x, level)

    def _mark_objects(self, y: NDArray[np.int64], x: NDArray[np.int64], z: NDArray[np.float32], label: NDArray[np.int64]) -> None:
        top = (label >= 0) & (z >= self.height[y, x] - 0.02)  # [m]; lower points belong to what stands beneath
        order = np.flatnonzero(top)[np.argsort(z[top], kind="stable")]  # of several in a cell the last, highest, stays
        self.object_id[y[order], x[order]] = label[order]

    def _mark_hazard(self, cell: NDArray[np.int64], level: NDArray[np.float32]) -> None:
        """Mean level of the points in each cell replaces the old one."""
        count = np.bincount(cell, minlength=self.hazard.size)
        total = np.bincount(cell, weights=level, minlength=self.hazard.size)
        seen = np.flatnonzero(count)
        self.hazard.ravel()[seen] = total[seen] / count[seen]

    def mark_free(self, position: tuple[float, float], radius: float) -> None:
        """The agent stands at `position` [m] with a footprint of `radius` [m]: nothing else does."""
        reach = int(np.ceil(radius / self.cell))
        cy, cx = self.cell_of(position)
        size = len(self.explored)
        y, x = np.mgrid[max(0, cy - reach) : min(size, cy + reach + 1), max(0, cx - reach) : min(size, cx + reach + 1)]
        far = np.hypot(self.origin[0] + (x + 0.5) * self.cell - position[0], self.origin[1] + (y + 0.5) * self.cell - position[1])
        y, x = y[far <= radius], x[far <= radius]
        self.explored[y, x] = True
        self._firm[y, x] = 0.0
        self._light[y, x] = 0.0
        self.object_id[y, x] = -1

    def forget(self, index: int) -> None:
        """Remove a thing that is no longer there: picked up, or rescued."""
        self.objects.pop(index, None)
        self._wipe(index)

    def _wipe(self, index: int) -> None:
        trace = self.object_id == index
        self._light[trace] = 0.0
        self.object_id[trace] = -1


@lru_cache(maxsize=4)
def _pixels(height: int, width: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Row and column of the pixels that mark cells, [P] each."""
    rows = np.r_[0 : height // 2 : max(1, height // GRID), height // 2 : height]
    columns = np.arange(0, width, max(1, width // GRID))
    return np.repeat(rows, len(columns)), np.tile(columns, len(rows))
