"""Reads a scene of the original benchmark: one folder (log.txt, info.json, indoors flood.json) becomes a SceneSpec.

Everything is where the original puts it before it lets things settle, to 0.5 mm: what an object calls its position, the
middle of its base, is our Body.position. Three things differ, on purpose:
- In the open the original drops its objects from 0.3 m and waits: here they start on the ground.
- Furniture in which things stand is open at the front, for no agent of ours opens doors.
- Things that cannot move there (kinematic) are fixtures here, unless they are targets: plates that the task asks for
  can be taken.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from hazard_ms.scenes import boxes, schema
from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.generate.arrangement import RESTING_HEIGHT
from hazard_ms.scenes.original.axes import (
    AXES,
    SouthWestCorner,
    about,
    inverse,
    our_direction,
    our_rotation,
    times,
    turn,
)
from hazard_ms.scenes.original.log import replay
from hazard_ms.scenes.original.models import category_of, room_box, size_of, stand_in
from hazard_ms.scenes.original.reading import Record, read_object
from hazard_ms.scenes.original.start import start
from hazard_ms.scenes.original.street import place_of, street
from hazard_ms.scenes.original.things import Log, Thing
from hazard_ms.spec import Body, Fixture, Quat, Room, SceneSpec, Vec3
from hazard_ms.spec.foreign.files import printable

FLOOD_SIDES = {"x_max": "east", "x_min": "west", "z_max": "north", "z_min": "south"}
LEDGE_DEPTH = 0.03  # a thing this far below the top of another is in it, not on it [m]
WALL_DISTANCE = 0.6  # between things and the walls of a room whose size is not known [m]
UNKNOWN_HEIGHT = 2.9  # of such a room [m]


@dataclass(frozen=True)
class Found:
    """A scene, and notes on what had to be guessed."""

    spec: SceneSpec
    notes: tuple[str, ...]


def read(folder: Path) -> Found:
    """The scene in `folder`. Raises ValueError that names file and line for anything that is not as it must be."""
    if not re.fullmatch(schema.NAME.pattern, folder.name) or len(folder.name) > schema.LONGEST_TEXT:
        raise ValueError(
            "the name of a folder must have only letters, digits and _ . : -, since it names the scene, got "
            f"{printable(str(folder))}"
        )
    log, info = replay(folder / "log.txt"), read_object(folder / "info.json")
    info.only(("task", "containers", "agent", "targets", "other"))
    if info.text("task") not in ("fire", "flood", "wind"):
        info.refuse("task", "fire, flood, wind")
    notes: list[str] = []
    make = _outdoors if info.text("task") == "wind" else _indoors
    spec = make(folder, log, info, notes)
    try:
        schema.from_json(schema.to_json(spec))  # what cannot be read back is not written
    except ValueError as error:
        raise ValueError(f"{info.place}: {error}") from None
    return Found(spec, tuple(dict.fromkeys(notes)))


def _indoors(folder: Path, log: Log, info: Record, notes: list[str]) -> SceneSpec:
    if info.data["containers"] != []:
        info.refuse("containers", "an empty list: indoors the agent carries a bag")
    targets = _targets(log, info)
    fires = info.inner("other").only(("fire",)).data["fire"]
    if not isinstance(fires, list) or len(fires) > schema.MOST_THINGS:
        info.refuse("other", "{fire: list of places}")
    places = [Record({"fire": f}, f"{info.place}, other").vector("fire") for f in fires]
    room, corner = _room(log, [info.vector("agent"), *places], notes)
    bodies, fixtures = _things(log, corner, targets, (), {}, notes)
    agent, note = start(_rounded(corner.ours(info.vector("agent")))[:2], room, (*bodies, *fixtures))
    notes += [note] if note else []
    burning = tuple(_rounded(corner.ours(p))[:2] for p in places)
    side = _flood_side(folder / "flood.json")
    return SceneSpec(folder.name, room, fixtures, bodies, targets, burning, agent, flood_side=side)


def _targets(log: Log, info: Record) -> tuple[str, ...]:
    """Our categories of the targets of an indoor scene, which info.json names in the original's words."""
    wanted, published = info.data["targets"], {t.category for t in log.things.values()}
    if not isinstance(wanted, list) or not wanted or not all(isinstance(t, str) for t in wanted):
        info.refuse("targets", "a list of categories")
    for t in wanted:
        if t not in published:
            raise ValueError(f"{info.place}: targets must be among {', '.join(sorted(published))}, got {t!r:.100}")
    ours = tuple(dict.fromkeys(category_of(t)[0] for t in wanted))
    others = sorted(c for c in published - set(wanted) if category_of(c)[0] in ours)
    if others:
        raise ValueError(
            f"{info.place}: targets must include {others[0]!r}, which has the same category here as others, got "
            f"{wanted!r:.100}"
        )
    return ours


def _flood_side(path: Path) -> str:
    flood = read_object(path).only(("flood_source_from",), ("source", "direction", "speed"))
    if flood.text("flood_source_from") not in FLOOD_SIDES:
        flood.refuse("flood_source_from", ", ".join(FLOOD_SIDES))
    return FLOOD_SIDES[flood.text("flood_source_from")]


