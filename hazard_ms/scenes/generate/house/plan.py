"""Homes of many rooms on one floor: two rows of rooms on both sides of a hall, with doors between them.

    north_1 | north_2 | north_3
    ---------------------------   the walls of the hall run from west to east
    hall                          those between rooms from south to north; in the hall they are open arches
    ---------------------------
    south_1 | south_2 | south_3

Every room has a door to the hall. Rooms side by side may be joined by a doorway, at least two in every home, so that
its rooms have two ways out; a kitchen may be open to the room beside it. A door begins shut or ajar only where another
way leads into its room. Each room is furnished alone, as if the hall were to its south.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from hazard_ms.scenes.generate.arrangement import Arrangement, NoPlaceError, space_before
from hazard_ms.scenes.generate.draw import Draw
from hazard_ms.scenes.generate.furnishing import DOORWAY_SIZE, PARTITION_THICKNESS, arranged, holes, mirrored
from hazard_ms.scenes.generate.house.rooms import ROOMS
from hazard_ms.scenes.generate.layout import Layout, RoomPart, Span
from hazard_ms.scenes.generate.placement import place
from hazard_ms.spec import Area, Fixture, Opening, Partition, Room

# width and height of doors [m] [ours]: at least 0.9 m clear, as dwellings for wheelchairs have [DIN 18040-2]. In a map
# with cells of 0.1 m at least 7 cells of it are free; Fetch, 0.56 m wide, surely passes 7
DOOR_SIZE = (0.95, 2.05)
ARCH_EDGE = 0.1  # of an arch in the hall, on both sides [m] [ours]
OPEN_PLAN = 1.8  # width of the arch between two rooms that are open to each other [m] [ours]
JAMB = 0.25  # between a door and the next wall, at least [m] [ours]
AJAR = 0.3  # share of its width that a door that begins ajar is open [ours]: no robot fits through
OPEN_SHARE = 0.5  # of the doors that may begin shut, those that begin open [ours]
JOINED = 0.4  # share of rooms side by side that are joined by a doorway [ours]
ROWS = ("south", "north")

Joint = tuple[str, int]  # a row, and the number of the western of two rooms side by side


@dataclass(frozen=True)
class Plan:
    """The rooms of a home, keys of ROOMS, from west to east. Those of one column are equally wide."""

    columns: tuple[Span, ...]  # widths [m]
    south: tuple[str, ...]
    north: tuple[str, ...]
    open_plan: tuple[Joint, ...] = ()  # rooms that a wide arch joins

    def row(self, name: str) -> tuple[str, ...]:
        """The rooms of the row `name`, "south" or "north"."""
        return self.south if name == "south" else self.north


@dataclass(frozen=True)
class House(Layout):
    """A kind of home; `parts` are unused. `depth` is that of a row of rooms."""

    hall: Span = (1.8, 1.9)  # its depth [m]: a leaf that stands open into it leaves room for a robot
    plans: tuple[Plan, ...] = ()
    fire_distance: float = 1.5  # from a fire to targets, at least [m] [results/scenes.md]
    boards: bool = False  # whether flood boards stand in its hall, one for each outer door
    fire_reach: float = 2.5  # radius around a fire within which it is to have much value that burns [m] [the same]


@dataclass(frozen=True)
class _Sizes:
    """The sizes of a home as drawn [m]."""

    widths: list[float]  # of its columns
    depths: list[float]  # of its rows
    hall: float  # depth of the hall

    @property
    def edges(self) -> list[float]:
        """Where columns begin [m]."""
        return [sum(self.widths[:k]) + k * PARTITION_THICKNESS for k in range(len(self.widths))]

    @property
    def bottoms(self) -> tuple[float, float]:
        """Where rows begin [m]."""
        return 0.0, self.depths[0] + self.hall + 2 * PARTITION_THICKNESS


def build(layout: House, plan: Plan, draw: Draw) -> Arrangement:
    """A furnished home. Raises NoPlaceError if a piece that it needs does not fit."""
    sizes = _Sizes(
        [round(draw.uniform(*w), 1) for w in plan.columns],
        [round(draw.uniform(*layout.depth), 1) for _ in ROWS],
        round(draw.uniform(*layout.hall), 1),
    )
    floor, wall = draw.one(layout.floors), draw.one(layout.walls)
    bare = Room((0.0, 0.0), layout.height, floor, wall)
    joints = _joints(plan, sizes, draw)
    shut = _shut(plan, joints, draw)
    fixtures: list[Fixture] = []
    openings: list[Opening] = _hall(sizes)
    areas = [_area("hall", 0.0, sizes.depths[0] + PARTITION_THICKNESS, _length(sizes), sizes.hall)]
    for r, row in enumerate(ROWS):
        for k, kind in enumerate(plan.row(row)):
            ways = [replace(joints[row, k - 1], wall="west")] if (row, k - 1) in joints else []
            ways += [replace(joints[row, k], wall="east")] if (row, k) in joints else []
            if row == "south":  # it is furnished upside down
                ways = [replace(o, centre=round(sizes.depths[r] - o.centre, 4)) for o in ways]
            room = replace(bare, size=(sizes.widths[k], sizes.depths[r]))
            made = _room(ROOMS[kind], room, ways, shut.get((row, k), 1.0), draw)
            if row == "south":
                made = mirrored(made, False, True)
            at = sizes.edges[k], sizes.bottoms[r]
            fixtures += _moved(made.fixtures, fixtures, *at)
            openings += [o for o in (_placed(o, row, k, *at) for o in made.room.openings) if o]
            number = 1 + sum(a.name.rpartition("_")[0] == kind for a in areas)
            areas.append(_area(f"{kind}_{number}", *at, *room.size))
    size = (round(_length(sizes), 4), round(sizes.bottoms[1] + sizes.depths[1], 4))
    whole = replace(bare, size=size, openings=tuple(openings), partitions=_walls(sizes), areas=tuple(areas))
    made = arranged(whole, draw, fixtures)
    return mirrored(made, draw.whole(0, 1) == 1, draw.whole(0, 1) == 1) if layout.mirror else made


def _length(sizes: _Sizes) -> float:
    """Inner length of the hall [m]."""
    return sizes.edges[-1] + sizes.widths[-1]


def _area(name: str, x: float, y: float, wide: float, deep: float) -> Area:
    """The area of a room whose south-west corner is at `x`, `y` [m]."""
    return Area(name, (round(x, 4), round(y, 4)), (round(x + wide, 4), round(y + deep, 4)))


def _joints(plan: Plan, sizes: _Sizes, draw: Draw) -> dict[Joint, Opening]:
    """The doorways between rooms side by side, their centres from the south end of the rooms: at least one."""
    every = [(row, k) for row in ROWS for k in range(len(sizes.widths) - 1)]
    chosen = [joint for joint in every if joint in plan.open_plan or draw.uniform() < JOINED]
    made = {}
    for row, k in chosen or [draw.one(every)]:
        depth = sizes.depths[ROWS.index(row)]
        wide = OPEN_PLAN if (row, k) in plan.open_plan else DOORWAY_SIZE[0]
        at = round(draw.uniform(0.4, 0.6) * depth, 2)
        made[row, k] = Opening("doorway", "", at, wide, DOORWAY_SIZE[1])
    return made


def _shut(plan: Plan, joints: dict[Joint, Opening], draw: Draw) -> dict[Joint, float]:
    """The doors that begin shut or ajar, by row and number of their room, and the shares that are open.

    Of two rooms that are joined, at most one has such a door, so that each room begins with a way into it.
    """
    made: dict[Joint, float] = {}
    for row, k in joints:
        room = (row, k + draw.whole(0, 1))
        beside = [(row, room[1] + step) for step in (-1, 1)]
        if draw.uniform() >= OPEN_SHARE and not any(other in made for other in (room, *beside)):
            made[room] = draw.one((0.0, AJAR))
    return made


def _walls(sizes: _Sizes) -> tuple[Partition, ...]:
    """The walls of the hall, then those between columns."""
    along = (("hall_south", sizes.depths[0]), ("hall_north", sizes.bottoms[1] - PARTITION_THICKNESS))
    across = [(f"column_{k}", sizes.edges[k] - PARTITION_THICKNESS) for k in range(1, len(sizes.widths))]
    return (*(_wall(name, "x", at) for name, at in along), *(_wall(name, "y", at) for name, at in across))


def _wall(name: str, axis: str, at: float) -> Partition:
    """A partition whose lower face is at `at` [m]."""
    return Partition(name, axis, round(at + PARTITION_THICKNESS / 2, 4), PARTITION_THICKNESS)


def _hall(sizes: _Sizes) -> list[Opening]:
    """The front door at the hall's western end, and the arches where walls between rooms cross it."""
    middle = round(sizes.depths[0] + PARTITION_THICKNESS + sizes.hall / 2, 4)
    wide = round(sizes.hall - 2 * ARCH_EDGE, 4)
    arches = [Opening("doorway", f"column_{k}", middle, wide, DOORWAY_SIZE[1]) for k in range(1, len(sizes.widths))]
    return [Opening("door", "west", middle, *DOOR_SIZE), *arches]


