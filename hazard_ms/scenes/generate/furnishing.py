"""Furnishes rooms and flats: part by part, joined by doorways, and mirrored by chance."""

from __future__ import annotations

import math
from dataclasses import replace

from hazard_ms.scenes import boxes
from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.generate.arrangement import Arrangement, NoPlaceError, space_before
from hazard_ms.scenes.generate.draw import Draw
from hazard_ms.scenes.generate.layout import Layout, RoomPart
from hazard_ms.scenes.generate.placement import place
from hazard_ms.scenes.walls import runs_along_x, wall_length
from hazard_ms.spec import Area, Fixture, Opening, Partition, Room

DOORWAY_SIZE = (
    1.2,
    2.05,
)  # width and height of the openings between parts [m]: Fetch with its arm tucked is 0.58 m wide
PARTITION_THICKNESS = 0.1  # of the walls between parts: whole cells of the floor [m]
OPPOSITE = {"east": "west", "west": "east", "north": "south", "south": "north"}


def furnish(layout: Layout, draw: Draw) -> Arrangement:
    """A furnished room or flat. Raises NoPlaceError if a piece that it needs does not fit."""
    depth = round(draw.uniform(*layout.depth), 1)
    floor, wall = draw.one(layout.floors), draw.one(layout.walls)
    doorways = [round(draw.uniform(*layout.doorway) * depth, 2) for _ in layout.parts[1:]]
    made = []
    for k, part in enumerate(layout.parts):
        bare = Room((round(draw.uniform(*part.width), 1), depth), layout.height, floor, wall)
        ways = [("west", at) for at in doorways[k - 1 : k] if k] + [("east", at) for at in doorways[k : k + 1]]
        openings = (*holes(part, bare, draw), *(Opening("doorway", side, at, *DOORWAY_SIZE) for side, at in ways))
        made.append(_furnished(layout, part, replace(bare, openings=openings), draw))
    whole = _joined(made, draw)
    return mirrored(whole, draw.whole(0, 1) == 1, draw.whole(0, 1) == 1) if layout.mirror else whole


def holes(part: RoomPart, room: Room, draw: Draw) -> tuple[Opening, ...]:
    """The windows and doors of a part in the outer walls of its own room, as drawn."""
    centres = [round(draw.uniform(*h.reach) * wall_length(room, h.wall), 2) for h in part.holes]
    return tuple(
        Opening(h.kind, h.wall, at, h.width, h.height, h.sill) for h, at in zip(part.holes, centres, strict=True)
    )


def _furnished(layout: Layout, part: RoomPart, room: Room, draw: Draw) -> Arrangement:
    made = Arrangement(room, draw, kept_clear=[space_before(room, o) for o in room.openings])
    for rule in part.rules:
        if not place(rule, made) and not rule.optional:
            raise NoPlaceError(f"{rule} finds no place in {layout.name}")
    return made


def _joined(parts: list[Arrangement], draw: Draw) -> Arrangement:
    """Parts side by side as one room; pieces get numbers of their own again."""
    first = parts[0].room
    openings: list[Opening] = []
    partitions: list[Partition] = []
    fixtures: list[Fixture] = []
    west = 0.0  # where the part begins [m]
    for k, part in enumerate(parts):
        for o in part.room.openings:
            if o.kind != "doorway":
                openings.append(replace(o, centre=round(o.centre + west, 4)) if o.wall in ("south", "north") else o)
            elif o.wall == "east":
                openings.append(replace(o, wall=f"partition_{k + 1}"))
        for f in part.fixtures:
            number = 1 + sum(g.category == f.category for g in fixtures)
            x, y, z = f.position
            fixtures.append(replace(f, name=f"{f.category}_{number}", position=(round(x + west, 4), y, z)))
        west = round(west + part.room.size[0], 4)
        if k + 1 < len(parts):
            partitions.append(
                Partition(f"partition_{k + 1}", "y", round(west + PARTITION_THICKNESS / 2, 4), PARTITION_THICKNESS)
            )
            west = round(west + PARTITION_THICKNESS, 4)
    room = replace(first, size=(west, first.size[1]), openings=tuple(openings), partitions=tuple(partitions))
    return arranged(room, draw, fixtures)


def arranged(room: Room, draw: Draw, fixtures: list[Fixture]) -> Arrangement:
    """A whole room with its pieces, from which others keep clear."""
    occupied = [boxes.box_of(f, asset(f.asset).extent) for f in fixtures]
    return Arrangement(room, draw, fixtures, occupied, [space_before(room, o) for o in room.openings])


def mirrored(made: Arrangement, sideways: bool, lengthways: bool) -> Arrangement:
    """The same room with left and right, or front and back, exchanged. Models keep their own handedness."""
    room, fixtures = made.room, made.fixtures
    for wanted, axis in ((sideways, "x"), (lengthways, "y")):
        if wanted:
            length = room.size[0] if axis == "x" else room.size[1]
            openings = tuple(_mirrored_opening(room, o, axis, length) for o in room.openings)
            partitions = tuple(p if p.axis == axis else replace(p, at=round(length - p.at, 4)) for p in room.partitions)
            areas = tuple(_mirrored_area(a, axis, length) for a in room.areas)
            room = replace(room, openings=openings, partitions=partitions, areas=areas)
            fixtures = [_mirrored_piece(f, axis, length) for f in fixtures]
    return arranged(room, made.draw, fixtures)


def _mirrored_opening(room: Room, o: Opening, axis: str, length: float) -> Opening:
    if runs_along_x(room, o.wall) == (axis == "x"):
        return replace(o, centre=round(length - o.centre, 4))
    return replace(o, wall=OPPOSITE.get(o.wall, o.wall))


def _mirrored_area(a: Area, axis: str, length: float) -> Area:
    ((x0, y0), (x1, y1)) = a.min, a.max
    if axis == "x":
        return replace(a, min=(round(length - x1, 4), y0), max=(round(length - x0, 4), y1))
    return replace(a, min=(x0, round(length - y1, 4)), max=(x1, round(length - y0, 4)))


def _mirrored_piece(f: Fixture, axis: str, length: float) -> Fixture:
    x, y, z = f.position
    yaw = boxes.yaw_of(f.rotation)
    position = (round(length - x, 4), y, z) if axis == "x" else (x, round(length - y, 4), z)
    return replace(f, position=position, rotation=boxes.turned(-yaw if axis == "x" else math.pi - yaw))
