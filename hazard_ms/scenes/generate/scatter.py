"""Puts objects on the floor and the furniture of a room, within a robot's reach, and chooses the targets among them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from hazard_ms.scenes import boxes
from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.floor import (
    RUG_HEIGHT,
    Grid,
    away_from,
    cell_of,
    distance_to,
    doorways,
    free_for,
    largest,
    partitions,
    take,
)
from hazard_ms.scenes.generate.arrangement import MIN_GAP, RESTING_HEIGHT, Arrangement, NoPlaceError, models_of
from hazard_ms.scenes.generate.draw import Draw
from hazard_ms.scenes.generate.layout import Layout
from hazard_ms.scenes.generate.room_things import stands_on
from hazard_ms.scenes.generate.support_surfaces import Surface, surfaces_of
from hazard_ms.spec import Body, Vec3
from hazard_ms.spec.catalogue import CATEGORIES, HIGH_VALUE

ROBOT_RADIUS = 0.3  # radius of the disc that must get everywhere [m]: Fetch's base has 0.28
REACH_DISTANCE = 0.75  # from a place where the robot can stand to a thing, horizontally [m]
LOWEST_SURFACE, HIGHEST_SURFACE = 0.3, 1.0  # shelves below and surfaces above are left empty [m]
MAX_TOP_HEIGHT = 1.1  # the top of nothing that stands on furniture is above this plus half its height [m]
EDGE_MARGIN = 0.02  # to the edge of a surface [m]
OBSTACLE_HEIGHT = 0.1  # what stands lower is in the robot's way: on the floor or on a rug [m]
TARGET_KINDS = 4  # HAZARD, table 1
BULKY_LENGTH = 0.30  # things longer or taller than this mostly stand on the floor [m] [ours]
ON_FLOOR = {False: 0.2, True: 0.8}  # share that stands on the floor, of small and of bulky things [ours]
MAX_OPENNESS = 0.6  # most things on the floor stand no farther than this from wall or furniture [m] [ours]
IN_THE_OPEN = 0.25  # share of things on the floor that may stand anywhere [ours]
TRIES = 40  # draws for one thing
CONNECTED_SHARE = 0.97  # share of the robot's free floor that must be one piece


class Kind(Protocol):
    """A kind of place, indoors or in the open, as far as paths in it are concerned."""

    @property
    def name(self) -> str:
        """The name of the kind of place."""

    @property
    def aisle(self) -> float:
        """The width of its passages [m]."""


class Scatter:
    """The objects of a furnished room so far, and the floor that they leave free for the robot."""

    def __init__(
        self,
        made: Arrangement,
        kind: Kind,
        hollow: tuple[str, ...] = (),
        in_the_open: float = IN_THE_OPEN,
        anywhere: bool = True,
    ) -> None:
        """Begin with no objects; none will be put into furniture of the categories `hollow`.

        `in_the_open`: share of things on the floor that may stand anywhere; `anywhere`: things may stand on furniture
        that is not meant for them. Raises NoPlaceError if the floor is not
        connected or passages are too narrow.
        """
        self.made, self.draw, self.size, self.in_the_open = made, made.draw, made.room.size, in_the_open
        self._anywhere = anywhere
        self.bodies: list[Body] = []
        self.boxes: list[Box] = []  # of the bodies
        for radius in (kind.aisle / 2, ROBOT_RADIUS):
            free = free_for(made.room, made.boxes, [], radius)
            whole = largest(free)
            if whole.sum() < CONNECTED_SHARE * max(free.sum(), 1) or not whole.any():
                raise NoPlaceError(f"the floor of {kind.name} must be connected for a disc of {radius} m, got parts")
        self.free: Grid = whole  # where the robot can stand and get to
        self._path_distance = away_from(self.free, made.room)  # of every cell from there [m]
        self._openness = distance_to(~free_for(made.room, made.boxes, [], MIN_GAP))
        walls = [*partitions(made.room), *doorways(made.room)]
        self._rows = boxes.rows([*made.boxes, *walls])  # of fixtures, of what divides the room, then of bodies
        usable = [
            (k, f, b)
            for k, (f, b) in enumerate(zip(made.fixtures, made.boxes, strict=True))
            if f.category not in hollow
        ]
        found = [(k, s) for k, f, b in usable for s in surfaces_of(f.name, asset(f.asset), f.scale, b)]
        self._surfaces = [(k, s) for k, s in found if s.z <= RUG_HEIGHT or LOWEST_SURFACE <= s.z <= HIGHEST_SURFACE]

    def place(self, category: str, on_floor: bool) -> bool:
        """Put one more thing of a category on the floor or on furniture; where there is no place, on the other."""
        model = self.draw.one(models_of(category))
        extent = asset(model).extent
        name = f"{category}_{1 + sum(b.category == category for b in self.bodies)}"
        for attempt in range(TRIES):
            floor = on_floor == (attempt < TRIES // 2)
            owner, surface = (-1, None) if floor else self._surface(category, extent)
            if surface is None and not floor:
                continue
            yaw = self.draw.uniform(-math.pi, math.pi)
            x, y, z = self._floor_point(self.draw) if surface is None else self._point_on(surface, extent)
            position = (round(x, 4), round(y, 4), round(z + RESTING_HEIGHT, 4))
            body = Body(name, category, model, position, boxes.turned(yaw))
            if self.add(body, boxes.box_of(body, extent), owner, surface):
                return True
        return False

    def put_down(self, category: str, clear: Sequence[tuple[tuple[float, ...], float]], draw: Draw) -> None:
        """Put what is of a category and stands on furniture on the floor, outside the circles `clear`.

        A circle: its middle [m], of which x and y count, and its radius [m]. Raises NoPlaceError if there is no place.
        """
        first = len(self._rows) - len(self.bodies)
        for k in [k for k, b in enumerate(self.bodies) if b.category == category and b.position[2] > OBSTACLE_HEIGHT]:
            body, extent = self.bodies[k], asset(self.bodies[k].asset).extent
            kept = self.bodies[:], self.boxes[:], self._rows
            del self.bodies[k], self.boxes[k]
            self._rows = np.delete(self._rows, first + k, axis=0)
            for _ in range(10 * TRIES):
                x, y, z = self._floor_point(draw)
                position = (round(x, 4), round(y, 4), round(z + RESTING_HEIGHT, 4))
                there = replace(body, position=position, rotation=boxes.turned(draw.uniform(-math.pi, math.pi)))
                box = boxes.box_of(there, extent)
                near = any(float(box.distance(*np.array(middle[:2]))) < radius for middle, radius in clear)
                if not near and self.add(there, box, -1, None):
                    break
            else:
                self.bodies, self.boxes, self._rows = kept
                raise NoPlaceError(f"a {category} must have a place on the floor, got none")

    def _floor_point(self, draw: Draw) -> Vec3:
        w, d = self.size
        for _ in range(TRIES):
            x, y = draw.uniform(0.0, w), draw.uniform(0.0, d)
            if (
                draw.uniform() < self.in_the_open
                or min(self._openness[cell_of((x, y))], x, y, w - x, d - y) < MAX_OPENNESS
            ):
                break
        return x, y, 0.0

    def _surface(self, category: str, extent: Vec3) -> tuple[int, Surface | None]:
        """A surface that can hold a thing, larger ones more often, and the number of the fixture that has it."""
        need = min(extent[:2]) / 2 + EDGE_MARGIN
        able = [
            (k, s)
            for k, s in self._surfaces
            if min(s.half) >= need
            and s.headroom >= extent[2] + MIN_GAP
            and s.z + extent[2] / 2 <= MAX_TOP_HEIGHT
            and (self._anywhere or stands_on(category, self.made.fixtures[k].category))
        ]
        return self.draw.weighted(able, [math.sqrt(s.half[0] * s.half[1]) for _, s in able]) if able else (-1, None)

    def _point_on(self, surface: Surface, extent: Vec3) -> Vec3:
        """Somewhere on the surface, not so near its edge that the thing could not stand."""
        need = min(extent[:2]) / 2 + EDGE_MARGIN
        spare = [max(h - need, 0.0) for h in surface.half]
        x, y = surface.point(self.draw.uniform(-spare[0], spare[0]), self.draw.uniform(-spare[1], spare[1]))
        return x, y, surface.z

    def add(self, body: Body, box: Box, owner: int, surface: Surface | None) -> bool:
        """Keep the thing if it touches nothing, stands firmly, can be reached and leaves the robot its ways."""
        others = self._rows if owner < 0 else np.delete(self._rows, owner, axis=0)
        w, d = self.size
        within = all(MIN_GAP <= x <= w - MIN_GAP and MIN_GAP <= y <= d - MIN_GAP for x, y in box.corners())
        firm = surface is None or surface.holds(box, EDGE_MARGIN)
        if not (within and firm and boxes.free_of(box, others, MIN_GAP)):
            return False
        free, path_distance = self.free, self._path_distance
        if box.low < OBSTACLE_HEIGHT:
            left = take(free, self.size, [box], ROBOT_RADIUS)
            free = largest(left)
            if free.sum() < CONNECTED_SHARE * left.sum():
                return False
            path_distance = away_from(free, self.made.room)
        if any(path_distance[cell_of((b.x, b.y))] > REACH_DISTANCE for b in (box, *self.boxes)):
            return False
        self.free, self._path_distance = free, path_distance
        self.bodies.append(body)
        self.boxes.append(box)
        self._rows = np.concatenate([self._rows, boxes.rows([box])])
        return True


def fill(scatter: Scatter, layout: Layout) -> tuple[str, ...]:
    """Place all objects of a room, those for the floor and the bulky ones first; return the categories of the targets.

    Raises NoPlaceError if an object finds no place.
    """
    draw = scatter.draw
    wanted, chosen = wanted_things(layout, draw)
    length = {c: _length(c) for c in dict.fromkeys(wanted)}
    things = [(c, draw.uniform() < ON_FLOOR[length[c] > BULKY_LENGTH]) for c in wanted]
    for category, on_floor in sorted(things, key=lambda t: (not t[1], -length[t[0]], t[0])):
        if not scatter.place(category, on_floor):
            raise NoPlaceError(f"a {category} must have a place in {layout.name}, got none")
    return chosen


def wanted_things(layout: Layout, draw: Draw) -> tuple[list[str], tuple[str, ...]]:
    """The categories of the objects of a scene, one entry per object, and the categories that are targets."""
    pool = [c for c in layout.pool if models_of(c)]
    chosen, others = choose_targets(pool, draw, layout.burning_kinds)
    targets = list(chosen) + [draw.one(chosen) for _ in range(draw.whole(*layout.targets) - len(chosen))]
    variety = draw.shuffled(others + [c for c in layout.things if models_of(c) and c not in pool])
    again = [c for c in variety if _length(c) <= BULKY_LENGTH]  # one of each bulky kind is enough
    more = layout.bodies - len(targets)
    return targets + (variety + again * (1 + more // len(again)))[:more], chosen


def choose_targets(pool: list[str], draw: Draw, burning: int = 1) -> tuple[tuple[str, ...], list[str]]:
    """Four categories to be rescued, and the others of the pool.

    Both values are among the four, and things that burn, `burning` categories of them at least, as well as things that
    do not. Raises ValueError for a pool that has no such four.
    """
    kinds = [CATEGORIES[c] for c in pool]
    able = burning <= sum(k.flammable for k in kinds) < len(kinds) and 1 <= burning < TARGET_KINDS
    if len(pool) <= TARGET_KINDS or len({k.value for k in kinds}) < 2 or not able:
        raise ValueError(
            f"pool must have more than {TARGET_KINDS} categories, of both values, {burning} flammable ones and others "
            f"that are not, got {pool}"
        )
    while True:
        pile = draw.shuffled(pool)
        four = [CATEGORIES[c] for c in pile[:TARGET_KINDS]]
        if len({k.value == HIGH_VALUE for k in four}) == 2 and burning <= sum(k.flammable for k in four) < TARGET_KINDS:
            return tuple(sorted(pile[:TARGET_KINDS])), pile[TARGET_KINDS:]


def _length(category: str) -> float:
    """The longest edge of any model of a category [m]."""
    return max(max(asset(m).extent) for m in models_of(category))
