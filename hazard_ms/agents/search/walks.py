"""Frames that walks take over what was seen: the cheapest ways past the obstacles of a semantic map."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.sparse import csgraph

from hazard_ms.agents.search.floor_plan import AJAR, FloorPlan, shut_doors
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sketch.travel.ways import WALK
from hazard_ms.skills.motor.navigation import AT_MOST, BORDER, LOW, OBSTACLE_COST, SHORT, known_floor
from hazard_ms.skills.sightlines import behind

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Place = tuple[float, float]  # [m], world frame
STEPS = 1.05  # length of a way by steps to the eight neighbours, over that of straight pieces: mean of all directions
TURNING = 20.0  # frames of a walk that go into turns, starts and stops: about 120 degrees of turns [ours]
NO_DETOUR = 40.0  # frames by which two ways of telling the length of a walk may differ [ours]
LONGEST_DETOUR = 400.0  # frames that count where there is no way now: what floats about may free it [ours]
LEAST_FREED = 2.0  # floor that a robot must gain for a door to be shut [m2] [ours]: more than the leaf itself takes
HINGED = 0.15  # share of a leaf, by its hinge, that a map takes for the wall; it is seen to end as much later [ours]
MOST_CELLS = 16_000  # of a grid that is searched cell by cell; larger ones by squares of four [ours]


def frames_between(
    seen: SemanticMap, start: tuple[float, float], goals: Array, near: Array, radius: float, walls: bool = False
) -> Array:
    """Frames of the walks between G `goals` [m], [G, 2], and the `start` [m], [G + 1, G + 1], the start last.

    A walk ends within `near` [m], [G], of a goal, or a little short of it, where `walls` count on its side of them; inf
    where there is no way. `radius` of the robot [m]. Floor that was never seen counts as free.
    """
    grid = _Grid(seen, np.vstack([goals, start]), radius)
    here = grid.nearest_free(np.asarray(start))
    ends = [*grid.ends(goals, near, here, seen if walls else None), here]
    lengths = grid.lengths(ends)
    frames = WALK / STEPS * lengths + TURNING
    np.fill_diagonal(frames, 0.0)
    return frames


def detours(
    seen: SemanticMap, start: tuple[float, float], goals: Array, near: Array, radius: float, plain: Array
) -> Array:
    """Frames by which walks from `start` to each of G `goals`, [G], take longer over the map than `plain`, [G].

    Arguments as for `frames_between`. At most LONGEST_DETOUR; 0 where there is no plain way either.
    """
    walks = frames_between(seen, start, goals, near, radius)[-1, :-1]
    longer = np.subtract(walks, plain, out=np.zeros(len(walks)), where=np.isfinite(plain))
    return np.clip(longer - NO_DETOUR, 0.0, LONGEST_DETOUR)


def barring(
    seen: SemanticMap, here: tuple[float, float], openings: Sequence[KnownOpening], radius: float
) -> KnownOpening | None:
    """The door to shut, since its leaf stands open in the way: shut, it gives the robot the most floor.

    `here`: where the robot is [m]; `radius`: its own [m]. Floor that was never seen does not count. None where no door
    of `openings` gives LEAST_FREED.
    """
    turned = [o for o in openings if o.leaf is not None and o.open > AJAR and not o.broken]
    if not turned:
        return None
    low = seen.height <= LOW
    before = _floor(seen, low, here, radius)
    freed = []
    for opening in turned:
        assert opening.leaf is not None
        hinge, end = (np.array(at) for at in opening.leaf)
        shut = 2.0 * (np.array(opening.position[:2]) - hinge)
        swung = low.copy()
        swung[_line(seen, hinge, end, (HINGED, 1.0 + HINGED), (-seen.cell, 0.0, seen.cell))] = True
        swung[_line(seen, hinge, hinge + shut, (0.0, 1.0), (0.0,))] = False
        freed.append((_floor(seen, swung, here, radius) - before) * seen.cell**2)
    best = int(np.argmax(freed))
    return turned[best] if freed[best] >= LEAST_FREED else None


def way_end(seen: SemanticMap, here: Place, goal: Place, openings: Sequence[KnownOpening], radius: float) -> Place:
    """The place [m] at which a barred way from `here` to a `goal` [m] ends, `radius` of the robot [m].

    It is the place that the robot gets to from which the way past walls is shortest, or else the goal itself.
    """
    over = _reached(seen, seen.obstacles <= LOW, here, radius)
    points, plan = seen.centre_of(*np.nonzero(over & seen.explored)), FloorPlan(seen, shut_doors(openings))
    left = plan.at(plan.ways_from(goal), points)
    if not np.isfinite(left).any():
        return goal
    x, y = points[int(np.argmin(left))]
    return float(x), float(y)


def _line(
    seen: SemanticMap, start: Array, end: Array, shares: tuple[float, float], beside: Sequence[float]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The cells between two `shares` of the way from `start` to `end` [m], and `beside` it [m], as rows and columns."""
    way = end - start
    across = np.array([-way[1], way[0]]) / np.hypot(*way)
    steps = np.arange(*shares, seen.cell / 2 / np.hypot(*way))[:, None, None]
    points = start + steps * way + np.array(beside)[None, :, None] * across
    x, y = np.moveaxis(np.floor((points - seen.origin) / seen.cell).astype(np.int64), -1, 0)
    inside = (x >= 0) & (y >= 0) & (x < seen.explored.shape[1]) & (y < seen.explored.shape[0])
    return y[inside], x[inside]