def _room(part: RoomPart, room: Room, ways: list[Opening], begins: float, draw: Draw) -> Arrangement:
    """One furnished room, with the hall to its south and doorways to its neighbours; `begins`: share of its door."""
    least = DOOR_SIZE[0] / 2 + JAMB
    at = round(draw.uniform(least, room.size[0] - least), 2)
    door = Opening("door", "south", at, *DOOR_SIZE, open=begins)
    room = replace(room, openings=(*holes(part, room, draw), door, *ways))
    made = Arrangement(room, draw, kept_clear=[space_before(room, o) for o in room.openings])
    for rule in part.rules:
        if not place(rule, made) and not rule.optional:
            raise NoPlaceError(f"{rule} must find a place in a room of {room.size} m, got none")
    return made


def _moved(pieces: list[Fixture], there: list[Fixture], x: float, y: float) -> list[Fixture]:
    """The pieces of a room that begins at `x`, `y` [m], with numbers after those that are `there`."""
    made: list[Fixture] = []
    for f in pieces:
        number = 1 + sum(g.category == f.category for g in (*there, *made))
        at = (round(f.position[0] + x, 4), round(f.position[1] + y, 4), f.position[2])
        made.append(replace(f, name=f"{f.category}_{number}", position=at))
    return made


def _placed(o: Opening, row: str, column: int, x: float, y: float) -> Opening | None:
    """An opening of a room of a `row` and a `column` that begins at `x`, `y` [m]; None if its neighbour has it."""
    inner = "north" if row == "south" else "south"
    if o.wall == inner:
        return replace(o, wall=f"hall_{row}", centre=round(o.centre + x, 4))
    if o.kind == "doorway":
        return replace(o, wall=f"column_{column + 1}", centre=round(o.centre + y, 4)) if o.wall == "east" else None
    return replace(o, centre=round(o.centre + (x if o.wall in ROWS else y), 4))
