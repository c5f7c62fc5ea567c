"""Paths over the height grid of what was seen, by Dijkstra on cells whose cost grows exponentially with height.

    cost of a cell = exp(STEEPNESS x highest point under the robot's footprint there) x (UNSEEN where nothing was seen)

A book on the floor is therefore worth a small detour, a chair a long one, and a table is never driven into. A robot
that already stands too close to something (it was pushed, or the map is coarse) still finds a path away from it.

An obstacle may end anywhere in its cell. Where half a cell decides whether the robot fits, a path is expensive, but
allowed: otherwise no robot would try the gaps of furnished rooms, of which many are only 0.1 m wider than it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse

from hazard_ms.skills.motor.searching import Aim, by_graph, cheapest, graph_of, straighten, tied, trace
from hazard_ms.skills.sightlines import behind

STEEPNESS = 10.0  # growth of the cost with height [1/m] (docs/benchmark.md 3: exponential in the height)
FLOOR = 0.03  # heights below this count as floor, given the noise of a 16 bit depth image [m]
LOW = 0.15  # things up to this height can be pushed aside, higher ones are obstacles [m]
UNSEEN = 3.0  # factor of the cost of an unexplored cell
NARROW = 1.5  # factor of the cost of a cell within NARROW_MARGIN of an obstacle
NARROW_MARGIN = 0.15  # distance from obstacles beyond the robot's radius that a path should keep [m]
# cost of a cell where half a cell more, and half a cell less, decides whether the robot fits: as 5 to 20 m of detour
# for each metre [ours]
TIGHT = (5.0, 20.0)
OBSTACLE_COST = 1e6  # cost of a cell in which an obstacle stands
LEAVING_COST = 20.0  # cost of such a cell where the robot already is
SHORT = 3.0  # cost of ending a metre short of the goal, in metres of path
AT_MOST = 0.6  # distance from where a path should end up to which SHORT holds, unless another is given [m]
FAR_SHORT = 1000.0  # cost of ending a metre short of the goal beyond that, in metres of path
BORDER = 10  # number of unexplored cells around the explored ones that a path may use


@dataclass(frozen=True)
class Path:
    """A path for the base."""

    points: NDArray[np.float64]  # [P, 2] [m], without the start
    length: float  # [m]
    short: float  # horizontal distance that is left to the goal at its end [m]; infinite behind a wall


def plan(
    height: NDArray[np.floating],
    explored: NDArray[np.bool_],
    cell: float,
    origin: NDArray[np.floating],
    start: tuple[float, float],
    goal: tuple[float, float],
    radius: float,
    near: float,
    enough: float | None = None,
) -> Path | None:
    """The best path from `start` to within `near` [m] of `goal`, or as near as a robot gets without a long detour.

    `height` [Y, X] [m], `explored` [Y, X], `cell` [m], `origin`: south-west corner of cell 0, 0 [m]; `radius` of the
    robot [m]. It is worth any detour to end within `enough` [m] of the goal, not behind a wall; None: AT_MOST more than
    `near`. None if start or goal lies outside the grid, or if nothing brings the robot nearer.
    """
    return Ways(height, explored, cell, origin, start, (goal,), radius).path(goal, near, enough)


class Ways:
    """All cheapest paths from one place over what was seen: one search serves every goal."""

    def __init__(
        self,
        height: NDArray[np.floating],
        explored: NDArray[np.bool_],
        cell: float,
        origin: NDArray[np.floating],
        start: tuple[float, float],
        goals: Sequence[tuple[float, float]],
        radius: float,
    ) -> None:
        """Search from `start`; arguments as for `plan`. The grid is cut to what was seen, `start` and `goals` [m]."""
        self._grid = _Grid(height, explored, cell, np.asarray(origin, dtype=np.float64), start, goals)
        if not self._grid.holds:
            return
        self._start, self._single = np.asarray(start), len(goals) == 1
        self._cost = _costs(self._grid.height, self._grid.explored, cell, radius, self._grid.start)
        self._first = self._grid.start[0] * self._cost.shape[1] + self._grid.start[1]
        if not self._single:
            self._search(None)

    def _search(self, aim: Aim | None) -> None:
        """Search from the start: everywhere, or until the best end of a path to `aim` is known."""
        limit = OBSTACLE_COST * self._grid.cell / 2
        self._reached, self._before = cheapest(self._cost, self._grid.cell, self._first, limit, aim)
        settled = (self._reached < limit) & (self._cost.ravel() < OBSTACLE_COST)
        self._number = np.flatnonzero(settled)
        self._spent = self._reached[self._number]
        self._centres = self._grid.centres(np.stack(np.divmod(self._number, self._cost.shape[1]), -1))

    def _end(self, goal: tuple[float, float], near: float, enough: float) -> tuple[int, float] | None:
        """Number of the cell where the best path to `goal` ends, and the distance left from it [m]; None: no path.

        It is infinite where a wall stands between them.
        """
        if not self._grid.holds:
            return None
        if self._single:
            x, y = np.asarray(goal) - self._grid.centres(np.zeros((1, 2), np.int64))[0]
            self._search(Aim(x, y, near, max(near, enough), SHORT, FAR_SHORT))
        best = self._best(goal, near, enough)
        hidden = best is not None and bool(self._behind(np.array([best]), goal)[0])
        if hidden:
            if self._single:
                self._search(None)
            best = self._best(goal, near, enough, walls=True)
            hidden = bool(self._behind(np.array([best]), goal)[0])
        if best is None:
            return None
        return int(self._number[best]), np.inf if hidden else float(np.hypot(*(self._centres[best] - goal)))

    def _best(self, goal: tuple[float, float], near: float, enough: float, walls: bool = False) -> int | None:
        """Index of the best end of a path to `goal` among the cells that were reached; `walls`: whether they count."""
        if not len(self._number):
            return None
        far = np.hypot(*(self._centres - np.asarray(goal)).T)
        good = far <= max(near, enough)
        cost = self._spent + np.where(good, SHORT, FAR_SHORT) * np.maximum(far - near, 0.0)
        if walls:
            good = np.flatnonzero(good)
            cost[good[self._behind(good, goal)]] += FAR_SHORT * AT_MOST
        return int(np.argmin(cost))

    def _behind(self, ends: NDArray[np.int64], goal: tuple[float, float]) -> NDArray[np.bool_]:
        """Whether a wall stands between each of `ends`, indices of cells that were reached, [N], and `goal`: [N]."""
        return behind(self._grid.height, self._grid.cell, self._grid.origin, self._centres[ends], goal)

    def _cells(self, end: int) -> NDArray[np.int64]:
        """Cells (y, x) of the cheapest path to the cell `end`, [P, 2]; scipy chooses among equally cheap ones."""
        cells = trace(self._before, end, self._cost.shape[1])
        if tied(cells, self._reached, self._cost, self._grid.cell):
            cells = trace(by_graph(self._cost, self._grid.cell, self._first), end, self._cost.shape[1])
        return cells

    def path(self, goal: tuple[float, float], near: float, enough: float | None = None) -> Path | None:
        """The best path to within `near` [m] of `goal` [m]; see `plan`."""
        end = self._end(goal, near, near + AT_MOST if enough is None else enough)
        if end is None:
            return None
        cells = self._cells(end[0])
        points = self._grid.centres(straighten(cells, self._cost))[1:]
        whole = np.vstack([self._start[None], points])
        return Path(points, float(np.hypot(*np.diff(whole, axis=0).T).sum()), end[1])

    def length(self, goal: tuple[float, float], near: float) -> float:
        """Length [m] of the path to within `near` [m] of `goal` [m] along the cells, up to 8 % above that of `path`.

        It is infinite if no path ends within AT_MOST of there.
        """
        end = self._end(goal, near, near + AT_MOST)
        if end is None or end[1] - near > AT_MOST:
            return float("inf")
        cells = self._cells(end[0])
        return float(np.hypot(*np.diff(cells, axis=0).T).sum() * self._grid.cell)


class _Grid:
    """The part of the map that a path can use: explored cells, start and goals, and a border."""

    def __init__(
        self,
        height: NDArray[np.floating],
        explored: NDArray[np.bool_],
        cell: float,
        origin: NDArray[np.float64],
        start: tuple[float, float],
        goals: Sequence[tuple[float, float]],
    ) -> None:
        ends = np.floor((np.array([start, *goals]) - origin) / cell).astype(int)[:, ::-1]
        self.holds = bool((ends >= 0).all() and (ends < height.shape).all())
        seen = np.argwhere(explored)
        used = np.vstack([ends, seen.min(0)[None], seen.max(0)[None]]) if len(seen) else ends
        low = np.maximum(used.min(0) - BORDER, 0)
        high = np.minimum(used.max(0) + BORDER + 1, height.shape)
        window = (slice(low[0], high[0]), slice(low[1], high[1]))
        self.height, self.explored = np.asarray(height)[window], np.asarray(explored)[window]
        self.cell, self.origin = cell, origin + low[::-1] * cell
        self.start = (int(ends[0, 0] - low[0]), int(ends[0, 1] - low[1]))

    def centres(self, cells: NDArray[np.int64]) -> NDArray[np.float64]:
        """Middles [m] of cells (y, x), [P, 2] -> (x, y), [P, 2]."""
        return self.origin + (cells[:, ::-1] + 0.5) * self.cell


def _disc(radius: float, cell: float) -> NDArray[np.bool_]:
    reach = int(np.ceil(radius / cell))
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    return np.hypot(y, x) * cell <= radius


def known_floor(
    height: NDArray[np.floating], cell: float, radius: float
) -> tuple[NDArray[np.float64], sparse.csr_matrix]:
    """Costs [Y, X] of the cells of a floor that is known everywhere, and the graph of steps between them.

    `height` [Y, X] [m], `cell` [m], `radius` of the robot [m].
    """
    cost = _costs(height, np.ones(height.shape, bool), cell, radius, None)
    return cost, graph_of(cost, cell)


def _costs(
    height: NDArray[np.floating], explored: NDArray[np.bool_], cell: float, radius: float, start: tuple[int, int] | None
) -> NDArray[np.float64]:
    raised = np.where(explored & (height > FLOOR), height, 0.0)
    free = raised <= LOW
    # without an obstacle scipy measures the distance from a corner of the grid
    gap = np.full(free.shape, np.inf) if free.all() else ndimage.distance_transform_edt(free) * cell
    low = np.where(free, raised, 0.0)
    under = ndimage.maximum_filter(low, footprint=_disc(radius + cell / 2, cell), mode="constant")
    cost = (
        np.exp(STEEPNESS * under)
        * np.where(explored, 1.0, UNSEEN)
        * np.where(gap <= radius + NARROW_MARGIN, NARROW, 1.0)
    )
    lacking = (radius + cell / 2 - gap) / cell  # 0: the robot fits wherever the obstacle ends in its cell; 1: nowhere
    tight = TIGHT[0] + (TIGHT[1] - TIGHT[0]) * np.clip(lacking, 0.0, 1.0)
    cost = np.where(lacking >= 0.0, np.maximum(cost, tight), cost)
    if start is None:  # wherever the robot may be: no way to leave an obstacle
        return np.where(lacking > 1.0, OBSTACLE_COST, cost)
    y, x = np.mgrid[0 : cost.shape[0], 0 : cost.shape[1]]
    here = np.hypot(y - start[0], x - start[1]) * cell <= radius + cell
    cost = np.where(lacking > 1.0, np.where(here & free, LEAVING_COST, OBSTACLE_COST), cost)
    cost[start] = min(cost[start], LEAVING_COST)
    return cost
