"""Frames that a robot takes to walk from one place of a scene to another, without a simulator.

    frames = WALK x length + TURN x turns on the spot + SETTLE

Ways lead over the floor that is free at the start of the scene, at the costs of `hazard_ms.skills.motor.navigation` for
a map on which everything was seen. They end where `walk_to` arrives, so that a way of 3 m in an empty room is 2.5 m
long. One search for each goal serves every start; searches are kept.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.floor import OVERHEAD_HEIGHT, boxes_of, partitions
from hazard_ms.sketch.travel.geodesic import Array, Field, direction, fields, leg, on_the_spot
from hazard_ms.skills.motor.navigation import OBSTACLE_COST, known_floor
from hazard_ms.skills.motor.walking import ARRIVED
from hazard_ms.spec import SceneSpec

WALK = 62.0  # frames in which the base drives a metre; a test compares it with the robots' speed
TURN = 30.0 / np.pi  # frames in which it turns by one radian; the same test
SETTLE = 3.0  # frames that the base needs to start and to stop [ours: it is at full speed within two to four]
INDOOR_CELL = 0.1  # edge of a cell in a room [m]: that of agents' maps; at 0.25 m, gaps that a robot passes are shut
OUTDOOR_CELL = 0.2  # edge of a cell in the open [m]; at 0.25 m, some ways between parked cars are shut
RADIUS = 0.29  # of the robots, as they are built by default [m]
EDGE_STEP = 0.1  # things whose edges lie this near to each other share a search [m] [ours]
MOST_FIELDS = 256  # searches that are kept for one scene: 25 MB in a room, 100 MB in the open [ours]
AT_ONCE = 16  # searches in one call of scipy: more only take memory [ours]


class Route(NamedTuple):
    """Ways from places to places, [...] each."""

    metres: Array  # length [m]; inf: no way
    turned: Array  # turns on the spot on the way and, to face the goal, at its end [rad]
    first: Array  # heading in which the way begins [rad]
    last: Array  # heading in which it ends, towards the goal [rad]

    def frames(self, heading: ArrayLike | None = None) -> Array:
        """Frames that the ways take, [...]; inf: no way.

        `heading` [rad], [...], is that of the robot before it; without it, the robot faces the way already.
        """
        before = 0.0 if heading is None else on_the_spot(self.first - np.asarray(heading, np.float64))
        return WALK * self.metres + TURN * (self.turned + before) + SETTLE


class Ways:
    """The ways over the floor of one scene, as it is at the start."""

    def __init__(
        self, spec: SceneSpec, cell: float | None = None, radius: float = RADIUS, bodies: Iterable[str] | None = None
    ) -> None:
        """Prepare the ways of `spec` for a robot of `radius` [m], over cells of edge `cell` [m].

        `bodies` names the bodies that stand in the way: all but the targets where it is None. Raises ValueError for a
        cell or a radius that is not positive, and for unknown names.
        """
        self.cell = (OUTDOOR_CELL if spec.room.open_air else INDOOR_CELL) if cell is None else cell
        self.radius = radius
        if not (0.0 < self.cell < np.inf and 0.0 < radius < np.inf):
            raise ValueError(f"cell and radius must be positive lengths, got {self.cell} m and {radius} m")
        self.origin, height = _heights(spec, self.cell, radius, bodies)
        self._cost, self._graph = known_floor(height, self.cell, radius)
        y, x = np.divmod(np.arange(self._cost.size), self._cost.shape[1])
        self._centres = self.origin + (np.stack([x, y], axis=-1) + 0.5) * self.cell
        self._free, self._nearest = self._reached_from(np.asarray(spec.agent_start.position))
        self._fields: OrderedDict[tuple[int, int], Field] = OrderedDict()

    @property
    def free(self) -> NDArray[np.bool_]:
        """The cells that a robot can get to from its start, bool [Y, X]; `origin` [m] is the corner of cell (0, 0)."""
        return self._free.reshape(self._cost.shape)

    @property
    def places(self) -> Array:
        """Middles of the `free` cells [m], [F, 2]."""
        return self._centres[self._free]

    def frames(self, a: ArrayLike, b: ArrayLike, heading: ArrayLike | None = None, edge: ArrayLike = 0.0) -> Array:
        """Frames of the walks from `a` to things at `b` [m], [..., 2] each: [...], inf for no way.

        `edge`: distance of the things' edges from their middles [m], [...]; `heading`: see `Route.frames`. Raises
        ValueError for points of another shape.
        """
        return self.route(a, b, edge).frames(heading)

    def route(self, a: ArrayLike, b: ArrayLike, edge: ArrayLike = 0.0) -> Route:
        """The ways from `a` to things at `b` [m], [..., 2] each; `edge` [m] and what is raised as for `frames`."""
        start, goal, step = self._ends(a, b, edge)
        made = np.zeros((4, len(start)))
        for rows, field, at, near in self._by_goal(goal, step):
            here, cells = self._stand(start[rows])
            corner, end = self._centres[field.corner[cells]], self._centres[field.end[cells]]
            last = field.corner[cells] == field.end[cells]
            made[0, rows] = leg(here, corner, last, at, near) + field.rest[field.corner[cells]]
            made[0, rows] = np.where(np.isfinite(field.rest[cells]), made[0, rows], np.inf)
            made[1, rows] = field.turned[cells]
            made[2, rows] = direction(here, np.where(last[:, None], at, corner))
            made[3, rows] = direction(end, at)
        shape = np.broadcast_shapes(np.shape(a)[:-1], np.shape(b)[:-1], np.shape(edge))
        return Route(*made.reshape(4, *shape))

    def along(self, a: ArrayLike, b: ArrayLike, metres: ArrayLike, edge: ArrayLike = 0.0) -> Array:
        """The places [m], [..., 2], of a robot that went `metres` [m], [...], of its ways from `a` to things at `b`.

        It stays where it is where there is no way, and goes no further than the end. Other arguments as for `frames`.
        """
        shape = np.broadcast_shapes(np.shape(a)[:-1], np.shape(b)[:-1], np.shape(edge), np.shape(metres))
        start, goal, step = self._ends(np.broadcast_to(np.asarray(a, np.float64), (*shape, 2)), b, edge)
        left = np.broadcast_to(np.asarray(metres, np.float64), shape).ravel()
        for rows, field, at, near in self._by_goal(goal, step):
            start[rows] = self._follow(field, start[rows], left[rows], at, near)
        return start.reshape(*shape, 2)

    def _follow(self, field: Field, start: Array, left: Array, goal: Array, near: float) -> Array:
        """The points [P, 2] [m] that are `left` [P] [m] further on the ways of one field, or at their ends."""
        here, cells = self._stand(start)
        here, moving = np.where(np.isfinite(field.rest[cells])[:, None], here, start), np.isfinite(field.rest[cells])
        while moving.any():
            corner = field.corner[cells]
            last = corner == field.end[cells]
            way = leg(here, self._centres[corner], last, goal, near)
            whole = np.hypot(*(self._centres[corner] - here).T)
            go = np.where(moving, np.minimum(left, way), 0.0)
            here = here + (self._centres[corner] - here) * (go / np.maximum(whole, 1e-9)).clip(0.0, 1.0)[:, None]
            moving = moving & (left > way) & ~last
            left, cells = left - go, np.where(moving, corner, cells)
        return here

    def _ends(self, a: ArrayLike, b: ArrayLike, edge: ArrayLike) -> tuple[Array, Array, NDArray[np.int64]]:
        """Starts and goals, [P, 2] each, and the distances of the goals' edges in steps of EDGE_STEP, [P]."""
        start, goal = _points(a), _points(b)
        shape = np.broadcast_shapes(start.shape[:-1], goal.shape[:-1], np.shape(edge))
        step = np.rint(np.asarray(edge, np.float64) / EDGE_STEP).astype(np.int64)
        flat = (np.broadcast_to(points, (*shape, 2)).reshape(-1, 2).copy() for points in (start, goal))
        return *flat, np.broadcast_to(step, shape).ravel()

    def _by_goal(self, goal: Array, step: NDArray[np.int64]) -> Iterable[tuple[NDArray[np.int64], Field, Array, float]]:
        """Rows of equal goals, the field of each, its goal [m] and how near to that its ways end [m]."""
        cells = self._cell_of(goal)
        pairs, group = np.unique(np.stack([cells, step], axis=-1), axis=0, return_inverse=True)
        rows = np.split(np.argsort(group.ravel(), kind="stable"), np.cumsum(np.bincount(group.ravel()))[:-1])
        for first in range(0, len(pairs), AT_ONCE):
            wanted = [(int(c), int(s)) for c, s in pairs[first : first + AT_ONCE]]
            for key, own, field in zip(wanted, rows[first : first + AT_ONCE], self._kept(wanted), strict=True):
                yield own, field, self._centres[key[0]], ARRIVED + key[1] * EDGE_STEP

    def _kept(self, wanted: list[tuple[int, int]]) -> list[Field]:
        """The fields of goals, given as cell and step of the edge; those that are not kept are made."""
        missing = [key for key in wanted if key not in self._fields]
        if missing:
            near = np.array([ARRIVED + step * EDGE_STEP for _, step in missing])
            goals = self._centres[[goal for goal, _ in missing]]
            cost = np.where(self.free, self._cost, OBSTACLE_COST)
            made = fields(cost, self._graph, self._centres, self.cell, goals, near)
            self._fields.update(zip(missing, made, strict=True))
        for key in wanted:
            self._fields.move_to_end(key)
        found = [self._fields[key] for key in wanted]
        while len(self._fields) > MOST_FIELDS:
            self._fields.popitem(last=False)
        return found

    def _stand(self, points: Array) -> tuple[Array, NDArray[np.int64]]:
        """Where a robot stands that is at `points` [m], [P, 2], and its cell: beside a thing, not in it."""
        cells = self._cell_of(points)
        nearest = self._nearest[cells]
        return np.where(self._free[cells][:, None], points, self._centres[nearest]), nearest

    def _cell_of(self, points: Array) -> NDArray[np.int64]:
        """The numbers of the cells that hold `points` [m], [P, 2], or of those nearest to them, [P]."""
        size = np.array(self._cost.shape[::-1])
        x, y = np.clip(np.floor((points - self.origin) / self.cell).astype(np.int64), 0, size - 1).T
        return y * size[0] + x

    def _reached_from(self, start: Array) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
        """Which cells can be reached from `start` [m], [N], and for each cell the nearest one of these, [N]."""
        walkable = self._cost < OBSTACLE_COST
        if not walkable.any():
            return walkable.ravel(), np.arange(walkable.size)
        nearest = _nearest(walkable)
        label, _ = ndimage.label(walkable, np.ones((3, 3)))
        free = label == label.ravel()[nearest[self._cell_of(start[None])[0]]]
        return free.ravel(), _nearest(free)


