"""The openings in the outer walls of a scene through which water comes: a flood begins with them open."""

from __future__ import annotations

from hazard_ms.spec import Opening, Room, SceneSpec

DOOR = 0.9  # width of an opening where a scene has no door [m] [ours: that of a front door]
SIDES = ("west", "east", "south", "north")  # the outer walls


def inlets(spec: SceneSpec) -> list[Opening]:
    """The openings that water comes in through: outer doors, or stand-ins for them where they are in too few walls."""
    doors = [o for o in spec.room.openings if o.kind == "door" and o.wall in SIDES]
    walls = {door.wall for door in doors}
    second = [] if spec.second_flood_side is None else [spec.second_flood_side]
    sides = [*second, spec.flood_side] if doors else [spec.flood_side, *second]
    without = [wall for wall in sides if wall not in walls]
    missing = max(0, 1 + len(second) - len(walls))
    return doors + [_middle(spec.room, wall) for wall in without[:missing]]


def _middle(room: Room, wall: str) -> Opening:
    """An opening in the middle of an outer wall."""
    if wall not in SIDES:
        raise ValueError(f"flood_side must be one of {', '.join(SIDES)}, got {wall!r}")
    return Opening("door", wall, room.size[1 if SIDES.index(wall) < 2 else 0] / 2, DOOR, 2.0)
