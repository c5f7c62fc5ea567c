"""Paths over the height grid of what was seen: Dijkstra on cells whose cost grows exponentially with the height in them.

    cost of a cell = exp(STEEPNESS x highest point under the robot's footprint there) x (UNSEEN where nothing was seen)

So a book on the floor makes a small detour worthwhile, a chair a long one, and a table is never driven into. A robot that already
stands too close to something (it was pushed, or the map is coarse) still finds its way out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse
from scipy.sparse import csgraph

STEEPNESS = 10.0  # [1/m]; benchmark rules: the weight is exponential in the height
FLAT = 0.03  # heights below this are floor, given the noise of a 16 bit depth image [m]
LOW = 0.15  # things up to here can be pushed aside, higher ones are obstacles [m]
UNSEEN = 3.0  # how much dearer an unexplored cell is
NARROW = 1.5  # how much dearer a cell within MARGIN of an obstacle is
MARGIN = 0.15  # [m]
BLOCKED = 1e6  # cost of a cell in which an obstacle stands
LEAVING = 20.0  # cost of such a cell where the robot already is
SHORT = 3.0  # metres of way that a metre nearer to the goal is worth
AT_MOST = 0.6  # beyond this distance from where it should end, coming nearer is worth any way [m]
FAR_SHORT = 1000.0
BORDER = 10  # unexplored cells around the explored ones that a path may use
SIDES = ((0, 1), (1, 0), (1, 1), (1, -1))  # half of the eight neighbours


@dataclass(frozen=True)
class Path:
    """Where to drive."""

    points: NDArray[np.float64]  # [P, 2] [m], without the start
    length: float  # [m]
    short: float  # horizontal distance that is left to the goal at its end [m]


def plan(
    height: NDArray[np.floating],
    explored: NDArray[np.bool_],
    cell: float,
    origin: NDArray[np.floating],
    start: tuple[float, float],
    goal: tuple[float, float],
    radius: float,
    near: float,
) -> Path | None:
    """The best path from `start` to within `near` [m] of `goal`, or to as near as a robot gets without a long way round.

    `height` [Y, X] [m], `explored` [Y, X], `cell` [m], `origin`: south-west corner of cell 0, 0 [m]; `radius` of the robot [m].
    None where start or goal lies outside the grid, or nothing brings the robot nearer.
    """
    grid = _Grid(height, explored, cell, np.asarray(origin, dtype=np.float64), start, goal)
    if not grid.holds:
        return None
    cost = _costs(grid.height, grid.explored, cell, radius, grid.start)
    first = grid.start[0] * cost.shape[1] + grid.start[1]
    spent, before = csgraph.dijkstra(_graph(cost, cell), indices=first, return_predecessors=True)
    reachable = (spent.reshape(cost.shape) < BLOCKED * cell / 2) & (cost < BLOCKED)
    y, x = np.nonzero(reachable)
    if not len(y):
        return None
    far = np.hypot(*(grid.centres(np.stack([y, x], -1)) - np.asarray(goal)).T)
    missed = np.maximum(far - near, 0.0)
    best = int(np.argmin(spent[y * cost.shape[1] + x] + np.where(missed <= AT_MOST, SHORT, FAR_SHORT) * missed))
    cells = _trace(before, int(y[best] * cost.shape[1] + x[best]), cost.shape[1])
    corners = _straighten(cells, cost)
    points = grid.centres(corners)[1:]
    whole = np.vstack([np.asarray(start)[None], points])
    return Path(points, float(np.hypot(*np.diff(whole, axis=0).T).sum()), float(far[best]))


class _Grid:
    """The part of the map that a path can use: what was seen, start and goal, and a border."""

    def __init__(
        self,
        height: NDArray[np.floating],
        explored: NDArray[np.bool_],
        cell: float,
        origin: NDArray[np.float64],
        start: tuple[float, float],
        goal: tuple[float, float],
    ) -> None:
        ends = np.floor((np.array([start, goal]) - origin) / cell).astype(int)[:, ::-1]
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


def _costs(
    height: NDArray[np.floating], explored: NDArray[np.bool_], cell: float, radius: float, start: tuple[int, int]
) -> NDArray[np.float64]:
    raised = np.where(explored & (height > FLAT), height, 0.0)
    under = ndimage.maximum_filter(raised, footprint=_disc(radius + cell / 2, cell), mode="constant")
    beside = ndimage.maximum_filter(raised, footprint=_disc(radius + MARGIN, cell), mode="constant")
    cost = np.exp(STEEPNESS * np.minimum(under, LOW)) * np.where(explored, 1.0, UNSEEN) * np.where(beside > LOW, NARROW, 1.0)
    y, x = np.mgrid[0 : cost.shape[0], 0 : cost.shape[1]]
    here = np.hypot(y - start[0], x - start[1]) * cell <= radius + cell
    cost = np.where(under > LOW, np.where(here & (raised <= LOW), LEAVING, BLOCKED), cost)
    cost[start] = min(cost[start], LEAVING)
    return cost


def _graph(cost: NDArray[np.float64], cell: float) -> sparse.csr_matrix:
    """Eight neighbours; a step costs its length times the mean cost of its two cells."""
    number = np.arange(cost.size).reshape(cost.shape)
    rows, columns, weights = [], [], []
    for dy, dx in SIDES:
        a = (slice(0, cost.shape[0] - dy), slice(max(0, -dx), cost.shape[1] - max(0, dx)))
        b = (slice(dy, cost.shape[0]), slice(max(0, dx), cost.shape[1] - max(0, -dx)))
        rows.append(number[a].ravel())
        columns.append(number[b].ravel())
        weights.append(((cost[a] + cost[b]) / 2 * cell * np.hypot(dy, dx)).ravel())
    shape = (cost.size, cost.size)
    half = sparse.coo_matrix((np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))), shape=shape).tocsr()
    return half + half.T


def _trace(before: NDArray[np.int32], end: int, width: int) -> NDArray[np.int64]:
    """Cells (y, x) from the start to `end`, [P, 2]."""
    chain = [end]
    while before[chain[-1]] >= 0:
        chain.append(int(before[chain[-1]]))
    return np.stack(np.divmod(np.array(chain[::-1]), width), axis=-1)


def _straighten(cells: NDArray[np.int64], cost: NDArray[np.float64]) -> NDArray[np.int64]:
    """The fewest of the cells whose straight connections cross nothing dearer than the path does."""
    kept, at = [0], 0
    while at < len(cells) - 1:
        ahead = len(cells) - 1
        while ahead > at + 1 and not _clear(cells[at], cells[ahead], cost, cost[tuple(cells[at : ahead + 1].T)].max()):
            ahead -= 1
        kept.append(ahead)
        at = ahead
    return cells[kept]


def _clear(a: NDArray[np.int64], b: NDArray[np.int64], cost: NDArray[np.float64], limit: float) -> bool:
    steps = int(np.abs(b - a).max()) * 2 + 1
    line = np.rint(a + (b - a) * np.linspace(0.0, 1.0, steps)[:, None]).astype(int)
    return bool((cost[tuple(line.T)] <= limit).all())
