"""The floor of a scene as cells for shallow water: furniture, walls, and the openings that water comes in through.

Cells are CELL wide; X along x, Y along y, with a ring of closed cells around them: cell (i, j) has the number
(i + 1) (Y + 2) + j + 1. Furniture that stands on the floor is ground as high as its parts; what has legs is not, and
water flows under it. An opening lets water through up to its height; in place of what is closed of a door there is a
gap at the floor (.openings). Water comes in through the doors in the outer walls. A scene without any has an opening as
wide as a door in the middle of its `flood_side`; one that names a `second_flood_side` has openings in two walls.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.scenes.boxes import yaw_of
from hazard_ms.scenes.inlets import SIDES, inlets
from hazard_ms.scenes.solids import parts_of
from hazard_ms.simulation.openings import all_openings
from hazard_ms.spec import Room, SceneSpec, Vec2

CELL = 0.1  # side of a cell [m]
SHEET = 0.05  # height below which what lies on the floor (rugs) does not count [m] [ours]
GAP = 0.05  # height above the ground below which a part stands on it [m] [ours]
NARROW = 0.08  # width below which water flows round a part (legs) as if it were not there [m] [ours]
BESIDE = 5  # cells of floor from the jamb of a door to where the level of the room is read [ours]
BEYOND = 100.0  # height of what is not floor [m]

Grid = NDArray[np.float32]


def cells_at(places: NDArray[np.floating], size: tuple[int, int]) -> NDArray[np.int64]:
    """Numbers of the cells, [...], at `places` [m], [..., 2], on a grid of `size` cells; those of the ring outside."""
    at = np.floor(places / CELL).astype(np.int64) + 1
    i, j = (at[..., k].clip(0, size[k] + 1) for k in (0, 1))
    found: NDArray[np.int64] = i * (size[1] + 2) + j
    return found


class FloorPlan(NamedTuple):
    """One scene on a grid, by the names of the quantities of InundationState."""

    bed: Grid  # [N]
    open_x: Grid  # [N]
    open_y: Grid  # [N]
    ground_of: NDArray[np.int64]  # [N]
    door: list[int]
    door_side: list[int]
    door_height: list[float]
    inlet: list[int]
    inlet_side: list[int]
    inlet_beside: list[int]
    inlet_width: list[float]
    inlet_height: list[float]
    inlet_opening: list[int]  # number of its opening along O
    inlet_along: list[float]
    leaf: list[int]  # cells whose side towards the west or the south is in an inner door
    leaf_side: list[int]  # 0: towards the west, 1: towards the south
    leaf_opening: list[int]
    leaf_along: list[float]


class Crossing(NamedTuple):
    """Sides of cells in one opening, L of them."""

    cells: list[int]
    side: int
    opening: int  # number along O
    along: list[float]  # middles of the sides along the wall [m]


def size_of(rooms: Sequence[Room]) -> tuple[int, int]:
    """Cells along x and y that cover the largest of `rooms`."""
    return cells_over(tuple(room.size for room in rooms))


@lru_cache
def cells_over(sizes: tuple[Vec2, ...]) -> tuple[int, int]:
    """Cells along x and y that cover the largest of rooms of these `sizes` [m]; asked for several times a frame."""
    x, y = (math.ceil(max(lengths) / CELL - 1e-6) for lengths in zip(*sizes, strict=True))
    return x, y


def plan_of(spec: SceneSpec, size: tuple[int, int], edges: Mapping[str, Sequence[float]]) -> FloorPlan:
    """The floor of a scene on a grid of `size` (X, Y) cells; `edges` of its things [m], by name."""
    middles = tuple(CELL * (np.arange(n) + 0.5) for n in size)
    x, y = np.meshgrid(*middles, indexing="ij")
    room = spec.room
    floor = (x < room.size[0]) & (y < room.size[1])
    stands, things = _ground(spec, edges, x, y)
    ground = np.where(floor, stands, BEYOND)
    open_x, open_y = np.zeros((2, *size))
    open_x[1:], open_y[:, 1:] = BEYOND * (floor[1:] & floor[:-1]), BEYOND * (floor[:, 1:] & floor[:, :-1])
    index = np.arange((size[0] + 2) * (size[1] + 2)).reshape(size[0] + 2, size[1] + 2)[1:-1, 1:-1]
    door: list[int] = []
    door_sides: list[int] = []
    heights: list[float] = []
    for partition in room.partitions:
        doors = [o for o in room.openings if o.kind in ("doorway", "door") and o.wall == partition.name]
        across = 0 if partition.axis == "y" else 1
        along = middles[1 - across]
        height = np.zeros(len(along))
        for o in doors:
            height[np.abs(along - o.centre) < o.width / 2] = o.height
        beyond = int(np.searchsorted(middles[across], partition.at))  # the first cells behind it
        if across == 0:
            open_x[beyond] = np.minimum(open_x[beyond], height)
        else:
            open_y[:, beyond] = np.minimum(open_y[:, beyond], height)
        beside = index[beyond] if across == 0 else index[:, beyond]
        door += beside[height > 0].tolist()
        door_sides += [2 * across] * int((height > 0).sum())
        heights += height[height > 0].tolist()
    bed, west, south = (
        np.pad(grid, 1, constant_values=edge).astype(np.float32).ravel()
        for grid, edge in ((ground, BEYOND), (open_x, 0.0), (open_y, 0.0))
    )
    inlet, side, width, high, number, places = _inlets(spec, size)
    sides = leaf_sides(spec, size)
    crossing = [(c, d.side, d.opening, at) for d in sides for c, at in zip(d.cells, d.along, strict=True)]
    leaf = [list(column) for column in zip(*crossing, strict=True)] if crossing else [[]] * 4
    near = [_beside(c, k, set(inlet), size[1] + 2, bed, (west, south)) for c, k in zip(inlet, side, strict=True)]
    of = np.pad(things, 1, constant_values=-1).ravel()
    held = (of, door, door_sides, heights)
    return FloorPlan(bed, west, south, *held, inlet, side, near, width, high, number, places, *leaf)


def leaf_sides(spec: SceneSpec, size: tuple[int, int]) -> list[Crossing]:
    """The sides of cells in the inner doors of a scene on a grid of `size` (X, Y) cells."""
    found = []
    for partition in spec.room.partitions:
        across = 0 if partition.axis == "y" else 1
        middles = [CELL * (np.arange(n) + 0.5) for n in size]
        beyond = int(np.searchsorted(middles[across], partition.at))
        along = middles[1 - across]
        for number, o in enumerate(spec.room.openings):
            if o.wall == partition.name and o.kind == "door":
                places = np.nonzero(np.abs(along - o.centre) < o.width / 2)[0].tolist()
                cells = [(beyond, k) if across == 0 else (k, beyond) for k in places]
                numbers = [(i + 1) * (size[1] + 2) + j + 1 for i, j in cells]
                found.append(Crossing(numbers, across, number, along[places].tolist()))
    return found


def most_sides(specs: Sequence[SceneSpec]) -> int:
    """The largest number of sides of cells in inner doors of `specs`."""
    size = size_of([spec.room for spec in specs])
    return max(sum(len(found.cells) for found in leaf_sides(spec, size)) for spec in specs)


def most_doors(specs: Sequence[SceneSpec]) -> int:
    """An upper bound of the number of cells at inner doors of `specs`."""
    inner = [
        sum(
            math.ceil(o.width / CELL) + 1
            for o in spec.room.openings
            if o.wall in {p.name for p in spec.room.partitions}
        )
        for spec in specs
    ]
    return max(inner)


def most_inlets(specs: Sequence[SceneSpec]) -> int:
    """The largest number of cells at inlets of `specs`."""
    size = size_of([spec.room for spec in specs])
    return max(len(_inlets(spec, size)[0]) for spec in specs)


def _inlets(
    spec: SceneSpec, size: tuple[int, int]
) -> tuple[list[int], list[int], list[float], list[float], list[int], list[float]]:
    """Cells, sides, widths, heights [m], openings and places along the wall [m] of the inlets of a scene.

    The grid has `size` (X, Y) cells.
    """
    middles = [CELL * (np.arange(n) + 0.5) for n in size]
    cells: list[int] = []
    sides: list[int] = []
    widths: list[float] = []
    heights: list[float] = []
    numbers: list[int] = []
    places: list[float] = []
    known = all_openings(spec)
    for opening in inlets(spec):
        side = SIDES.index(opening.wall)
        across = side // 2  # the axis that water comes in along
        last = math.ceil(spec.room.size[across] / CELL - 1e-6) - 1
        along = np.nonzero(np.abs(middles[1 - across] - opening.centre) < opening.width / 2)[0]
        edge = 0 if side % 2 == 0 else last
        for k in along.tolist():
            i, j = (edge, k) if across == 0 else (k, edge)
            cells.append((i + 1) * (size[1] + 2) + j + 1)
            sides.append(side)
            widths.append(opening.width / len(along))
            heights.append(opening.height)
            numbers.append(known.index(opening))
            places.append(float(middles[1 - across][k]))
    return cells, sides, widths, heights, numbers, places


def _beside(cell: int, side: int, inlets: set[int], pitch: int, bed: Grid, open_to: tuple[Grid, Grid]) -> int:
    """The cell of floor along the wall from an inlet that its jet leaves free; the inlet's own if there is none."""
    across = 1 if side < 2 else 0  # the axis along the wall
    pace, found = (pitch, 1)[across], {}
    for sign in (-1, 1):
        at, beyond = cell, 0
        while open_to[across][at + pace * max(sign, 0)] > 0 and beyond < BESIDE:
            at += sign * pace
            beyond += at not in inlets
            if beyond and bed[at] == 0:
                found[sign] = (-beyond, abs(at - cell), at)
    return min(found.values())[2] if found else cell


def _ground(
    spec: SceneSpec, edges: Mapping[str, Sequence[float]], x: NDArray[np.float64], y: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Height of the floor, or of the furniture on it, at the places `x`, `y` [m], and the lowest thing there or -1."""
    ground, of = np.zeros_like(x), np.full(x.shape, -1)
    for number, thing in enumerate(spec.fixtures, len(spec.bodies)):
        yaw = yaw_of(thing.rotation)
        c, s = math.cos(yaw), math.sin(yaw)
        try:
            parts = sorted(parts_of(thing), key=lambda part: float(part[0][2] - part[1][2]))
        except ValueError:  # without a model it is a box
            half = np.array(edges[thing.name]) / 2
            parts = [(np.array(thing.position) + (0.0, 0.0, half[2]), half)]
        for (px, py, pz), (hx, hy, hz) in parts:
            if 2.0 * min(hx, hy) < NARROW or pz + hz < SHEET:
                continue
            dx, dy = x - px, y - py
            over = (np.abs(c * dx + s * dy) < hx) & (np.abs(c * dy - s * dx) < hy)
            stands = over & (pz - hz <= ground + GAP)
            of[stands & (ground == 0.0)] = number
            ground[stands] = np.maximum(ground[stands], pz + hz)
    return ground, of
