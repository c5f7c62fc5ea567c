"""Scenes as JSON, and back, by one schema that follows from the dataclasses of `hazard_ms.spec`.

They are written canonically (keys in the order of the fields, shortest exact numbers), so that equal scenes are equal
bytes. All that is read is checked: unknown and missing keys, types and ranges of numbers, lengths, names. Errors name
the place, for example `bodies[3].mass`.
"""

from __future__ import annotations

import dataclasses
import json
import math
import re
from collections import Counter

from hazard_ms.scenes.shell import shell
from hazard_ms.scenes.walls import WALLS
from hazard_ms.spec import Body, Fixture, SceneSpec
from hazard_ms.spec.catalogue import CATEGORIES, LEAST_VALUE, MOST_VALUE
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.foreign import plain

FORMAT = 1  # goes up when older files can no longer be read
LARGEST_FILE = 4_000_000  # [characters]; a scene of 100 things has 30,000
LONGEST_TEXT = 200  # of a name [characters]
MOST_THINGS = 2000  # of any list
FARTHEST = 1000.0  # any number's absolute value, in its unit
STRONGEST_WIND = 70.0  # [m/s] a tropical cyclone of category 5
ROOM_SIZES, ROOM_HEIGHTS = (1.0, 100.0), (1.5, 20.0)  # least and most [m] [ours]
SURROUNDINGS = (0.0, 100.0)  # how far things can be carried around a place in the open [m] [ours]
# no part begins with a dot: no path upwards
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.:\-]*(/[A-Za-z0-9][A-Za-z0-9_.:\-]*)*")


def to_json(spec: SceneSpec) -> str:
    """The scene as JSON text."""
    data = {"format": FORMAT, **dataclasses.asdict(spec)}
    for name in ("second_flood_side", "parameters"):  # few scenes have any
        if not data[name]:
            del data[name]
    if not data["room"]["areas"]:
        del data["room"]["areas"]
    for what, name in (*((o, "open") for o in data["room"]["openings"]), *((b, "value") for b in data["bodies"])):
        if what[name] is None:
            del what[name]
    return json.dumps(data, indent=1, allow_nan=False) + "\n"


def from_json(text: str | bytes) -> SceneSpec:
    """The scene that `text` holds. Raises ValueError that names what is wrong with it and what is allowed."""
    if len(text) > LARGEST_FILE:
        raise ValueError(f"a scene must have at most {LARGEST_FILE} characters, got {len(text)}")
    data = plain.parse(text, "a scene")
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        found = data.get("format") if isinstance(data, dict) else data
        raise ValueError(f"format must be {FORMAT}, got {found!r:.100}")
    del data["format"]
    spec: SceneSpec = plain.made(SceneSpec, data, "scene", LIMITS)
    check(spec)
    return spec


def check(spec: SceneSpec) -> None:
    """Check that a scene is one that can be played. Raises ValueError that names the first thing that is not."""
    things: list[Body | Fixture] = [*spec.fixtures, *spec.bodies]
    names = Counter(t.name for t in things)
    for t in things:
        if names[t.name] > 1:
            raise ValueError(f"{spec.name}: names of things must differ, got {t.name!r} {names[t.name]} times")
        one_of(t.category, CATEGORIES, f"{spec.name}: category of {t.name}")
        if abs(math.hypot(*t.rotation) - 1.0) > 1e-3:
            raise ValueError(f"{spec.name}: rotation of {t.name} must be a unit quaternion, got {t.rotation}")
        if min(t.scale) <= 0.0:
            raise ValueError(f"{spec.name}: scale of {t.name} must be above 0 on every axis, got {t.scale}")
    for b in spec.bodies:
        if b.mass is not None and b.mass <= 0.0:
            raise ValueError(f"{spec.name}: mass of {b.name} must be None or above 0 kg, got {b.mass}")
        for what, number in (("wind resistance", b.wind_resistance), ("friction", b.friction)):
            if number is not None and number < 0.0:
                raise ValueError(f"{spec.name}: {what} of {b.name} must be None or at least 0, got {number}")
        if b.value is not None and not LEAST_VALUE <= b.value <= MOST_VALUE:
            raise ValueError(
                f"{spec.name}: value of {b.name} must be None or {LEAST_VALUE:g} to {MOST_VALUE:g}, got {b.value}"
            )
    for c in spec.target_categories:
        one_of(c, CATEGORIES, f"{spec.name}: target category")
    one_of(spec.flood_side, WALLS, f"{spec.name}: flood_side")
    if spec.second_flood_side is not None:
        others = [wall for wall in WALLS if wall != spec.flood_side]
        one_of(spec.second_flood_side, others, f"{spec.name}: second_flood_side")
    if math.hypot(*spec.wind) > STRONGEST_WIND:
        raise ValueError(f"{spec.name}: wind must be at most {STRONGEST_WIND} m/s, got {spec.wind}")
    _check_room(spec)


def _check_room(spec: SceneSpec) -> None:
    room = spec.room
    for what, value, (low, high) in (
        ("size of the room", room.size[0], ROOM_SIZES),
        ("size of the room", room.size[1], ROOM_SIZES),
        ("height of the room", room.height, ROOM_HEIGHTS),
        ("beyond of the room", room.beyond, SURROUNDINGS),
    ):
        if not low <= value <= high:
            raise ValueError(f"{spec.name}: {what} must be from {low:g} to {high:g} m, got {value}")
    shell(room)  # refuses openings that do not fit, and unknown materials
    for a in room.areas:
        if not all(0.0 <= low < high <= edge for low, high, edge in zip(a.min, a.max, room.size, strict=True)):
            raise ValueError(f"{spec.name}: area {a.name} must be within the room of {room.size} m, got {a}")
    for what, (x, y) in (("agent start", spec.agent_start.position), *(("fire", f) for f in spec.fires)):
        if not (0.0 <= x <= room.size[0] and 0.0 <= y <= room.size[1]):
            raise ValueError(f"{spec.name}: {what} must be within the room of {room.size} m, got ({x}, {y})")


def _wrong_name(text: str) -> str:
    """What a text must be that is not a name; empty for a name."""
    if len(text) <= LONGEST_TEXT and NAME.fullmatch(text):
        return ""
    return f"a name of at most {LONGEST_TEXT} letters, digits and _ . : - /"


LIMITS = plain.Limits(farthest=FARTHEST, as_float=True, most_entries=MOST_THINGS, text=_wrong_name)
