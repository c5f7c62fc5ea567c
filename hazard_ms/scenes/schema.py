"""Scenes as JSON, and back, by one schema that follows from the dataclasses of `hazard_ms.spec`.

They are written canonically (keys in the order of the fields, shortest exact numbers), so that equal scenes are equal
bytes. All that is read is checked: unknown and missing keys, types and ranges of numbers, lengths, names. Errors name
the place, for example `bodies[3].mass`.
"""

from __future__ import annotations

import dataclasses
import functools
import json
import math
import re
import types
import typing
from collections import Counter
from typing import Any, NoReturn

from hazard_ms.scenes.shell import shell
from hazard_ms.scenes.walls import WALLS
from hazard_ms.spec import Body, Fixture, SceneSpec
from hazard_ms.spec.catalogue import CATEGORIES
from hazard_ms.spec.checks import one_of

FORMAT = 1  # goes up when older files can no longer be read
LARGEST_FILE = 4_000_000  # [characters]; a scene of 100 things has 30,000
LONGEST_TEXT = 200  # of a name [characters]
MOST_THINGS = 2000  # of any list
FARTHEST = 1000.0  # any number's absolute value, in its unit
STRONGEST_WIND = 70.0  # [m/s] a tropical cyclone of category 5
LONGEST_NUMBER = 30  # of a whole number [characters]
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
    return json.dumps(data, indent=1, allow_nan=False) + "\n"


def from_json(text: str | bytes) -> SceneSpec:
    """The scene that `text` holds. Raises ValueError that names what is wrong with it and what is allowed."""
    if len(text) > LARGEST_FILE:
        raise ValueError(f"a scene must have at most {LARGEST_FILE} characters, got {len(text)}")
    try:
        data = json.loads(text, parse_constant=_not_finite, parse_int=whole_number, object_pairs_hook=unique_keys)
    except (RecursionError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise ValueError(f"a scene must be valid JSON: {error}") from None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        found = data.get("format") if isinstance(data, dict) else data
        raise ValueError(f"format must be {FORMAT}, got {found!r:.100}")
    del data["format"]
    spec = _read(SceneSpec, data, "scene")
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
            raise ValueError(f"{spec.name}: {what} must be {low:g} to {high:g} m, got {value}")
    shell(room)  # refuses openings that do not fit, and unknown materials
    for what, (x, y) in (("agent start", spec.agent_start.position), *(("fire", f) for f in spec.fires)):
        if not (0.0 <= x <= room.size[0] and 0.0 <= y <= room.size[1]):
            raise ValueError(f"{spec.name}: {what} must be within the room of {room.size} m, got ({x}, {y})")


@functools.lru_cache(maxsize=64)
def _fields(kind: type) -> dict[str, tuple[Any, bool]]:
    """The fields of a dataclass: their types, and whether they must be given."""
    hints = typing.get_type_hints(kind)
    missing = dataclasses.MISSING
    return {
        f.name: (hints[f.name], f.default is missing and f.default_factory is missing) for f in dataclasses.fields(kind)
    }


def _read(kind: Any, value: Any, where: str) -> Any:
    """The value that json gave, as a `kind`."""
    if dataclasses.is_dataclass(kind):
        return _read_object(kind, value, where)
    if isinstance(kind, types.UnionType) or typing.get_origin(kind) is typing.Union:
        (inner,) = (k for k in typing.get_args(kind) if k is not type(None))
        return None if value is None else _read(inner, value, where)
    if typing.get_origin(kind) is tuple:
        return _read_list(typing.get_args(kind), value, where)
    if kind is float:
        return _number(value, where)
    if kind is bool and isinstance(value, bool):
        return value
    if kind is str and isinstance(value, str):
        if len(value) > LONGEST_TEXT or not NAME.fullmatch(value):
            raise ValueError(
                f"{where} must be a name of at most {LONGEST_TEXT} letters, digits and _ . : - /, got {value!r:.100}"
            )
        return value
    raise ValueError(f"{where} must be a {getattr(kind, '__name__', kind)}, got {value!r:.100}")


def _read_object(kind: Any, value: Any, where: str) -> Any:
    fields = _fields(kind)
    if not isinstance(value, dict):
        raise ValueError(f"{where} must be an object with the keys {', '.join(fields)}, got {value!r:.100}")
    for key in value:
        one_of(key, fields, f"key of {where}")
    absent = [k for k, (_, must) in fields.items() if must and k not in value]
    if absent:
        raise ValueError(f"{where} must have {', '.join(absent)}, got {', '.join(value) or 'nothing'}")
    return kind(**{k: _read(fields[k][0], v, f"{where}.{k}") for k, v in value.items()})


def _read_list(kinds: tuple[Any, ...], value: Any, where: str) -> tuple[Any, ...]:
    if not isinstance(value, list):
        raise ValueError(f"{where} must be a list, got {value!r:.100}")
    if kinds[-1] is Ellipsis:
        if len(value) > MOST_THINGS:
            raise ValueError(f"{where} must have at most {MOST_THINGS} entries, got {len(value)}")
        kinds = (kinds[0],) * len(value)
    if len(kinds) != len(value):
        raise ValueError(f"{where} must have {len(kinds)} entries, got {len(value)}")
    return tuple(_read(k, v, f"{where}[{i}]") for i, (k, v) in enumerate(zip(kinds, value, strict=True)))


def _number(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not -FARTHEST <= value <= FARTHEST:
        raise ValueError(f"{where} must be a number from {-FARTHEST} to {FARTHEST}, got {value!r:.100}")
    return float(value)


def _not_finite(word: str) -> NoReturn:
    raise ValueError(f"numbers must be finite, got {word}")


def whole_number(digits: str) -> int:
    """The whole number that JSON writes with `digits`. Raises ValueError for one that is absurdly long."""
    if len(digits) > LONGEST_NUMBER:
        raise ValueError(f"a whole number must have at most {LONGEST_NUMBER} digits, got {len(digits)}")
    return int(digits)


def unique_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object of JSON. Raises ValueError for a key that occurs twice."""
    made: dict[str, Any] = {}
    for key, value in pairs:
        if key in made:
            raise ValueError(f"keys of an object must differ, got {key!r:.100} twice")
        made[key] = value
    return made
