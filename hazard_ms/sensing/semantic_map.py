"""Everything that an agent has seen so far: a grid of the floor, and a memory of things.

The grid is centred on the agent's start and does not know the room. It is written from depth images: every pixel is a
point of the world and marks the cell below it. Arrays are [Y, X]: `height[y, x]` belongs to the square of edge `cell`
whose south-west corner is `origin + cell * (x, y)`. As in the original, points from 2.5 m above the floor are dropped.
"""

from __future__ import annotations

import copy
from collections.abc import Collection, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hazard_ms.sensing.camera import AGENT, NOTHING
from hazard_ms.sensing.far_floor import bare_cells, floor_between, pixels
from hazard_ms.sensing.sighting import Sighting, merged, sightings
from hazard_ms.sensing.view import View

MAP_CELL = 0.1  # edge of a cell [m] (docs/benchmark.md 2)
FEWEST_CELLS = 256  # cells along each side at least: 25.6 m, enough around any start in a room of 12 m
CEILING = 2.5  # points at this height or higher are dropped [m] (HAZARD utils/model.py:282)
# Columns of the image that mark cells: with a field of view of 120 degrees one per 0.1 m at 4 m. Rows see the floor at
# a flat angle, so all rows of the lower half are used, where the floor is, and GRID / 2 of the upper half.
GRID = 128
LINTELS = 1.95  # the same where doors divide a place [m] [ours]: lintels, 2.03 m high, would block them in the map
BARRIER = 1.0  # height of the obstacle that barred floor is: higher than steps, lower than walls [m] [ours]
FRESH = 30  # frames for which the traces of furniture that floats are kept [ours]
OWN_RADIUS = 0.45  # radius of the robot with its arm tucked: without labels, points within it are dropped [m]