def _floor(seen: SemanticMap, low: Mask, here: Place, radius: float) -> int:
    """The number of seen cells that a robot `here` [m] gets over where it may drive over what is `low`, [Y, X]."""
    return int((seen.explored & _reached(seen, low, here, radius)).sum())


def _reached(seen: SemanticMap, low: Mask, here: Place, radius: float) -> Mask:
    """The cells that a robot `here` [m] gets over where it may drive over what is `low`, [Y, X]."""
    fits = ndimage.distance_transform_edt(low) * seen.cell >= radius - seen.cell / 2  # as walks have it
    parts, _ = ndimage.label(fits)
    y, x = np.nonzero(fits)
    if not len(y):
        return np.zeros_like(low)
    nearest = int(np.argmin(np.hypot(*(seen.centre_of(y, x) - here).T)))
    return np.asarray(ndimage.distance_transform_edt(parts != parts[y[nearest], x[nearest]]) * seen.cell <= radius)


class _Grid:
    """The part of a map that walks can use, and what steps over it cost."""

    def __init__(self, seen: SemanticMap, points: Array, radius: float) -> None:
        cells = np.floor((points - seen.origin) / seen.cell).astype(int)[:, ::-1]
        used = np.argwhere(seen.explored)
        ends = np.vstack([cells, used.min(0)[None], used.max(0)[None]]) if len(used) else cells
        inside = np.clip(ends, 0, len(seen.explored) - 1)
        low = np.maximum(inside.min(0) - BORDER, 0)
        high = inside.max(0) + BORDER + 1
        height, self._cell = seen.obstacles[low[0] : high[0], low[1] : high[1]], seen.cell
        if height.size > MOST_CELLS:
            height = ndimage.maximum_filter(height, size=2, origin=-1, mode="nearest")[::2, ::2]
            self._cell *= 2
        cost, self._graph = known_floor(height, self._cell, radius)
        self._free = (cost < OBSTACLE_COST).ravel()
        self._yx = np.stack(np.divmod(np.arange(cost.size), cost.shape[1]), axis=-1)
        self._centres = seen.origin + low[::-1] * seen.cell + (self._yx[:, ::-1] + 0.5) * self._cell

    def nearest_free(self, place: Array) -> int:
        """The number of the free cell nearest to a `place` [m], [2]; of the nearest cell where none is free."""
        far = np.hypot(*(self._centres - place).T)
        return int(np.argmin(np.where(self._free, far, far + OBSTACLE_COST)))

    def ends(self, goals: Array, near: Array, start: int, walls: SemanticMap | None) -> list[int]:
        """The cells where walks from the cell `start` to within `near` [m], [G], of `goals` [m], [G, 2], end; or -1.

        None ends behind one of the `walls` of a map from its goal, if there is one.
        """
        spent = csgraph.dijkstra(self._graph, indices=start)
        spent = np.where(self._free & (spent < OBSTACLE_COST * self._cell / 2), spent, np.inf)
        cells = []
        for goal, enough in zip(goals, near, strict=True):
            missed = np.maximum(np.hypot(*(self._centres - goal).T) - enough, 0.0)
            paid = np.where(missed <= AT_MOST, spent + SHORT * missed, np.inf)
            if walls is not None:
                some = np.flatnonzero(np.isfinite(paid))
                at = float(goal[0]), float(goal[1])
                paid[some[behind(walls.height, walls.cell, walls.origin, self._centres[some], at)]] = np.inf
            best = int(np.argmin(paid))
            cells.append(best if np.isfinite(paid[best]) else -1)
        return cells

    def lengths(self, ends: list[int]) -> Array:
        """Lengths [m] of the cheapest ways between N cells, [N, N]; inf from and to -1."""
        found = np.full((len(ends), len(ends)), np.inf)
        reached = [number for number, cell in enumerate(ends) if cell >= 0]
        cells = [ends[number] for number in reached]
        _, before = csgraph.dijkstra(self._graph, indices=cells, return_predecessors=True)
        for row, chain in zip(reached, before, strict=True):
            for column, cell in zip(reached, cells, strict=True):
                found[row, column] = self._length(chain, cell)
        return found

    def _length(self, before: NDArray[np.int32], end: int) -> float:
        cells = [end]
        while before[cells[-1]] >= 0:
            cells.append(int(before[cells[-1]]))
        return float(np.hypot(*np.diff(self._yx[cells], axis=0).T).sum() * self._cell)
