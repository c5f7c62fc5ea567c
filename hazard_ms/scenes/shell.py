"""The shell of a room as boxes: floor, walls with openings cut out, ceiling, skirting. In the open: ground. Data only: no SAPIEN.

The inner faces of the walls are at x = 0, x = size[0], y = 0, y = size[1]. Doors are closed and windows have panes: nothing gets
out. Doorways, in partitions, are open.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from hazard_ms.spec import Opening, Partition, Patch, Room, Vec3

WALL = 0.12  # thickness [m]
FRAME = 0.05  # width of door and window frames [m]
SKIRTING = (0.08, 0.012)  # height, thickness [m]
WALLS = ("south", "east", "north", "west")
KINDS = ("door", "window", "doorway")  # of openings
HORIZON = 60.0  # how far the ground is drawn around an open place [m]
PATCH = 0.002  # by which a patch of ground stands out of what it lies on [m]

MATERIALS: dict[str, Vec3] = {  # linear base colours; a material is also the name of a texture where the assets have one
    "wood": (0.30, 0.16, 0.08),
    "tile": (0.62, 0.60, 0.56),
    "carpet": (0.34, 0.32, 0.30),
    "plaster": (0.58, 0.53, 0.45),
    "paint_white": (0.78, 0.77, 0.74),
    "paint_green": (0.46, 0.53, 0.43),
    "paint_blue": (0.42, 0.50, 0.56),
    "ceiling": (0.85, 0.85, 0.84),
    "trim": (0.80, 0.80, 0.78),
    "door": (0.42, 0.26, 0.14),
    "metal": (0.55, 0.55, 0.57),
    "glass": (0.62, 0.78, 0.90),
    "parquet": (0.41, 0.23, 0.10),
    "light_wood": (0.48, 0.36, 0.22),
    "dark_tile": (0.06, 0.06, 0.07),
    "carpet_blue": (0.05, 0.10, 0.13),
    "wallpaper_stripes": (0.59, 0.53, 0.40),
    "wallpaper_flowers": (0.60, 0.64, 0.58),
    "brick": (0.28, 0.10, 0.07),
    "concrete": (0.35, 0.34, 0.31),
    "asphalt": (0.06, 0.06, 0.06),
    "pavement": (0.30, 0.29, 0.27),
    "grass": (0.09, 0.13, 0.03),
    "gravel": (0.13, 0.12, 0.10),
    "soil": (0.10, 0.05, 0.03),
    "line_white": (0.75, 0.75, 0.72),
    "line_yellow": (0.72, 0.48, 0.05),
}
FLOORS = ("wood", "tile", "carpet")
WALL_FINISHES = ("plaster", "paint_white", "paint_green", "paint_blue")


@dataclass(frozen=True)
class ShellBox:
    """A box that never moves, along the room's axes."""

    name: str
    kind: str  # floor | wall | ceiling | skirting | door | window
    centre: Vec3  # [m]
    size: Vec3  # edge lengths [m]
    material: str  # a key of MATERIALS
    collides: bool = True

    @property
    def colour(self) -> Vec3:
        """Linear red, green, blue, 0 to 1."""
        return MATERIALS[self.material]


def shell(room: Room) -> tuple[ShellBox, ...]:
    """All boxes of `room`. Raises ValueError for materials that are none, and for openings and partitions that do not fit."""
    for material in (room.floor, room.wall, *(p.material for p in room.patches)):
        if material not in MATERIALS:
            raise ValueError(f"no material is called {material!r}; there are {', '.join(MATERIALS)}")
    _check(room)
    if room.open_air:
        return tuple(_ground(room))
    walls = (*WALLS, *(p.name for p in room.partitions))
    return (*_slabs(room), *(box for wall in walls for box in _wall(room, wall)))


def _check(room: Room) -> None:
    for p in room.partitions:
        across = room.size[1] if p.axis == "x" else room.size[0]
        if p.axis not in ("x", "y") or p.name in WALLS or not 0.02 <= p.thickness <= p.at <= across - p.thickness:
            raise ValueError(f"{p} does not part a room of {room.size} m; an axis x or y, a name of its own and a place inside are allowed")
    for o in room.openings:
        if o.kind not in KINDS or min(o.width, o.height) <= 0.0 or o.sill < 0.0:
            raise ValueError(f"{o} is none of {', '.join(KINDS)} of positive size")
        wall_length(room, o.wall)
        if (o.kind == "doorway") != (o.wall not in WALLS):
            raise ValueError(f"{o}: doorways belong into partitions, doors and windows into the walls {', '.join(WALLS)}")
    if room.open_air and (room.openings or room.partitions):
        raise ValueError("an open place has openings or partitions; none are allowed")
    if room.patches and not room.open_air:
        raise ValueError("a room has patches of ground; they are allowed in the open only")


