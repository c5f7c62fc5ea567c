"""A room while it is being furnished: its pieces, their models and places, and the floor that must stay clear."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field

from hazard_ms.scenes import boxes
from hazard_ms.scenes.assets.index import asset, asset_ids
from hazard_ms.scenes.assets.rows import Asset
from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.floor import RUG_HEIGHT
from hazard_ms.scenes.generate.draw import Draw
from hazard_ms.scenes.walls import on_wall, runs_along_x, thickness_of
from hazard_ms.spec import Fixture, Opening, Room

MIN_GAP = 0.01  # between any two things [m]
RESTING_HEIGHT = 0.0005  # above what it stands on, so that the simulator starts without contact [m]
DOOR_SPACE = 0.9  # kept free before a door [m]
WINDOW_SPACE = 0.3  # nothing that hides a window within this of the wall [m]
LONG, ROUND = 2.5, 0.03  # length over height, and difference of the other two edges over it, of what rolls [-] [ours]
YAW_AT_WALL = {"south": 180.0, "east": -90.0, "north": 0.0, "west": 90.0}  # yaw with the back to that wall [degrees]


@functools.lru_cache(maxsize=256)
def models_of(category: str) -> tuple[str, ...]:
    """Ids of the models of a category, in an order that does not depend on the index.

    Models that roll are left out if there are others.
    """
    ids = sorted(asset_ids(category=category))
    return tuple([i for i in ids if not rolls(asset(i))] or ids)


def rolls(model: Asset) -> bool:
    """Whether a model is long, round and lying, so that it would roll a little before it comes to rest."""
    x, y, z = model.extent
    return model.kind == "object" and max(x, y) > LONG * z and abs(min(x, y) - z) < ROUND * z


class NoPlaceError(Exception):
    """Raised when a piece that a room needs does not fit this time."""


@dataclass
class Arrangement:
    """A room and the furniture that stands in it so far."""

    room: Room
    draw: Draw
    fixtures: list[Fixture] = field(default_factory=list)
    boxes: list[Box] = field(default_factory=list)  # of the fixtures
    kept_clear: list[Box] = field(default_factory=list)

    def model(self, category: str) -> str | None:
        """One of the models of a category; None if there is none."""
        ids = models_of(category)
        return self.draw.one(ids) if ids else None

    def named(self, category: str) -> list[tuple[Fixture, Box]]:
        """The pieces of a category, each with the box that it occupies."""
        return [(f, b) for f, b in zip(self.fixtures, self.boxes, strict=True) if f.category == category]

    def try_at(self, category: str, model: str, x: float, y: float, z: float, yaw: float, against: bool = True) -> bool:
        """Put a piece at x, y, z [m], turned by `yaw` [rad], if it fits; `against`: it may touch no other piece."""
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
        (w, d), edge = self.room.size, MIN_GAP
        corners = box.corners()
        return box.high <= self.room.height and all(edge <= x <= w - edge and edge <= y <= d - edge for x, y in corners)

    def _fits(self, box: Box) -> bool:
        solid = [b for b in self.boxes if b.high - b.low > RUG_HEIGHT]
        return boxes.free_of(box, boxes.rows(solid), MIN_GAP) and boxes.free_of(box, boxes.rows(self.kept_clear), 0.0)


def space_before(room: Room, o: Opening) -> Box:
    """The space that furniture keeps clear: before a door, on both sides of a doorway, or around a window."""
    deep = WINDOW_SPACE if o.kind == "window" else DOOR_SPACE
    facing = YAW_AT_WALL.get(o.wall, 0.0 if runs_along_x(room, o.wall) else 90.0)
    behind = 0.0 if o.wall in YAW_AT_WALL else deep + thickness_of(room, o.wall)  # the other side of a partition
    x, y, _ = on_wall(room, o.wall, o.centre, 0.0, (behind - deep) / 2)
    return Box(x, y, o.width / 2 + 0.05, (deep + behind) / 2, math.radians(facing), o.sill, o.sill + o.height)