class SemanticMap:
    """Map and memory of one episode.

    height     [Y, X]     highest point seen [m]; 0 where nothing was
    explored   [Y, X]     bool; whether a point was seen there
    object_id  [Y, X]     index of the uppermost thing seen there; -1 for none
    levels     [K, Y, X]  level of each hazard when last seen, in its unit; NaN where never seen
    told_at    [Y, X]     frame of that; -1 for never
    barred     [Y, X]     bool; whether a hazard kept the agent's base out when it was last seen
    objects               a Sighting for each thing that was seen, by index
    """

    def __init__(
        self,
        centre: tuple[float, float],
        loose: NDArray[np.bool_],
        cell: float = MAP_CELL,
        cells: int = FEWEST_CELLS,
        hazards: int = 1,
        ceiling: float = CEILING,
        clears: bool = False,
    ) -> None:
        """Begin a map of K = `hazards` hazards with `cells` x `cells` cells of edge `cell` [m].

        `centre` [m] is the agent's start; `loose` [B] tells which things can be moved, whose old traces are wiped when
        they are seen elsewhere; points at the height `ceiling` [m] or higher are dropped. Where it `clears`, floor that
        is seen bare ends what stood there: labels do not tell that it moved. Raises ValueError for no cells.
        """
        if cell <= 0.0 or cells < 1:
            raise ValueError(f"cell and cells must be positive, got {cell} m and {cells}")
        self.cell, self.ceiling, self.clears = cell, ceiling, clears
        self.origin = np.round(np.asarray(centre, dtype=np.float64) / cell).astype(np.int64) * cell - cells // 2 * cell
        self.loose = np.asarray(loose, dtype=bool)
        self._stood = ~self.loose  # at the start: a copy, since furniture may float off
        shape = (cells, cells)
        self._firm, self._light = np.zeros((2, *shape), np.float32)  # heights of what stays, of what can be moved [m]
        self.explored, self.barred = np.zeros((2, *shape), bool)
        self.object_id = np.full(shape, -1, np.int32)
        self._seen_at = np.full(shape, -1, np.int32)  # frame in which it was seen there
        self.levels, self.told_at = np.full((hazards, *shape), np.nan, np.float32), np.full(shape, -1, np.int32)
        self.objects: Mapping[int, Sighting] = {}
        self.frame, self._frozen = -1, False  # frame of the last update; whether it can be written to no more

    @property
    def height(self) -> NDArray[np.float32]:
        """Highest point seen in each cell [m], [Y, X]; 0 where nothing was."""
        height = np.maximum(self._firm, self._light)
        height.flags.writeable = False  # it is a copy, so that writing to it would do nothing
        return height

    @property
    def hazard(self) -> NDArray[np.float32]:
        """Level of the first hazard in each cell when last seen [C] or [m], [Y, X]; NaN where never seen."""
        return self.levels[0]

    @property
    def obstacles(self) -> NDArray[np.float32]:
        """Heights of what is in the way of walks [m], [Y, X]: `height`, at least BARRIER where it is `barred`."""
        return np.maximum(self.height, np.where(self.barred, np.float32(BARRIER), np.float32(0.0)))

    def frozen(self) -> SemanticMap:
        """A copy for agents, which raises when it is written to."""
        made = copy.copy(self)
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                value = value.copy()
                value.flags.writeable = False
                setattr(made, name, value)
        made.objects = MappingProxyType(dict(self.objects))
        made._frozen = True
        return made

    def __setattr__(self, name: str, value: object) -> None:
        if self.__dict__.get("_frozen"):
            raise AttributeError(f"{name} must not be set: the map of a decision is read-only")
        super().__setattr__(name, value)

    @property
    def in_view(self) -> tuple[int, ...]:
        """Indices of the things seen in the last update."""
        return tuple(i for i, s in self.objects.items() if s.frame == self.frame)

    @property
    def seen_damaged(self) -> frozenset[int]:
        """Indices of the things that were damaged when they were last seen."""
        return frozenset(i for i, s in self.objects.items() if s.damaged)

    def cell_of(self, position: NDArray[np.floating] | tuple[float, ...]) -> tuple[int, int]:
        """The cell (y, x) below `position` [m], [2] or [3], world frame; it may lie outside the map."""
        x, y = np.floor((np.asarray(position[:2]) - self.origin) / self.cell).astype(int)
        return int(y), int(x)

    def centre_of(self, y: ArrayLike, x: ArrayLike) -> NDArray[np.float64]:
        """Middles [m], [..., 2], world frame, of the cells `y`, `x`, [...] each."""
        return np.asarray(self.origin + self.cell * (np.stack([x, y], axis=-1) + 0.5), np.float64)

    def update(
        self,
        view: View,
        frame: int,
        agent: tuple[float, float],
        ignore: Collection[int] = (),
        damaged: NDArray[np.bool_] | None = None,
    ) -> None:
        """Enter one `view` of `frame` into the map.

        `agent` [m] is the agent's place; `ignore` holds the indices of things that are not mapped, because they are in
        the hand or rescued; `damaged` [B] tells which things are damaged. Raises ValueError for a view that is older
        than the last one.
        """
        if frame < self.frame:
            raise ValueError(f"frame must not be earlier than {self.frame}, the frame of the last view, got {frame}")
        self.frame = frame
        if self.clears:
            self._empty(*bare_cells(view, GRID, agent, self.origin, self.cell, len(self.explored), self.ceiling))
        if view.labels is not None:
            self._see_objects(view, frozenset(ignore), damaged)
        self._mark(view, agent, ignore)
        self._see_floor(view)

    def _see_floor(self, view: View) -> None:
        """Mark the floor between points that lie farther apart than cells, as they do far from the camera."""
        between = floor_between(view, max(1, view.depth.shape[1] // GRID), self.cell)
        x, y = np.floor((between - self.origin) / self.cell).astype(np.int64).T
        inside = (x >= 0) & (x < len(self.explored)) & (y >= 0) & (y < len(self.explored))
        self.explored[y[inside], x[inside]] = True

    def _see_objects(self, view: View, ignore: frozenset[int], damaged: NDArray[np.bool_] | None) -> None:
        found = sightings(view, self.frame, len(self.loose), ignore, damaged)
        self.objects = {**self.objects, **{i: merged(self.objects.get(i), seen) for i, seen in found.items()}}
        for index in found:
            if self.loose[index]:
                self._wipe(index)
                self._stamp(index, self.objects[index])

    def _stamp(self, index: int, seen: Sighting) -> None:
        """Mark the cell of a thing, which may be smaller than the spacing of the pixels that mark cells."""
        y, x = self.cell_of(seen.position)
        if 0 <= y < len(self.explored) and 0 <= x < len(self.explored) and seen.top < self.ceiling:
            self.object_id[y, x] = index
            self._light[y, x] = max(float(self._light[y, x]), seen.top)

    def _mark(self, view: View, agent: tuple[float, float], ignore: Collection[int]) -> None:
        row, column = pixels(*view.depth.shape, GRID)
        label = np.full(row.shape, NOTHING) if view.labels is None else view.labels[row, column]
        points = view.points(row, column)
        x, y = np.floor((points[:, :2] - self.origin) / self.cell).astype(np.int64).T
        size = len(self.explored)
        keep = (view.depth[row, column] > 0.0) & (points[:, 2] < self.ceiling) & (label != AGENT)
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
        levels = view.level_at(row[keep], column[keep])
        if levels is not None:
            self._mark_levels(y * size + x, levels)

    def _mark_objects(
        self, y: NDArray[np.int64], x: NDArray[np.int64], z: NDArray[np.float32], label: NDArray[np.int64]
    ) -> None:
        top = (label >= 0) & (z >= self.height[y, x] - 0.02)  # [m]; lower points belong to things underneath
        order = np.flatnonzero(top)[np.argsort(z[top], kind="stable")]  # the highest of a cell comes last and stays
        self.object_id[y[order], x[order]] = label[order]
        self._seen_at[y[order], x[order]] = self.frame

    def _mark_levels(self, cell: NDArray[np.int64], levels: NDArray[np.float32]) -> None:
        """Replace the levels of each cell by the means of its points' `levels` [K, P]."""
        count = np.bincount(cell, minlength=self.explored.size)
        seen = np.flatnonzero(count)
        for old, new in zip(self.levels, levels, strict=True):
            total = np.bincount(cell, weights=new, minlength=self.explored.size)
            old.ravel()[seen] = total[seen] / count[seen]
        self.told_at.ravel()[seen] = self.frame

    def mark_free(self, position: tuple[float, float], radius: float) -> None:
        """Mark the floor under the agent as free, at `position` [m] with a footprint of `radius` [m]."""
        reach = int(np.ceil(radius / self.cell))
        (cy, cx), size = self.cell_of(position), len(self.explored)
        y, x = np.mgrid[max(0, cy - reach) : min(size, cy + reach + 1), max(0, cx - reach) : min(size, cx + reach + 1)]
        far = np.hypot(*np.moveaxis(self.centre_of(y, x) - position, -1, 0))
        y, x = y[far <= radius], x[far <= radius]
        self.explored[y, x] = True
        self._empty(y, x)

    def _empty(self, y: NDArray[np.int64], x: NDArray[np.int64]) -> None:
        self._firm[y, x], self._light[y, x], self.object_id[y, x] = 0.0, 0.0, -1

    def tell(self, height: NDArray[np.float32], explored: NDArray[np.bool_]) -> None:
        """Enter the true heights of what stays [m], and mark cells as explored, [Y, X] each, without a look."""
        self._firm, self.explored = np.maximum(self._firm, height), self.explored | explored

    def clear(self, points: NDArray[np.float64]) -> None:
        """Forget what stands on the floor at `points` [m], [P, 2], world frame: it has moved away."""
        cells = [self.cell_of(point) for point in points]
        y, x = np.array([c for c in cells if 0 <= min(c) and max(c) < len(self.explored)], int).reshape(-1, 2).T
        self._empty(y, x)

    def forget(self, index: int) -> None:
        """Remove the thing `index`, which is no longer there: it was picked up or rescued."""
        self.objects = {other: sighting for other, sighting in self.objects.items() if other != index}
        self._wipe(index)

    def _wipe(self, index: int) -> None:
        trace = self.object_id == index
        if self._stood[index]:  # of furniture, views show parts: what they showed just now stays
            trace &= self._seen_at < self.frame - FRESH
            self._firm[trace] = 0.0
        self._light[trace] = 0.0
        self.object_id[trace] = -1
