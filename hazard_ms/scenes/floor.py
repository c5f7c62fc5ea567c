"""The true free floor of a scene: the cells where a disc fits between furniture, walls and objects.

Generators, tests and the oracle use it; agents see only their own maps.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.boxes import Array, Box, box_of
from hazard_ms.scenes.shell import LEAF, leaf, shell
from hazard_ms.scenes.walls import WALLS, angle, hinge, on_wall, runs_along_x, thickness_of
from hazard_ms.spec import Opening, Room, SceneSpec, Vec2

FLOOR_CELL = 0.05  # edge of a cell [m]; cell (i, j) is centred on ((i + 0.5) FLOOR_CELL, (j + 0.5) FLOOR_CELL)
RUG_HEIGHT = 0.03  # fixtures lower than this are driven over: rugs [m] [ours]
OVERHEAD_HEIGHT = 1.3  # what begins above this hangs over a robot: Fetch's head is at 1.1 m [ours]
THRESHOLD_DEPTH = 0.8  # on each side of the middle of a doorway's wall [m] [ours]

Grid = NDArray[np.bool_]


def cells(size: Vec2) -> tuple[Array, Array]:
    """Centres of the cells of a room [m]: x as a column, [X, 1], y as a row, [1, Y]."""
    nx, ny = (math.floor(s / FLOOR_CELL + 1e-6) for s in size)
    return np.linspace(0.5, nx - 0.5, nx)[:, None] * FLOOR_CELL, np.linspace(0.5, ny - 0.5, ny)[None, :] * FLOOR_CELL


def cell_of(point: Vec2) -> tuple[int, int]:
    """The index along x and y of the cell that holds `point` [m]."""
    return math.floor(point[0] / FLOOR_CELL), math.floor(point[1] / FLOOR_CELL)


def centre_of(cell: tuple[int, int]) -> Vec2:
    """The middle of a cell [m]."""
    return round((cell[0] + 0.5) * FLOOR_CELL, 4), round((cell[1] + 0.5) * FLOOR_CELL, 4)


def within_walls(size: Vec2, radius: float) -> Grid:
    """Cells at which a disc of `radius` [m] keeps within the walls, [X, Y]."""
    x, y = cells(size)
    return (x >= radius) & (x <= size[0] - radius) & (y >= radius) & (y <= size[1] - radius)


def take(free: Grid, size: Vec2, boxes: Iterable[Box], radius: float) -> Grid:
    """The cells of `free`, [X, Y], at which a disc of `radius` [m] touches none of the boxes, [X, Y]."""
    x, y = cells(size)
    free = free.copy()
    for box in boxes:
        far = math.hypot(box.half_x, box.half_y) + radius + FLOOR_CELL
        i0, j0 = (max(0, c) for c in cell_of((box.x - far, box.y - far)))
        i1, j1 = (max(0, c + 1) for c in cell_of((box.x + far, box.y + far)))
        free[i0:i1, j0:j1] &= box.distance(x[i0:i1], y[:, j0:j1]) >= radius
    return free


def partitions(room: Room) -> list[Box]:
    """The boxes of the walls inside a room: pieces beside and above doorways, and leaves as far as they are closed."""
    names = tuple(f"wall_{p.name}_" for p in room.partitions)
    pieces = [b for b in shell(room) if b.name.startswith(names)] if names else []
    pieces += [leaf(room, _shut(o)) for o in room.openings if o.wall not in WALLS and o.share < 1.0]
    return [
        Box(*b.centre[:2], b.size[0] / 2, b.size[1] / 2, 0.0, b.centre[2] - b.size[2] / 2, b.centre[2] + b.size[2] / 2)
        for b in pieces
    ]


def _shut(o: Opening) -> Opening:
    """The part of a door that is closed at frame 0: its lower end along the wall."""
    return dataclasses.replace(o, width=(1.0 - o.share) * o.width, centre=o.centre - o.share * o.width / 2)


def open_leaves(room: Room) -> list[Box]:
    """The boxes of leaves of doors in inner walls that stand open at frame 0, more or less, on their hinges."""
    made = []
    for o in room.openings:
        if o.wall in WALLS or o.kind != "door" or o.share == 0.0:
            continue
        (start, along, out), turn = hinge(room, o), angle(o.share)
        way = math.cos(turn) * along + math.sin(turn) * out
        x, y = (start + o.width / 2 * way).tolist()
        made.append(Box(x, y, o.width / 2, LEAF / 2, math.atan2(way[1], way[0]), o.sill, o.sill + o.height))
    return made


def touches(boxes: Iterable[Box], place: Vec2, radius: float) -> bool:
    """Whether a disc of `radius` [m] around `place` [m] touches the footprint of any of the `boxes`."""
    x, y = np.array(place)
    return any(float(box.distance(x, y)) < radius for box in boxes)


def doorways(room: Room) -> list[Box]:
    """The boxes of doorways and doors inside a room, thresholds included: nothing stands or burns in them."""
    spots = [
        (o, on_wall(room, o.wall, o.centre, 0.0, thickness_of(room, o.wall) / 2))
        for o in room.openings
        if o.wall not in WALLS
    ]
    sizes = [
        (o.width / 2, THRESHOLD_DEPTH) if runs_along_x(room, o.wall) else (THRESHOLD_DEPTH, o.width / 2)
        for o, _ in spots
    ]
    return [Box(x, y, *half, 0.0, 0.0, o.height) for (o, (x, y, _)), half in zip(spots, sizes, strict=True)]


def free_for(room: Room, fixtures: Iterable[Box], bodies: Iterable[Box], radius: float) -> Grid:
    """Cells at which a disc of `radius` [m] touches neither wall nor thing in a room, [X, Y]."""
    standing = [*partitions(room), *bodies, *(b for b in fixtures if b.high > RUG_HEIGHT)]
    return take(within_walls(room.size, radius), room.size, [b for b in standing if b.low < OVERHEAD_HEIGHT], radius)


def boxes_of(spec: SceneSpec) -> tuple[list[Box], list[Box]]:
    """The boxes of the fixtures and the boxes of the bodies of a scene."""
    fixtures = [box_of(f, asset(f.asset).extent) for f in spec.fixtures]
    return fixtures, [box_of(b, asset(b.asset).extent) for b in spec.bodies]


def free_floor(spec: SceneSpec, radius: float) -> Grid:
    """Cells at which a disc of `radius` [m] touches neither wall nor thing at the start of a scene, [X, Y]."""
    return free_for(spec.room, *boxes_of(spec), radius)


def largest(free: Grid) -> Grid:
    """The largest connected part of the mask `free`, [X, Y], over edges, not corners: [X, Y]."""
    label, count = ndimage.label(free)
    if count == 0:
        return free.copy()
    return label == 1 + int(np.argmax(np.bincount(label.ravel())[1:]))


def connected(free: Grid, start: Vec2) -> Grid:
    """The part of `free`, [X, Y], that is connected with the cell of `start` [m], [X, Y]; empty if that is not free."""
    i, j = cell_of(start)
    if not (0 <= i < free.shape[0] and 0 <= j < free.shape[1] and free[i, j]):
        return np.zeros_like(free)
    label, _ = ndimage.label(free)
    return label == label[i, j]


def distance_to(part: Grid) -> Array:
    """The distance of every cell's centre from the nearest cell of `part` [m], [X, Y]."""
    if not part.any():
        return np.full(part.shape, np.inf)
    return ndimage.distance_transform_edt(~part) * FLOOR_CELL


