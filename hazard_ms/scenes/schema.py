"""Scenes as JSON, and back: one schema, read off the dataclasses of hazard_ms.spec, so that a new field needs no line here.

Written canonically (keys in the order of the fields, shortest exact numbers), so that equal scenes are equal bytes. What is read
is checked: unknown and missing keys, kinds and ranges of numbers, lengths, names. Errors name the place, `bodies[3].mass` say.
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

from hazard_ms.catalogue import CATEGORIES
from hazard_ms.scenes.shell import WALLS, shell
from hazard_ms.spec import Body, Fixture, SceneSpec

FORMAT = 1  # goes up when older files can no longer be read
LARGEST_FILE = 4_000_000  # [characters]; a scene of 100 things has 30,000
LONGEST_TEXT = 200  # of a name [characters]
MOST_THINGS = 2000  # of any list
FARTHEST = 1000.0  # any number's absolute value, in its unit
STRONGEST_WIND = 70.0  # [m/s] a tropical cyclone of category 5
LONGEST_NUMBER = 30  # of a whole number [characters]
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.:\-]*(/[A-Za-z0-9][A-Za-z0-9_.:\-]*)*")  # no part begins with a dot: no path upwards


def to_json(spec: SceneSpec) -> str:
    """`spec` as text."""
    return json.dumps({"format": FORMAT, **dataclasses.asdict(spec)}, indent=1, allow_nan=False) + "\n"


def from_json(text: str | bytes) -> SceneSpec:
    """The scene that `text` holds. Raises ValueError naming what is wrong with it, and what is allowed."""
    if len(text) > LARGEST_FILE:
        raise ValueError(f"a scene of {len(text)} characters; at most {LARGEST_FILE} are allowed")
    try:
        data = json.loads(text, parse_constant=_not_finite, parse_int=whole_number, object_pairs_hook=unique_keys)
    except (RecursionError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise ValueError(f"a scene that is no JSON: {error}") from None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        found = data.get("format") if isinstance(data, dict) else data
        raise ValueError(f"format: {found!r:.100} is not the format {FORMAT}")
    del data["format"]
    spec = _read(SceneSpec, data, "scene")
    check(spec)
    return spec


def check(spec: SceneSpec) -> None:
    """Raise ValueError naming the first thing in `spec` that no scene may have."""
    things: list[Body | Fixture] = [*spec.fixtures, *spec.bodies]
    names = Counter(t.name for t in things)
    for t in things:
        if names[t.name] > 1:
            raise ValueError(f"{spec.name}: {names[t.name]} things are called {t.name!r}; names must differ")
        _category(t.category, f"{spec.name}: category of {t.name}")
        if abs(math.hypot(*t.rotation) - 1.0) > 1e-3:
            raise ValueError(f"{spec.name}: rotation {t.rotation} of {t.name} is no unit quaternion")
        if min(t.scale) <= 0.0:
            raise ValueError(f"{spec.name}: scale {t.scale} of {t.name}; only positive numbers are allowed")
    for b in spec.bodies:
        if b.mass is not None and b.mass <= 0.0:
            raise ValueError(f"{spec.name}: mass {b.mass} of {b.name}; None or a positive number is allowed")
        for what, number in (("wind resistance", b.wind_resistance), ("friction", b.friction)):
            if number is not None and number < 0.0:
                raise ValueError(f"{spec.name}: {what} {number} of {b.name}; None or a number from 0 is allowed")
    for c in spec.target_categories:
        _category(c, f"{spec.name}: target category")
    if spec.flood_side not in WALLS:
        raise ValueError(f"{spec.name}: flood side {spec.flood_side!r}; allowed: {', '.join(WALLS)}")
    if math.hypot(*spec.wind) > STRONGEST_WIND:
        raise ValueError(f"{spec.name}: wind {spec.wind} m/s; at most {STRONGEST_WIND} m/s is allowed")
    _check_room(spec)


def _check_room(spec: SceneSpec) -> None:
    room = spec.room
    if not (1.0 <= min(room.size) and max(room.size) <= 100.0 and 1.5 <= room.height <= 20.0 and 0.0 <= room.beyond <= 100.0):
        raise ValueError(
            f"{spec.name}: room of {room.size} m, {room.height} m high, {room.beyond} m around; 1 to 100, 1.5 to 20, 0 to 100 m are allowed"
        )
    shell(room)  # refuses openings that do not fit and materials that are none
    for what, (x, y) in (("agent start", spec.agent_start.position), *(("fire", f) for f in spec.fires)):
        if not (0.0 <= x <= room.size[0] and 0.0 <= y <= room.size[1]):
            raise ValueError(f"{spec.name}: {what} at ({x}, {y}) is outside of the room of {room.size} m")


def _category(name: str, where: str) -> None:
    if name not in CATEGORIES:
        raise ValueError(f"{where} is {name!r}; allowed: {', '.join(CATEGORIES)}")


@functools.lru_cache(maxsize=64)
def _fields(kind: type) -> dict[str, tuple[Any, bool]]:
    """Fields of a dataclass: their types, and whether they must be given."""
    hints = typing.get_type_hints(kind)
    missing = dataclasses.MISSING
    return {f.name: (hints[f.name], f.default is missing and f.default_factory is missing) for f in dataclasses.fields(kind)}


def _read(kind: Any, value: Any, where: str) -> Any:
    """`value`, as json gave it, as a `kind`."""
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
            raise ValueError(f"{where}: {value!r:.100} is no name of letters, digits and _ . : - /, {LONGEST_TEXT} at most")
        return value
    raise ValueError(f"{where}: {value!r:.100} is no {getattr(kind, '__name__', kind)}")


def _read_object(kind: Any, value: Any, where: str) -> Any:
    fields = _fields(kind)
    if not isinstance(value, dict):
        raise ValueError(f"{where}: {value!r:.100} is no object with the keys {', '.join(fields)}")
    unknown = [k for k in value if k not in fields]
    if unknown:
        raise ValueError(f"{where}: unknown key {unknown[0]!r:.100}; allowed: {', '.join(fields)}")
    absent = [k for k, (_, must) in fields.items() if must and k not in value]
    if absent:
        raise ValueError(f"{where}: lacks {', '.join(absent)}")
    return kind(**{k: _read(fields[k][0], v, f"{where}.{k}") for k, v in value.items()})


def _read_list(kinds: tuple[Any, ...], value: Any, where: str) -> tuple[Any, ...]:
    if not isinstance(value, list):
        raise ValueError(f"{where}: {value!r:.100} is no list")
    if kinds[-1] is Ellipsis:
        if len(value) > MOST_THINGS:
            raise ValueError(f"{where}: {len(value)} entries; at most {MOST_THINGS} are allowed")
        kinds = (kinds[0],) * len(value)
    if len(kinds) != len(value):
        raise ValueError(f"{where}: {len(value)} entries; {len(kinds)} are needed")
    return tuple(_read(k, v, f"{where}[{i}]") for i, (k, v) in enumerate(zip(kinds, value, strict=True)))


def _number(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not -FARTHEST <= value <= FARTHEST:
        raise ValueError(f"{where}: {value!r:.100} is no number between {-FARTHEST} and {FARTHEST}")
    return float(value)


def _not_finite(word: str) -> NoReturn:
    raise ValueError(f"{word} is no number that a scene may hold")


def whole_number(digits: str) -> int:
    """A whole number as JSON has it; one that is absurdly long is refused."""
    if len(digits) > LONGEST_NUMBER:
        raise ValueError(f"a whole number of {len(digits)} digits; at most {LONGEST_NUMBER} are allowed")
    return int(digits)


def unique_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object; a key that stands in it twice is refused."""
    made = dict(pairs)
    if len(made) != len(pairs):
        twice = next(k for k, _ in pairs if sum(k == other for other, _ in pairs) > 1)
        raise ValueError(f"the key {twice!r:.100} stands twice in one object")
    return made