def partition(room: Room, name: str) -> Partition | None:
    """The partition called `name`; None for one of the four walls."""
    if name in WALLS:
        return None
    for p in room.partitions:
        if p.name == name:
            return p
    raise ValueError(f"no wall is called {name!r}; there are {', '.join((*WALLS, *(p.name for p in room.partitions)))}")


def wall_length(room: Room, wall: str) -> float:
    """Inner length of a wall or partition [m]."""
    return room.size[0] if runs_along_x(room, wall) else room.size[1]


def runs_along_x(room: Room, wall: str) -> bool:
    """Whether a wall or partition runs from west to east."""
    inner = partition(room, wall)
    return wall in ("south", "north") if inner is None else inner.axis == "x"


def on_wall(room: Room, wall: str, along: float, z: float, depth: float) -> Vec3:
    """The point `along` metres from the wall's west or south end, at height z, `depth` metres behind its inner face [m].

    Of a partition: behind its south or west face.
    """
    x, y = room.size
    inner = partition(room, wall)
    if inner is not None:
        across = inner.at - inner.thickness / 2 + depth
        return (along, across, z) if inner.axis == "x" else (across, along, z)
    points = {
        "south": (along, -depth, z),
        "north": (along, y + depth, z),
        "west": (-depth, along, z),
        "east": (x + depth, along, z),
    }
    return points[wall]


def _ground(room: Room) -> Iterator[ShellBox]:
    x, y = room.size
    around = room.beyond + HORIZON
    yield ShellBox("ground", "floor", (x / 2, y / 2, -WALL / 2), (x + 2 * around, y + 2 * around, WALL), room.floor)
    layers: dict[Patch, int] = {}
    for i, p in enumerate(room.patches):
        below = [q for q in room.patches[:i] if _overlap(p, q)]
        layer = 1 + max((layers[q] for q in below), default=0)
        layers[p] = layer
        size = (p.max[0] - p.min[0], p.max[1] - p.min[1], layer * PATCH)
        if min(size) <= 0.0:
            raise ValueError(f"{p} has no area; max must be beyond min")
        centre = ((p.min[0] + p.max[0]) / 2, (p.min[1] + p.max[1]) / 2, size[2] / 2)
        yield ShellBox(f"patch_{i}", "floor", centre, size, p.material, collides=False)


def _overlap(a: Patch, b: Patch) -> bool:
    return all(a.min[k] < b.max[k] and b.min[k] < a.max[k] for k in (0, 1))


def _slabs(room: Room) -> Iterator[ShellBox]:
    x, y = room.size
    size = (x + 2 * WALL, y + 2 * WALL, WALL)
    yield ShellBox("floor", "floor", (x / 2, y / 2, -WALL / 2), size, room.floor)
    yield ShellBox("ceiling", "ceiling", (x / 2, y / 2, room.height + WALL / 2), size, "ceiling")


def _wall(room: Room, wall: str) -> Iterator[ShellBox]:
    """Full-height pieces between the openings, pieces below and above each, what closes the openings, and the skirting."""
    ends = WALL if wall in ("south", "north") else 0.0  # south and north walls reach around the corners
    length = wall_length(room, wall)
    reached, number = -ends, 0
    openings = sorted((o for o in room.openings if o.wall == wall), key=lambda o: o.centre)
    for o in openings:
        left, right, top = o.centre - o.width / 2, o.centre + o.width / 2, o.sill + o.height
        if left < max(reached, 0.0) or right > length or top > room.height:
            raise ValueError(f"{o} leaves the {wall} wall of {length} m x {room.height} m or cuts another opening")
        pieces = ((reached, left, 0.0, room.height), (left, right, 0.0, o.sill), (left, right, top, room.height))
        for piece in pieces:
            yield from _panel(room, wall, f"wall_{wall}_{number}", *piece)
            number += 1
        if o.kind == "doorway":
            yield from _lining(room, o, f"{o.kind}_{wall}_{number}")
        else:
            yield from _closed(room, o, f"{o.kind}_{wall}_{number}")
        yield from _skirting(room, wall, reached, left)
        if o.kind == "window":
            yield from _skirting(room, wall, left, right)
        reached = right
    yield from _panel(room, wall, f"wall_{wall}_{number}", reached, length + ends, 0.0, room.height)
    yield from _skirting(room, wall, reached, length + ends)


