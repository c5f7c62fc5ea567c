"""Puts objects onto the floor and the furniture of a room, each within a robot's reach, and chooses which of them are targets."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from hazard_ms.assets import asset
from hazard_ms.catalogue import CATEGORIES, HIGH_VALUE
from hazard_ms.scenes import boxes
from hazard_ms.scenes.arrangement import GAP, RESTING, Arrangement, NoPlaceError, models_of
from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.draw import Draw
from hazard_ms.scenes.floor import FLAT, Grid, away_from, cell_of, distance_to, doorways, free_for, largest, partitions, take
from hazard_ms.scenes.layout import Layout
from hazard_ms.scenes.surfaces import Surface, surfaces_of
from hazard_ms.spec import Body, Vec3

ROBOT = 0.3  # radius of the disc that must get everywhere [m]: Fetch's base has 0.28
REACH = 0.75  # from a place where the robot can stand to a thing, horizontally [m]
LOWEST, HIGHEST = 0.3, 1.0  # shelves below and surfaces above are left empty [m]
TALLEST = 1.1  # the top of nothing that stands on furniture is above this plus half its height [m]
MARGIN = 0.02  # to the edge of a surface [m]
LOW = 0.1  # what stands lower is in the robot's way: on the floor or on a rug [m]
TARGET_CATEGORIES = 4  # HAZARD, table 1
BULKY = 0.30  # things longer or taller than this mostly stand on the floor [m] [ours]
ON_FLOOR = {False: 0.2, True: 0.8}  # share that stands on the floor, of small and of bulky things [ours]
ASIDE = 0.6  # most things on the floor stand no farther than this from wall or furniture [m] [ours]
IN_THE_OPEN = 0.25  # share of things on the floor that may stand anywhere [ours]
TRIES = 40  # draws for one thing
WHOLE = 0.97  # share of the robot's free floor that must be one piece


class Kind(Protocol):
    """What a layout, indoors or in the open, says about the ways in it."""

    @property
    def name(self) -> str:
        """Of the kind of scene."""

    @property
    def aisle(self) -> float:
        """Width of the passages [m]."""


class Scatter:
    """The objects of a furnished room so far, and the floor that they leave free to the robot."""

    def __init__(self, made: Arrangement, kind: Kind, hollow: tuple[str, ...] = (), in_the_open: float = IN_THE_OPEN) -> None:
        """Nothing placed yet; nothing is put into furniture of the categories `hollow`, shopping carts say.

        `in_the_open`: share of things on the floor that may stand anywhere. Raises NoPlaceError where the floor falls apart or
        passages are too narrow.
        """
        self.made, self.draw, self.size, self.in_the_open = made, made.draw, made.room.size, in_the_open
        self.bodies: list[Body] = []
        self.boxes: list[Box] = []  # of the bodies
        for radius in (kind.aisle / 2, ROBOT):
            free = free_for(made.room, made.boxes, [], radius)
            whole = largest(free)
            if whole.sum() < WHOLE * max(free.sum(), 1) or not whole.any():
                raise NoPlaceError(f"the floor of {kind.name} falls apart for a disc of {radius} m")
        self.free: Grid = whole  # where the robot can stand and get to
        self._way_off = away_from(self.free, made.room)  # of every cell from there [m]
        self._openness = distance_to(~free_for(made.room, made.boxes, [], GAP))
        walls = [*partitions(made.room), *doorways(made.room)]
        self._rows = boxes.rows([*made.boxes, *walls])  # of fixtures, of what divides the room, then of bodies
        usable = [(k, f, b) for k, (f, b) in enumerate(zip(made.fixtures, made.boxes, strict=True)) if f.category not in hollow]
        found = [(k, s) for k, f, b in usable for s in surfaces_of(f.name, asset(f.asset), f.scale, b)]
        self._surfaces = [(k, s) for k, s in found if s.z <= FLAT or LOWEST <= s.z <= HIGHEST]

    def place(self, category: str, on_floor: bool) -> bool:
        """Put one more thing of a category on the floor or on furniture; where there is no place, on the other."""
        model = self.draw.one(models_of(category))
        extent = asset(model).extent
        name = f"{category}_{1 + sum(b.category == category for b in self.bodies)}"
        for attempt in range(TRIES):
            floor = on_floor == (attempt < TRIES // 2)
            owner, surface = (-1, None) if floor else self._surface(extent)
            if surface is None and not floor:
                continue
            yaw = self.draw.uniform(-math.pi, math.pi)
            x, y, z = self._floor_point() if surface is None else self._point_on(surface, extent)
            position = (round(x, 4), round(y, 4), round(z + RESTING, 4))
            body = Body(name, category, model, position, boxes.turned(yaw))
            if self._add(body, boxes.box_of(body, extent), owner, surface):
                return True
        return False

    def _floor_point(self) -> Vec3:
        w, d = self.size
        for _ in range(TRIES):
            x, y = self.draw.uniform(0.0, w), self.draw.uniform(0.0, d)
            if self.draw.uniform() < self.in_the_open or min(self._openness[cell_of((x, y))], x, y, w - x, d - y) < ASIDE:
                break
        return x, y, 0.0

    def _surface(self, extent: Vec3) -> tuple[int, Surface | None]:
        """A surface that can hold a thing, larger ones more often, and the number of the fixture that has it."""
        need = min(extent[:2]) / 2 + MARGIN
        able = [
            (k, s) for k, s in self._surfaces if min(s.half) >= need and s.headroom >= extent[2] + GAP and s.z + extent[2] / 2 <= TALLEST
        ]
        return self.draw.weighted(able, [math.sqrt(s.half[0] * s.half[1]) for _, s in able]) if able else (-1, None)

    def _point_on(self, surface: Surface, extent: Vec3) -> Vec3:
        """Somewhere on the surface, not so near its edge that the thing could not stand."""
        need = min(extent[:2]) / 2 + MARGIN
        spare = [max(h - need, 0.0) for h in surface.half]
        x, y = surface.point(self.draw.uniform(-spare[0], spare[0]), self.draw.uniform(-spare[1], spare[1]))
        return x, y, surface.z

    def _add(self, body: Body, box: Box, owner: int, surface: Surface | None) -> bool:
        """Keep the thing if it touches nothing, stands firmly, can be reached and leaves the robot its ways."""
        others = self._rows if owner < 0 else np.delete(self._rows, owner, axis=0)
        w, d = self.size
        within = all(GAP <= x <= w - GAP and GAP <= y <= d - GAP for x, y in box.corners())
        firm = surface is None or surface.holds(box, MARGIN)
        if not (within and firm and boxes.free_of(box, others, GAP)):
            return False
        free, way_off = self.free, self._way_off
        if box.low < LOW:
            left = take(free, self.size, [box], ROBOT)
            free = largest(left)
            if free.sum() < WHOLE * left.sum():
                return False
            way_off = away_from(free, self.made.room)
        if any(way_off[cell_of((b.x, b.y))] > REACH for b in (box, *self.boxes)):
            return False
        self.free, self._way_off = free, way_off
        self.bodies.append(body)
        self.boxes.append(box)
        self._rows = np.concatenate([self._rows, boxes.rows([box])])
        return True


def fill(scatter: Scatter, layout: Layout) -> tuple[str, ...]:
    """Place all objects of a room, those for the floor and the bulky ones first; returns the categories of the targets."""
    draw = scatter.draw
    wanted, chosen = wanted_things(layout, draw)
    length = {c: _length(c) for c in dict.fromkeys(wanted)}
    things = [(c, draw.uniform() < ON_FLOOR[length[c] > BULKY]) for c in wanted]
    for category, on_floor in sorted(things, key=lambda t: (not t[1], -length[t[0]], t[0])):
        if not scatter.place(category, on_floor):
            raise NoPlaceError(f"a {category} finds no place in {layout.name}")
    return chosen


def wanted_things(layout: Layout, draw: Draw) -> tuple[list[str], tuple[str, ...]]:
    """Categories of the objects of a scene, one entry per object, and those of them that are targets."""
    pool = [c for c in layout.pool if models_of(c)]
    chosen, others = choose_targets(pool, draw)
    targets = list(chosen) + [draw.one(chosen) for _ in range(draw.whole(*layout.targets) - len(chosen))]
    variety = draw.shuffled(others + [c for c in layout.things if models_of(c) and c not in pool])
    again = [c for c in variety if _length(c) <= BULKY]  # one of each bulky kind is enough
    more = layout.bodies - len(targets)
    return targets + (variety + again * (1 + more // len(again)))[:more], chosen


def choose_targets(pool: list[str], draw: Draw) -> tuple[tuple[str, ...], list[str]]:
    """Four categories to be rescued, and the others. Both values are among the four, and things that burn and that do not."""
    kinds = [CATEGORIES[c] for c in pool]
    if len(pool) <= TARGET_CATEGORIES or len({k.value for k in kinds}) < 2 or len({k.flammable for k in kinds}) < 2:
        raise ValueError(f"the pool {pool} has no four categories of both values, flammable and not, and others beside them")
    while True:
        pile = draw.shuffled(pool)
        four = [CATEGORIES[c] for c in pile[:TARGET_CATEGORIES]]
        if len({k.value == HIGH_VALUE for k in four}) == 2 and len({k.flammable for k in four}) == 2:
            return tuple(sorted(pile[:TARGET_CATEGORIES])), pile[TARGET_CATEGORIES:]


def _length(category: str) -> float:
    """The longest edge of any model of a category [m]."""
    return max(max(asset(m).extent) for m in models_of(category))