def halls(room: Room) -> list[tuple[slice, slice]]:
    """The parts into which partitions divide the grid of a room, as slices along x and y; one if there are none."""
    shape = within_walls(room.size, 0.0).shape
    ends = [
        sorted([0, n, *(cell_of((p.at, p.at))[0] for p in room.partitions if p.axis == axis)])
        for n, axis in zip(shape, "yx", strict=True)
    ]
    xs, ys = ([slice(a, b) for a, b in itertools.pairwise(e)] for e in ends)
    return [(x, y) for x in xs for y in ys]


def away_from(part: Grid, room: Room) -> Array:
    """The distance of every cell's centre from the nearest cell of `part` in the same hall [m], [X, Y]."""
    found = np.full(part.shape, np.inf)
    for hall in halls(room):
        found[hall] = distance_to(part[hall])
    return found


def steps_from(free: Grid, start: tuple[int, int]) -> NDArray[np.int64]:
    """The number of steps to every cell from the cell `start`, [X, Y]; -1 for cells that cannot be reached.

    Odd steps go over edges only, even ones over corners too, so that a path is about as long in all directions.
    """
    steps = np.full(free.shape, -1)
    reached = np.zeros_like(free)
    reached[start] = True
    for n in range(free.size):
        new = reached & (steps < 0)
        if not new.any():
            break
        steps[new] = n
        grown = new.copy()
        grown[1:] |= new[:-1]
        grown[:-1] |= new[1:]
        across = grown if n % 2 else new  # of what has grown along x already: that adds the corners
        wider = grown.copy()
        wider[:, 1:] |= across[:, :-1]
        wider[:, :-1] |= across[:, 1:]
        reached |= wider & free
    return steps


def path(steps: NDArray[np.int64], end: tuple[int, int]) -> list[tuple[int, int]]:
    """The cells of a shortest path from `end` back to the start of `steps`, [X, Y], as `steps_from` counts them."""
    cells_of_path = [end]
    while steps[cells_of_path[-1]] > 0:
        i, j = cells_of_path[-1]
        around = [
            (i + a, j + b)
            for a in (-1, 0, 1)
            for b in (-1, 0, 1)
            if 0 <= i + a < steps.shape[0] and 0 <= j + b < steps.shape[1]
        ]
        nearer = [c for c in around if 0 <= steps[c] < steps[i, j]]
        if not nearer:
            break
        cells_of_path.append(min(nearer, key=lambda c: steps[c]))
    return cells_of_path
