"""The walls of a home as a map shows them, shut doors among them: what heat, flames and water do not get past.

A cell of the map that reaches up to the lintels of doors is wall, or a leaf that stands there. An open leaf hides a
little of the floor behind it, which no wall does [ours: it is as thin as a cell].
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse
from scipy.sparse import csgraph

from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sensing.semantic_map import SemanticMap

TALL = 1.8  # height from which a cell is wall [m] [ours]: higher than furniture, lower than lintels, where maps end
FAR = 6.0  # distance beyond which no heat is asked for [m] [ours]: longer than most rooms
NEAR = 0.15  # of the ends of a straight line, in which walls do not count [m] [ours]
RAYS = 360  # directions in which sight is told [ours]: 0.1 m apart at 6 m
BORDER = 3  # cells of the window around those that were seen
GAP = 2  # unseen cells between seen ones, on either side of their middle, through which ways lead [ours]
AJAR = 0.05  # share of its width up to which a door is shut [ours]
SIDES = ((0, 1), (1, 0), (1, 1), (1, -1))  # half of the eight neighbours of a cell, (y, x)

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


class FloorPlan:
    """Walls on the part of a map that was seen."""

    def __init__(self, seen: SemanticMap, shut: Sequence[KnownOpening] = ()) -> None:
        """The walls of `seen`, as if the doors `shut` were shut."""
        rows, columns = np.nonzero(seen.explored)
        low = np.array([rows.min(initial=0), columns.min(initial=0)]) - BORDER
        high = np.array([rows.max(initial=0), columns.max(initial=0)]) + BORDER + 1
        low, high = np.maximum(low, 0), np.minimum(high, seen.explored.shape)
        self.window = (slice(low[0], high[0]), slice(low[1], high[1]))
        self._seen, self._cell = seen.explored[self.window], seen.cell
        self._origin = seen.origin + seen.cell * low[::-1]
        tall = seen.height[self.window] >= TALL
        self.wall: Mask = tall | ndimage.binary_closing(tall, np.ones((3, 3), bool))
        self._sights: dict[bytes, Array] = {}
        for opening in shut:
            self._shut(opening)

    def _shut(self, opening: KnownOpening) -> None:
        """Make the cells of a door wall, along the side on which its wall goes on."""
        middle, half = np.array(opening.position[:2]), opening.width / 2
        found = []
        for along in np.eye(2):
            beside = [middle + sign * (half + far) * along for sign in (-1, 1) for far in (0.1, 0.2, 0.3)]
            found.append(sum(bool(self._at(self.wall, point[None])[0]) for point in beside))
        along = np.eye(2)[int(np.argmax(found))]
        steps = np.arange(-half - self._cell, half + 1.5 * self._cell, self._cell / 2)
        y, x = self._cells(middle + steps[:, None] * along).T
        inside = (y >= 0) & (x >= 0) & (y < self.wall.shape[0]) & (x < self.wall.shape[1])
        self.wall[y[inside], x[inside]] = True

    def _cells(self, points: Array) -> NDArray[np.int64]:
        return np.floor((points - self._origin) / self._cell).astype(np.int64)[..., ::-1]

    def _at(self, grid: NDArray, points: Array) -> NDArray:
        """The entries of `grid` at `points` [m], [..., 2]; those of its border beyond it."""
        cells = np.clip(self._cells(points), 0, np.array(grid.shape) - 1)
        return np.asarray(grid[cells[..., 0], cells[..., 1]])

    def beside(self, openings: Sequence[KnownOpening]) -> Array:
        """A grid with 0 where the map was seen within half the width of one of `openings`, inf elsewhere, [Y, X]."""
        grid = np.full(self.wall.shape, np.inf)
        y, x = np.nonzero(~self.wall)
        points = self._origin + (np.stack([x, y], axis=-1) + 0.5) * self._cell
        for o in openings:
            near = np.hypot(*(points - np.array(o.position[:2])).T) <= o.width / 2
            grid[y[near], x[near]] = 0.0
        return grid

    def clear(self, points: Array, sources: Array) -> Mask:
        """Whether heat gets from M `sources` [m], [M, 2 or 3], to P `points` [m], [P, 2 or 3]: bool [P, M].

        Nothing gets farther than FAR. What stands within NEAR of either end hides nothing: things stand by walls.
        """
        here, there = np.asarray(points)[:, :2], np.asarray(sources)[:, :2]
        key = there.tobytes()
        if key not in self._sights:
            self._sights[key] = self._sight(there)
        away = here[:, None] - there
        length = np.hypot(away[..., 0], away[..., 1])
        number = np.rint(np.arctan2(away[..., 1], away[..., 0]) * (RAYS / (2.0 * np.pi))).astype(np.int32) % RAYS
        return np.asarray(length < self._sights[key][np.arange(len(there)), number])

    def _sight(self, places: Array) -> Array:
        """How far heat gets from M `places` [m], [M, 2], in all directions [m], [M, RAYS]; NEAR more before walls."""
        turns = np.arange(RAYS) * 2.0 * np.pi / RAYS
        steps = np.arange(NEAR, FAR, self._cell)
        rays = np.stack([np.sin(turns), np.cos(turns)])[..., None] * (steps / self._cell)  # y, x [cells], [2, R, S]
        size, wall = self.wall.shape, self.wall
        made = np.empty((len(places), RAYS))
        for row, place in enumerate((places - self._origin)[:, ::-1] / self._cell):
            y, x = (place[:, None, None] + rays).astype(np.int32)
            hit = wall[np.clip(y, 0, size[0] - 1), np.clip(x, 0, size[1] - 1)]
            made[row] = np.where(hit.any(axis=1), steps[hit.argmax(axis=1)] + NEAR, FAR)
        return made

    def spread(self, start: Array, per_metre: float) -> Array:
        """The least of `start`, [Y, X] of the window, and `per_metre` times the way from there, [Y, X].

        Ways lead past walls, over cells that were seen; inf where none leads. Values of `start` are 0 or more, or inf.
        """
        open_floor = ~self.wall & ndimage.binary_closing(self._seen, np.ones((3, 3), bool), iterations=GAP)
        number = np.arange(open_floor.size).reshape(open_floor.shape)
        ends, lengths = [], []
        height, width = open_floor.shape
        for y, x in SIDES:
            a = number[: height - y, max(-x, 0) : width - max(x, 0)]
            b = number[y:, max(x, 0) : width - max(-x, 0)]
            both = open_floor.ravel()[a] & open_floor.ravel()[b]
            ends.append((a[both], b[both]))
            lengths.append(np.full(int(both.sum()), np.hypot(y, x) * self._cell * per_metre))
        given = np.flatnonzero(np.isfinite(start.ravel()) & open_floor.ravel())
        if not len(given):
            return np.full(start.shape, np.inf)
        first = open_floor.size  # a node before all others, from which each is as far as its value says
        rows = np.concatenate([*(a for a, _ in ends), np.full(len(given), first)])
        columns = np.concatenate([*(b for _, b in ends), given])
        weight = np.concatenate([*lengths, start.ravel()[given] + 1e-9])
        graph = sparse.csr_matrix((weight, (rows, columns)), shape=(first + 1, first + 1))
        found = csgraph.dijkstra(graph, directed=False, indices=first)[:-1].reshape(start.shape)
        return np.asarray(found, np.float64)

    def seen_at(self, point: Array) -> bool:
        """Whether the cell of a `point` [m], [2], was seen and is not a wall."""
        return bool(self._at(self._seen & ~self.wall, np.asarray(point)[None])[0])

    def ways_from(self, place: tuple[float, float]) -> Array:
        """Lengths of the ways past walls from a `place` [m] to each cell of the window [m], [Y, X]; inf: no way."""
        start = np.full(self.wall.shape, np.inf)
        y, x = np.clip(self._cells(np.array(place)), 0, np.array(start.shape) - 1)
        start[max(y - 1, 0) : y + 2, max(x - 1, 0) : x + 2] = 0.0
        return self.spread(start, 1.0)

    def reached(self, ways: Array, point: NDArray[np.floating]) -> bool:
        """Whether `ways` [m], [Y, X], lead to the cell of a `point` [m], [2] or [3], or to one beside it."""
        y, x = np.clip(self._cells(np.asarray(point, np.float64)[:2]), 0, np.array(ways.shape) - 1)
        return bool(np.isfinite(ways[max(y - 1, 0) : y + 2, max(x - 1, 0) : x + 2]).any())

    def at(self, grid: Array, points: Array) -> Array:
        """The entries of a `grid` of the window, [Y, X], at `points` [m], [P, 2]."""
        return np.asarray(self._at(grid, np.asarray(points, np.float64)), np.float64)


def shut_doors(openings: Sequence[KnownOpening]) -> tuple[KnownOpening, ...]:
    """The doors that were shut when last seen: the map does not show a leaf that nobody looked at since it moved."""
    return tuple(o for o in openings if o.kind == "door" and o.open <= AJAR and not o.broken)
