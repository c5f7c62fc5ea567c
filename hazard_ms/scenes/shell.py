"""The shell of a room as boxes: floor, walls with openings cut out, ceiling and skirting; in the open, the ground.

This is data only, without SAPIEN. Outer doors are closed and windows have panes, so that nothing gets out; openings in
partitions are empty here, since the leaves of their doors move (`leaf`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from hazard_ms.scenes.materials import MATERIALS
from hazard_ms.scenes.walls import WALL_THICKNESS, WALLS, check, on_wall, runs_along_x, thickness_of, wall_length
from hazard_ms.spec import Opening, Patch, Room, Vec3
from hazard_ms.spec.checks import one_of

FRAME = 0.05  # width of door and window frames [m]
SKIRTING = (0.08, 0.012)  # height, thickness [m]
LEAF = 0.04  # thickness of door leaves [m]
HORIZON = 60.0  # how far the ground is drawn around an open place [m]
PATCH_HEIGHT = 0.002  # by which a patch of ground stands out of what it lies on [m]


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
        """The colour of the material: linear red, green, blue, 0 to 1."""
        return MATERIALS[self.material]


def shell(room: Room) -> tuple[ShellBox, ...]:
    """All boxes of `room`. Raises ValueError for unknown materials, and for openings and partitions that do not fit."""
    for material in (room.floor, room.wall, *(p.material for p in room.patches)):
        one_of(material, MATERIALS, "material")
    check(room)
    if room.open_air:
        return tuple(_ground(room))
    walls = (*WALLS, *(p.name for p in room.partitions))
    return (*_slabs(room), *(box for wall in walls for box in _wall(room, wall)))


def _ground(room: Room) -> Iterator[ShellBox]:
    x, y = room.size
    around = room.beyond + HORIZON
    yield ShellBox(
        "ground",
        "floor",
        (x / 2, y / 2, -WALL_THICKNESS / 2),
        (x + 2 * around, y + 2 * around, WALL_THICKNESS),
        room.floor,
    )
    layers: dict[Patch, int] = {}
    for i, p in enumerate(room.patches):
        below = [q for q in room.patches[:i] if _overlap(p, q)]
        layer = 1 + max((layers[q] for q in below), default=0)
        layers[p] = layer
        size = (p.max[0] - p.min[0], p.max[1] - p.min[1], layer * PATCH_HEIGHT)
        if min(size) <= 0.0:
            raise ValueError(f"max of a patch must exceed its min on both axes, got {p}")
        centre = ((p.min[0] + p.max[0]) / 2, (p.min[1] + p.max[1]) / 2, size[2] / 2)
        yield ShellBox(f"patch_{i}", "floor", centre, size, p.material, collides=False)


def _overlap(a: Patch, b: Patch) -> bool:
    return all(a.min[k] < b.max[k] and b.min[k] < a.max[k] for k in (0, 1))


def _slabs(room: Room) -> Iterator[ShellBox]:
    x, y = room.size
    size = (x + 2 * WALL_THICKNESS, y + 2 * WALL_THICKNESS, WALL_THICKNESS)
    yield ShellBox("floor", "floor", (x / 2, y / 2, -WALL_THICKNESS / 2), size, room.floor)
    yield ShellBox("ceiling", "ceiling", (x / 2, y / 2, room.height + WALL_THICKNESS / 2), size, "ceiling")


def _wall(room: Room, wall: str) -> Iterator[ShellBox]:
    """Full-height pieces between the openings, pieces below and above each, doors and panes, and the skirting."""
    ends = WALL_THICKNESS if wall in ("south", "north") else 0.0  # south and north walls reach around the corners
    length = wall_length(room, wall)
    reached, number = -ends, 0
    openings = sorted((o for o in room.openings if o.wall == wall), key=lambda o: o.centre)
    for o in openings:
        left, right, top = o.centre - o.width / 2, o.centre + o.width / 2, o.sill + o.height
        if left < max(reached, 0.0) or right > length or top > room.height:
            raise ValueError(
                f"an opening must fit into the {wall} wall, {length} m x {room.height} m, without overlapping others, "
                f"got {o}"
            )
        pieces = ((reached, left, 0.0, room.height), (left, right, 0.0, o.sill), (left, right, top, room.height))
        for piece in pieces:
            yield from _panel(room, wall, f"wall_{wall}_{number}", *piece)
            number += 1
        if wall not in WALLS:
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
        yield _box(
            room, wall, name, "wall", ((start + end) / 2, (low + high) / 2), (end - start, high - low), deep, room.wall
        )


def _skirting(room: Room, wall: str, start: float, end: float) -> Iterator[ShellBox]:
    start, end = max(start, 0.0), min(end, wall_length(room, wall))
    height, thick = SKIRTING
    if end - start > 1e-6:
        middle = ((start + end) / 2, height / 2)
        far = thickness_of(room, wall)
        for side, deep in enumerate([(-thick, 0.0)] if wall in WALLS else [(-thick, 0.0), (far, far + thick)]):
            name = f"skirting_{wall}_{start:.2f}" + "_far" * side
            yield _box(room, wall, name, "skirting", middle, (end - start, height), deep, "trim", collides=False)


def _lining(room: Room, o: Opening, name: str) -> Iterator[ShellBox]:
    """The frame of an open doorway."""
    deep = (-0.015, thickness_of(room, o.wall) + 0.015)
    for side in (-1, 1):
        at = (o.centre + side * (o.width / 2 - 0.01), o.height / 2)
        yield _box(room, o.wall, f"{name}_side{side}", "door", at, (0.02, o.height), deep, "trim", collides=False)
    yield _box(
        room, o.wall, f"{name}_top", "door", (o.centre, o.height - 0.01), (o.width, 0.02), deep, "trim", collides=False
    )


def leaf(room: Room, o: Opening) -> ShellBox:
    """The leaf of a door in a partition, closed: in the middle of its thickness."""
    middle, deep = (o.centre, o.sill + o.height / 2), thickness_of(room, o.wall) / 2
    return _box(
        room, o.wall, f"door_{o.wall}_leaf", "door", middle, (o.width, o.height),
        (deep - LEAF / 2, deep + LEAF / 2), "door",
    )  # fmt: skip


def _closed(room: Room, o: Opening, name: str) -> Iterator[ShellBox]:
    """The door leaf or the pane, its frame, and the handle or the cross bars."""
    middle = (o.centre, o.sill + o.height / 2)
    leaf = "door" if o.kind == "door" else "glass"
    yield _box(room, o.wall, f"{name}_leaf", o.kind, middle, (o.width, o.height), (0.04, 0.08), leaf)
    deep = (-0.015, WALL_THICKNESS)  # frames stand out of the wall a little
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
        yield _box(
            room, o.wall, f"{name}_bar", o.kind, middle, (FRAME / 2, o.height), (0.03, 0.09), "trim", collides=False
        )


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