def _panel(room: Room, wall: str, name: str, start: float, end: float, low: float, high: float) -> Iterator[ShellBox]:
    if end - start > 1e-6 and high - low > 1e-6:
        deep = (0.0, thickness_of(room, wall))
        yield _box(room, wall, name, "wall", ((start + end) / 2, (low + high) / 2), (end - start, high - low), deep, room.wall)


def _skirting(room: Room, wall: str, start: float, end: float) -> Iterator[ShellBox]:
    start, end = max(start, 0.0), min(end, wall_length(room, wall))
    height, thick = SKIRTING
    if end - start > 1e-6:
        middle = ((start + end) / 2, height / 2)
        far = thickness_of(room, wall)
        for side, deep in enumerate([(-thick, 0.0)] if wall in WALLS else [(-thick, 0.0), (far, far + thick)]):
            name = f"skirting_{wall}_{start:.2f}" + "_far" * side
            yield _box(room, wall, name, "skirting", middle, (end - start, height), deep, "trim", collides=False)


def thickness_of(room: Room, wall: str) -> float:
    """Thickness of a wall or partition [m]."""
    inner = partition(room, wall)
    return WALL if inner is None else inner.thickness


def _lining(room: Room, o: Opening, name: str) -> Iterator[ShellBox]:
    """The frame of an open doorway."""
    deep = (-0.015, thickness_of(room, o.wall) + 0.015)
    for side in (-1, 1):
        at = (o.centre + side * (o.width / 2 - 0.01), o.height / 2)
        yield _box(room, o.wall, f"{name}_side{side}", "door", at, (0.02, o.height), deep, "trim", collides=False)
    yield _box(room, o.wall, f"{name}_top", "door", (o.centre, o.height - 0.01), (o.width, 0.02), deep, "trim", collides=False)


def _closed(room: Room, o: Opening, name: str) -> Iterator[ShellBox]:
    """The door leaf or the pane, its frame, and the handle or the cross bars."""
    middle = (o.centre, o.sill + o.height / 2)
    leaf = "door" if o.kind == "door" else "glass"
    yield _box(room, o.wall, f"{name}_leaf", o.kind, middle, (o.width, o.height), (0.04, 0.08), leaf)
    deep = (-0.015, WALL)  # frames stand out of the wall a little
    inner = FRAME / 2
    for side in (-1, 1):
        at = (o.centre + side * (o.width / 2 - inner), middle[1])
        yield _box(room, o.wall, f"{name}_side{side}", o.kind, at, (FRAME, o.height), deep, "trim", collides=False)
    for end in (-1, 1) if o.kind == "window" else (1,):
        at = (o.centre, middle[1] + end * (o.height / 2 - inner))
        yield _box(room, o.wall, f"{name}_end{end}", o.kind, at, (o.width, FRAME), deep, "trim", collides=False)
    if o.kind == "door":
        at = (o.centre + o.width / 2 - 0.12, 1.02)
        yield _box(room, o.wall, f"{name}_handle", o.kind, at, (0.12, 0.025), (-0.01, 0.04), "metal", collides=False)
    else:
        yield _box(room, o.wall, f"{name}_bar", o.kind, middle, (FRAME / 2, o.height), (0.03, 0.09), "trim", collides=False)


def _box(
    room: Room,
    wall: str,
    name: str,
    kind: str,
    middle: tuple[float, float],
    face: tuple[float, float],
    depth: tuple[float, float],
    material: str,
    collides: bool = True,
) -> ShellBox:
    """A box of the wall: `middle` and `face` along the wall and up, `depth` from and to, behind the inner face [m]."""
    centre = on_wall(room, wall, middle[0], middle[1], sum(depth) / 2)
    thick = depth[1] - depth[0]
    size = (face[0], thick, face[1]) if runs_along_x(room, wall) else (thick, face[0], face[1])
    return ShellBox(name, kind, centre, size, material, collides)
