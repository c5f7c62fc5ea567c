"""The terms in which a room is described: openings, and rules that say where furniture belongs. Data only.

Furniture faces -y of its own frame: at yaw 0 its back is to the north. `reach` is a range of fractions of a wall's
length, `area` a rectangle (left, lower, right, upper) in fractions of the floor. A rule that is optional and finds no
model or no place is left out.
"""

from __future__ import annotations

from dataclasses import dataclass

Span = tuple[float, float]
Area = tuple[float, float, float, float]


@dataclass(frozen=True)
class Hole:
    """A door or a window somewhere along a wall."""

    kind: str  # door | window
    wall: str
    reach: Span
    width: float  # [m]
    height: float  # [m]
    sill: float = 0.0  # [m]


@dataclass(frozen=True)
class Row:
    """Pieces side by side along a wall, the first one `start` metres from the wall's west or south end."""

    wall: str
    categories: tuple[str, ...]
    start: Span = (0.02, 0.05)  # [m]
    optional: bool = False


@dataclass(frozen=True)
class Against:
    """One piece with its back to a wall."""

    category: str
    walls: tuple[str, ...]
    reach: Span = (0.0, 1.0)
    optional: bool = False


@dataclass(frozen=True)
class Corner:
    """One piece in a corner, "north-west" for example, facing into the room."""

    category: str
    corners: tuple[str, ...]
    optional: bool = False


@dataclass(frozen=True)
class Standing:
    """One piece away from the walls, turned by one of `yaws` [degrees] give or take `sway`."""

    category: str
    area: Area
    yaws: tuple[float, ...] = (0.0, 90.0)
    sway: float = 3.0  # [degrees]
    optional: bool = False


@dataclass(frozen=True)
class Around:
    """Pieces that stand around one of the category `of` and face it."""

    category: str
    of: str
    count: tuple[int, int]
    distance: Span = (0.04, 0.12)  # between the boxes [m]
    optional: bool = False


@dataclass(frozen=True)
class Before:
    """One piece in front of one of the category `of`, turned like it."""

    category: str
    of: str
    distance: Span  # between the boxes [m]
    optional: bool = False


@dataclass(frozen=True)
class OnTop:
    """One piece on a surface of one of the category `of`."""

    category: str
    of: str
    optional: bool = True


@dataclass(frozen=True)
class Rug:
    """A flat piece below one of the category `of`, turned like it; it blocks nothing."""

    category: str
    of: str
    aside: float = 0.2  # from the middle of `of`, at most [m]
    sway: float = 4.0  # [degrees]
    optional: bool = True


@dataclass(frozen=True)
class Hanging:
    """Pieces on the wall behind each of the category `of`, or one anywhere on `walls` if `of` is empty."""

    category: str
    height: float  # of their lower edge [m]
    of: str = ""
    walls: tuple[str, ...] = ()
    optional: bool = True


@dataclass(frozen=True)
class Either:
    """One of several rules, drawn; where it finds no place, another of them."""

    rules: tuple[Rule, ...]
    optional: bool = False


Rule = Row | Against | Corner | Standing | Around | Before | OnTop | Rug | Hanging | Either


@dataclass(frozen=True)
class RoomPart:
    """A room, or one of several side by side: its walls are named as if it stood alone."""

    width: Span  # inner extent along x [m]
    holes: tuple[Hole, ...]
    rules: tuple[Rule, ...]


@dataclass(frozen=True)
class Layout:
    """A kind of room or flat. Its scenes differ in all that is drawn: sizes, finishes, models, places, objects."""

    name: str  # "kitchen_a"
    parts: tuple[RoomPart, ...]  # from west to east, joined by open doorways
    depth: Span  # inner extent along y [m]
    floors: tuple[str, ...]
    walls: tuple[str, ...]
    pool: tuple[str, ...]  # categories that may be targets
    things: tuple[str, ...] = ()  # categories of other objects, besides those of the pool
    targets: tuple[int, int] = (6, 14)  # number of target objects
    burning_kinds: int = 1  # of the four categories of targets, at least these many burn; at least one does not
    bodies: int = 60  # number of objects; the same in every scene, so that scenes can share a batch
    fires: tuple[int, ...] = (1, 2, 3)  # numbers of fire sources, equally likely
    inflows: int = 1  # number of walls from which water comes: 1 or 2
    height: float = 2.6  # [m]
    aisle: float = 0.8  # width of the passages [m]
    doorway: Span = (0.3, 0.7)  # where in a partition, as fractions of its length
    mirror: bool = True  # draw left and right, front and back
    anywhere: bool = False  # things may stand on all furniture, whatever it is for, as in the published scenes
