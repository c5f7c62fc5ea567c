"""Surroundings for the original's outdoor scenes: houses and trees of ours around a square, in place of its suburb.

The square holds all positions of a region; nothing of ours stands in it, so nothing touches an object, a cart or the
agent.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence

from hazard_ms.scenes import boxes
from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.generate.arrangement import YAW_AT_WALL, models_of
from hazard_ms.scenes.generate.draw import Draw
from hazard_ms.scenes.generate.regions import BEYOND, SKY
from hazard_ms.scenes.original.axes import SouthWestCorner
from hazard_ms.scenes.walls import WALLS
from hazard_ms.spec import Fixture, Patch, Room, Vec2, Vec3

# x, z of regions whose things lie within 8.5 m [m]
MIDDLES = {0: (0.0, 0.0), 1: (55.0, 0.0), 2: (-58.0, -9.0), 4: (-61.0, 55.0)}
HALF_EDGE = 9.0  # half edge of the square [m]: the 8.5 m, and half a large thing
# from the square to what surrounds it [m] [ours]: room for the longest cart, whose middle may lie on the rim
CLEARANCE = 1.5
PAVEMENT_WIDTH, ROAD_WIDTH = 1.5, 6.0  # widths [m] [ours]


def place_of(name: str, positions: Sequence[Vec3], ground: float) -> tuple[Room, SouthWestCorner]:
    """The open place of a scene, and its corner in the original's frame.

    `positions`: of all things and the agent [m]; `ground`: its height [m].
    """
    region = region_of(name)
    low, high = ([pick(p[k] for p in positions) for k in (0, 2)] for pick in (min, max))
    middle = MIDDLES.get(region, (0.0, 0.0))
    if max(abs(e[k] - middle[k]) for e in (low, high) for k in (0, 1)) > HALF_EDGE:  # a region that is not published
        middle = (float(round((low[0] + high[0]) / 2)), float(round((low[1] + high[1]) / 2)))
    half = math.ceil(max(HALF_EDGE, *(abs(e[k] - middle[k]) + 0.5 for e in (low, high) for k in (0, 1))))
    room = Room(
        (2.0 * half, 2.0 * half), SKY, "grass", patches=tuple(_ground(2.0 * half, region)), open_air=True, beyond=BEYOND
    )
    return room, SouthWestCorner(middle[0] - half, ground, middle[1] - half)


def region_of(name: str) -> int:
    """The number of the region in a scene's name: "suburb_scene_2023-4-17" is of region 4; 0 if there is none."""
    found = re.search(r"-(\d{1,3})-\d+$", name)
    return int(found[1]) if found else 0


def _ground(edge: float, region: int) -> Iterator[Patch]:
    """A road with pavements through the square, from west to east or from south to north."""
    far, middle = BEYOND + 40.0, edge / 2
    for material, half in (("pavement", ROAD_WIDTH / 2 + PAVEMENT_WIDTH), ("asphalt", ROAD_WIDTH / 2)):
        low, high = (-far, middle - half), (edge + far, middle + half)
        yield Patch(material, low, high) if region % 2 == 0 else Patch(material, low[::-1], high[::-1])


def street(name: str, room: Room) -> tuple[Fixture, ...]:
    """Houses, hedges and trees around the square, the same in all scenes of a region; only those that have models."""
    draw = Draw("original", str(region_of(name)))
    made: list[Fixture] = []
    along = ("east", "west") if region_of(name) % 2 == 0 else ("south", "north")  # sides through which the road leaves
    for side in WALLS:
        crossed = side in along
        categories, gap = (("street_lamp", "tree"), 6.0) if crossed else (("house",), 0.8)
        made += _row(side, categories, gap, room.size[0], draw, len(made), crossed)
    return tuple(made)


def _row(
    side: str, categories: tuple[str, ...], gap: float, edge: float, draw: Draw, count: int, road: bool
) -> Iterator[Fixture]:
    """Pieces side by side along a side of the square; where the `road` leaves it stays free."""
    known = [c for c in categories if models_of(c)]
    at = -CLEARANCE
    while known and at < edge + CLEARANCE:
        category = draw.one(known)
        model = draw.one(models_of(category))
        width, depth, _ = asset(model).extent
        middle, at = at + width / 2, at + width + gap
        if road and abs(middle - edge / 2) < ROAD_WIDTH / 2 + PAVEMENT_WIDTH + width / 2:
            continue
        count += 1
        x, y = _beside(side, middle, CLEARANCE + depth / 2, edge)
        yield Fixture(
            f"{category}_{count}",
            category,
            model,
            (round(x, 4), round(y, 4), 0.0),
            boxes.turned(math.radians(YAW_AT_WALL[side])),
        )


def _beside(side: str, along: float, away: float, edge: float) -> Vec2:
    return {
        "south": (along, -away),
        "north": (along, edge + away),
        "west": (-away, along),
        "east": (edge + away, along),
    }[side]