def _nearest(mask: NDArray[np.bool_]) -> NDArray[np.int64]:
    """For each cell of a grid, the number of the nearest one in `mask` [Y, X]: [N]."""
    y, x = ndimage.distance_transform_edt(~mask, return_distances=False, return_indices=True)
    return (y.astype(np.int64) * mask.shape[1] + x).ravel()


def _points(points: ArrayLike) -> Array:
    made = np.asarray(points, np.float64)
    if made.ndim < 1 or made.shape[-1] != 2:
        raise ValueError(f"points must have shape [..., 2], got {list(made.shape)}")
    return made


def _heights(spec: SceneSpec, cell: float, radius: float, bodies: Iterable[str] | None) -> tuple[Array, Array]:
    """South-west corner of the grid of a scene [m], [2], and the greatest height over each cell [m], [Y, X]."""
    room = spec.room
    border = room.beyond if room.open_air else radius + 2 * cell
    low = np.floor(-border / cell + 1e-6) * np.ones(2)
    high = np.ceil((np.asarray(room.size) + border) / cell - 1e-6)
    x, y = ((np.arange(a, b) + 0.5) * cell for a, b in zip(low, high, strict=True))
    x, y = x[None, :], y[:, None]
    height = np.zeros((y.size, x.size))
    if not room.open_air:
        inside = (x > 0.0) & (x < room.size[0]) & (y > 0.0) & (y < room.size[1])
        height = np.where(inside, 0.0, room.height)
    for box in (*partitions(room), *_standing(spec, bodies)):
        if box.low < OVERHEAD_HEIGHT:
            height = np.where(box.distance(x, y) < cell / 2, np.maximum(height, box.high), height)
    return low * cell, height


def _standing(spec: SceneSpec, bodies: Iterable[str] | None) -> list[Box]:
    """The boxes of all fixtures, and of the bodies that stand in the way."""
    fixtures, loose = boxes_of(spec)
    targets = {target.name for target in spec.targets}
    names = [body.name for body in spec.bodies]
    wanted = [name for name in names if name not in targets] if bodies is None else list(bodies)
    for name in wanted:
        if name not in names:
            raise ValueError(f"bodies must be names of bodies in the scene, got {name!r}")
    return [*fixtures, *(box for name, box in zip(names, loose, strict=True) if name in wanted)]
