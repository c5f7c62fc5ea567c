"""What stands in a room while it is being furnished: models, places, what must stay clear."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from hazard_ms.assets import asset, asset_ids
from hazard_ms.scenes import boxes
from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.draw import Draw
from hazard_ms.scenes.floor import FLAT
from hazard_ms.scenes.shell import on_wall
from hazard_ms.spec import Fixture, Opening, Room

GAP = 0.01  # between any two things [m]
RESTING = 0.0005  # above what it stands on, so that the simulator starts without contact [m]
DOOR_SPACE = 0.9  # kept free before a door [m]
WINDOW_SPACE = 0.3  # nothing that hides a window within this of the wall [m]
FACING = {"south": 180.0, "east": -90.0, "north": 0.0, "west": 90.0}  # yaw with the back to that wall [degrees]


def models_of(category: str) -> tuple[str, ...]:
    """Ids of the models of a category, in an order that does not depend on the index."""
    return tuple(sorted(asset_ids(category=category)))


class NoPlaceError(Exception):
    """A piece that the room needs does not fit this time."""


@dataclass
class Arrangement:
    """What stands in the room so far."""

    room: Room
    draw: Draw
    fixtures: list[Fixture] = field(default_factory=list)
    boxes: list[Box] = field(default_factory=list)  # of the fixtures
    kept_clear: list[Box] = field(default_factory=list)

    def model(self, category: str) -> str | None:
        """One of the models of a category; None when there is none."""
        ids = models_of(category)
        return self.draw.one(ids) if ids else None

    def named(self, category: str) -> list[tuple[Fixture, Box]]:
        """The pieces of a category, with what they occupy."""
        return [(f, b) for f, b in zip(self.fixtures, self.boxes, strict=True) if f.category == category]

    def try_at(self, category: str, model: str, x: float, y: float, z: float, yaw: float, against: bool = True) -> bool:
        """Put a piece there if it fits. `against`: it must also not touch what stands (rugs do)."""
        number = 1 + sum(f.category == category for f in self.fixtures)
        position = (round(x, 4), round(y, 4), round(z, 4))
        piece = Fixture(f"{category}_{number}", category, model, position, boxes.turned(yaw))
        box = boxes.box_of(piece, asset(model).extent)
        if not self._inside(box) or (against and not self._fits(box)):
            return False
        self.fixtures.append(piece)
        self.boxes.append(box)
        return True

    def _inside(self, box: Box) -> bool:
        (w, d), edge = self.room.size, GAP
        corners = box.corners()
        return box.high <= self.room.height and all(edge <= x <= w - edge and edge <= y <= d - edge for x, y in corners)

    def _fits(self, box: Box) -> bool:
        solid = [b for b in self.boxes if b.high - b.low > FLAT]
        return boxes.free_of(box, boxes.rows(solid), GAP) and boxes.free_of(box, boxes.rows(self.kept_clear), 0.0)


def space_before(room: Room, o: Opening) -> Box:
    """What furniture keeps clear: the floor before a door, the wall around a window."""
    deep = DOOR_SPACE if o.kind == "door" else WINDOW_SPACE
    x, y, _ = on_wall(room, o.wall, o.centre, 0.0, -deep / 2)
    return Box(x, y, o.width / 2 + 0.05, deep / 2, math.radians(FACING[o.wall]), o.sill, o.sill + o.height)


def mirrored(made: Arrangement, sideways: bool, lengthways: bool) -> Arrangement:
    """The same room with left and right, or front and back, exchanged. Models keep their own handedness."""
    (w, d), room = made.room.size, made.room
    for wanted, ends, walls in ((sideways, ("east", "west"), "x"), (lengthways, ("north", "south"), "y")):
        if not wanted:
            continue
        swap = dict(zip(ends, reversed(ends), strict=True))
        length = w if walls == "x" else d
        openings = tuple(
            Opening(o.kind, swap[o.wall], o.centre, o.width, o.height, o.sill)
            if o.wall in swap
            else Opening(o.kind, o.wall, round(length - o.centre, 4), o.width, o.height, o.sill)
            for o in room.openings
        )
        room = Room(room.size, room.height, room.floor, room.wall, openings)
        made.fixtures = [_mirrored_piece(f, walls, length) for f in made.fixtures]
    made.boxes = [boxes.box_of(f, asset(f.asset).extent) for f in made.fixtures]
    return Arrangement(room, made.draw, made.fixtures, made.boxes, [space_before(room, o) for o in room.openings])


def _mirrored_piece(f: Fixture, axis: str, length: float) -> Fixture:
    x, y, z = f.position
    yaw = boxes.yaw_of(f.rotation)
    position = (round(length - x, 4), y, z) if axis == "x" else (x, round(length - y, 4), z)
    return Fixture(f.name, f.category, f.asset, position, boxes.turned(-yaw if axis == "x" else math.pi - yaw), f.scale)