def _outdoors(folder: Path, log: Log, info: Record, notes: list[str]) -> SceneSpec:
    agent = info.vector("agent")
    room, corner = place_of(folder.name, [agent, *(t.position for t in log.things.values())], agent[1])
    other = info.inner("other").only(("wind", "wind_resistence"))
    ids, carts = info.ids("targets"), info.ids("containers")
    resistance = _resistance(other.inner("wind_resistence"))
    for i in (*ids, *carts, *resistance):
        if i not in log.things:
            raise ValueError(f"{info.place}: ids must be those of objects in log.txt, got {i}")
    targets = tuple(dict.fromkeys(category_of(log.things[i].category)[0] for i in ids))
    bodies, fixtures = _things(log, corner, targets, carts, resistance, notes)
    if sorted(b.name for b in bodies if b.category in targets) != sorted(_name(log.things[i]) for i in ids):
        raise ValueError(f"{info.place}: targets must be all objects of their categories, each once, got {ids!r:.100}")
    dropped = tuple(_on_the_ground(b, fixtures) for b in bodies)
    begin, note = start(_rounded(corner.ours(agent))[:2], room, (*dropped, *fixtures))
    notes += [note] if note else []
    around = (*fixtures, *street(folder.name, room))
    return SceneSpec(folder.name, room, around, dropped, targets, (), begin, wind=our_direction(other.vector("wind")))


def _resistance(r: Record) -> dict[int, float]:
    """Wind resistance of things by their ids [-]."""
    for key in r.data:
        if not (key.isascii() and key.isdigit() and len(key) < 20):
            raise ValueError(f"{r.place}: keys must be ids, got {key!r:.100}")
        if r.number(key) < 0.0:
            r.refuse(key, "numbers from 0")
    return {int(key): r.number(key) for key in r.data}


def _room(log: Log, others: Iterable[Vec3], notes: list[str]) -> tuple[Room, SouthWestCorner]:
    """The room and its corner; one that is not known holds all things and the points `others`."""
    known = room_box(log.room)
    if known is None:
        points = [*others, *(t.position for t in log.things.values())]
        xs, zs = ([p[k] for p in points] for k in (0, 2))
        low, high = (
            (min(xs) - WALL_DISTANCE, min(zs) - WALL_DISTANCE),
            (max(xs) + WALL_DISTANCE, max(zs) + WALL_DISTANCE),
        )
        size, centre = (
            (high[0] - low[0], UNKNOWN_HEIGHT, high[1] - low[1]),
            ((low[0] + high[0]) / 2, 0.0, (low[1] + high[1]) / 2),
        )
        notes.append(
            f"the room {log.room!r} is not in the table: its walls stand {WALL_DISTANCE} m around what is in it"
        )
    else:
        size, centre = known
    floor = "tile" if "kitchen" in log.room else "wood"
    corner = SouthWestCorner(centre[0] - size[0] / 2, centre[1], centre[2] - size[2] / 2)
    return Room((round(size[0], 6), round(size[2], 6)), round(size[1], 6), floor, "paint_white"), corner


def _things(
    log: Log,
    corner: SouthWestCorner,
    targets: Collection[str],
    carts: Collection[int],
    wind: dict[int, float],
    notes: list[str],
) -> tuple[tuple[Body, ...], tuple[Fixture, ...]]:
    """All things in our frame, in the order of the log."""
    kinds = {i: ("cart", "") if i in carts else category_of(t.category) for i, t in log.things.items()}
    fixed = {i for i, t in log.things.items() if i in carts or (t.kinematic and kinds[i][0] not in targets)}
    moving = [t for i, t in log.things.items() if i not in fixed]
    bodies: list[Body] = []
    fixtures: list[Fixture] = []
    for i, t in log.things.items():
        (category, strange), (size, guessed) = kinds[i], size_of(t)
        notes += [f"{t.place}: {note}" for note in (strange, guessed) if note]
        kind = stand_in(t, category, size, _holds(t, size, moving) if i in fixed else ())
        rotation = _unit(our_rotation(times(t.rotation, about(AXES["yaw"], -kind.yaw))))
        name, scale, position = _name(t, category), _rounded(kind.scale), _rounded(corner.ours(t.position))
        if i in fixed:
            fixtures.append(Fixture(name, category, kind.asset, position, rotation, scale))
        else:
            position = (position[0], position[1], round(position[2] + RESTING_HEIGHT, 6))
            bodies.append(Body(name, category, kind.asset, position, rotation, scale, t.mass, wind.get(i), t.friction))
    return tuple(bodies), tuple(fixtures)


def _name(t: Thing, category: str | None = None) -> str:
    return f"{category or category_of(t.category)[0]}_{t.id}"


def _holds(thing: Thing, size: Vec3, moving: Iterable[Thing]) -> list[float]:
    """Heights above the base of `thing` at which movable things stand in it [m]."""
    found = []
    for other in moving:
        apart = (
            other.position[0] - thing.position[0],
            other.position[1] - thing.position[1],
            other.position[2] - thing.position[2],
        )
        x, y, z = turn(inverse(thing.rotation), apart)
        if abs(x) < size[0] / 2 and abs(z) < size[1] / 2 and -LEDGE_DEPTH < y < size[2] - LEDGE_DEPTH:
            found.append(y)
    return found


def _on_the_ground(b: Body, carts: Iterable[Fixture]) -> Body:
    """`b` where it lands when it is dropped: on the ground, or above the cart over which it hangs."""
    z = RESTING_HEIGHT
    for c in carts:
        box = boxes.box_of(c, asset(c.asset).extent)
        if box.distance(np.array(b.position[0]), np.array(b.position[1])) == 0.0:
            z = max(z, round(box.high, 6) + RESTING_HEIGHT)
    return replace(b, position=(b.position[0], b.position[1], z))


def _rounded(v: Vec3) -> Vec3:
    return round(v[0], 6), round(v[1], 6), round(v[2], 6)


def _unit(q: Quat) -> Quat:
    length = math.hypot(*q)
    w, x, y, z = (round(v / length, 9) + 0.0 for v in q)
    return w, x, y, z
