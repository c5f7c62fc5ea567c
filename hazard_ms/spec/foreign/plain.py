"""JSON of others, with limits on its size, depth and numbers; and frozen dataclasses from it, by their types."""

from __future__ import annotations

import dataclasses
import functools
import json
import types
import typing
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hazard_ms.spec.foreign.files import printable, read_foreign
from hazard_ms.spec.foreign.json_hooks import HOOKS

MOST_MEMORY = 800_000_000  # that the values of one file may take [bytes] [ours]
# [bytes] of CPython 3.11: an object, a key of it with its value, a list, a place in a list with its number
OBJECT, KEY, LIST, ENTRY = 96, 200, 64, 48
PLAIN_CHARACTER, CHARACTER = 2, 8  # [bytes] of a text and of what is made of it: of ASCII, and where one is wider
DEEPEST = 64  # objects and lists in one another [ours]
SHOWN = 100  # characters of a bad value in an error


@dataclass(frozen=True)
class Limits:
    """The limits on values of one kind of file: the largest number either way, and what text and lists may hold."""

    farthest: float = 1e12
    as_float: bool = False  # whether whole numbers become floats where these are meant
    longest_text: int = 1_000_000  # [characters]
    most_entries: int = 1_000_000  # of a list or an object
    text: Callable[[str], str] = lambda text: ""  # what is wrong with a text; empty: nothing


@dataclass(frozen=True)
class Within:
    """The bounds of a number, or of the length of a text, a list or an object: `Annotated[int, Within(0, 9)]`."""

    low: float
    high: float

    def check(self, value: Any, where: str) -> None:
        """Raises ValueError that names the place for a value out of these bounds; None is in all bounds."""
        number = isinstance(value, (int, float))
        if value is not None and not self.low <= (value if number else len(value)) <= self.high:
            what = "a number from" if number else "of length"
            got = f"{len(value)} characters" if isinstance(value, str) else _show(value)
            raise ValueError(f"{where} must be {what} {self.low:g} to {self.high:g}, got {got}")


def parse(content: str | bytes, what: str) -> Any:
    """The values that JSON holds; errors call it `what`.

    Raises ValueError for text that is not JSON, for numbers that are not finite or absurdly long, for a key that occurs
    twice, and for values that would take more than MOST_MEMORY or are nested deeper than DEEPEST.
    """
    _check_memory(content, what)
    try:
        found = json.loads(content, **HOOKS)
    except RecursionError:
        raise ValueError(f"{what} must be nested at most {DEEPEST} deep, got more") from None
    except ValueError as error:  # UnicodeDecodeError and JSONDecodeError are, too
        raise ValueError(f"{what} must be valid JSON: {printable(str(error))}") from None
    _check_depth(found, what)
    return found


def read(path: Path, most: int, what: str = "") -> dict[str, Any]:
    """The object of JSON in a regular file of at most `most` bytes, called `what` in errors; empty: its path.

    Raises ValueError as `read_foreign` and `parse` do, and for anything but an object.
    """
    shown = printable(what or str(path))
    found = parse(read_foreign(path, most, shown), shown)
    if not isinstance(found, dict):
        raise ValueError(f"{shown} must hold an object, got {_show(found)}")
    return found


def made(kind: Any, value: Any, where: str, limits: Limits | None = None) -> Any:
    """A value of the type `kind` from plain data that errors call `where`.

    `kind` is a frozen dataclass, a tuple, a dict with keys of text, a number, a truth value, text, one of these or
    None, one of these `Within` bounds, or Any. Raises ValueError that names the place of the first value that is of
    another type, out of its bounds or past `limits`.
    """
    limits = limits or Limits()
    if dataclasses.is_dataclass(kind):
        return _object(kind, value, where, limits)
    origin = typing.get_origin(kind)
    if origin is typing.Annotated:
        inner, bounds = typing.get_args(kind)
        found = made(inner, value, where, limits)
        bounds.check(value, where)
        return found
    if origin in (types.UnionType, typing.Union):
        (inner,) = (k for k in typing.get_args(kind) if k is not type(None))
        return None if value is None else made(inner, value, where, limits)
    if kind is Any:
        return _any(value, where, limits)
    if origin is tuple:
        return _list(typing.get_args(kind), value, where, limits)
    if origin is dict or kind is dict:
        return _mapping(typing.get_args(kind), value, where, limits)
    return _single(kind, value, where, limits)


def _single(kind: Any, value: Any, where: str, limits: Limits) -> Any:
    """A number, a truth value or a text."""
    if kind in (int, float):
        kinds = (int,) if kind is int else (int, float)
        plain = isinstance(value, kinds) and not isinstance(value, bool)
        if not plain or not -limits.farthest <= value <= limits.farthest:
            word = "whole number" if kind is int else "number"
            raise ValueError(
                f"{where} must be a {word} from {-limits.farthest:g} to {limits.farthest:g}, got {_show(value)}"
            )
        return float(value) if kind is float and limits.as_float else value
    if kind is bool and isinstance(value, bool):
        return value
    if kind is str and isinstance(value, str):
        long = f"a text of at most {limits.longest_text} characters" if len(value) > limits.longest_text else ""
        if wrong := long or _not_unicode(value) or limits.text(value):
            raise ValueError(f"{where} must be {wrong}, got {_show(value)}")
        return value
    raise ValueError(f"{where} must be a {getattr(kind, '__name__', kind)}, got {_show(value)}")


def _not_unicode(text: str) -> str:
    try:
        text.encode()
    except UnicodeEncodeError:  # half of a surrogate pair, which JSON can hold
        return "valid Unicode"
    return ""


def _object(kind: Any, value: Any, where: str, limits: Limits) -> Any:
    fields = _fields(kind)
    if not isinstance(value, dict):
        raise ValueError(f"{where} must be an object with the keys {', '.join(fields)}, got {_show(value)}")
    for key in value.keys() - fields.keys():
        from hazard_ms.spec.checks import one_of  # loads numpy

        one_of(key, fields, f"key of {where}")
    absent = [k for k, (_, must) in fields.items() if must and k not in value]
    if absent:
        listed = printable(", ".join(value))[:SHOWN] or "nothing"
        raise ValueError(f"{where} must have {', '.join(absent)}, got {listed}")
    return kind(**{k: made(fields[k][0], v, f"{where}.{k}", limits) for k, v in value.items()})


def _list(kinds: tuple[Any, ...], value: Any, where: str, limits: Limits) -> tuple[Any, ...]:
    if not isinstance(value, (list, tuple)):
        raise ValueError(f"{where} must be a list, got {_show(value)}")
    if kinds[-1] is Ellipsis:
        _check_count(value, where, limits)
        kinds = (kinds[0],) * len(value)
    if len(kinds) != len(value):
        raise ValueError(f"{where} must have {len(kinds)} entries, got {len(value)}")
    return tuple(made(k, v, f"{where}[{i}]", limits) for i, (k, v) in enumerate(zip(kinds, value, strict=True)))


def _mapping(kinds: tuple[Any, ...], value: Any, where: str, limits: Limits) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise ValueError(f"{where} must be an object, got {_show(value)}")
    _check_count(value, where, limits)
    inner = kinds[1] if kinds else Any
    names = {key: made(str, key, f"a key of {where}", limits) for key in value}
    return {names[key]: made(inner, v, f"{where}.{printable(key)[:SHOWN]}", limits) for key, v in value.items()}


def _any(value: Any, where: str, limits: Limits) -> Any:
    """Plain data of whatever form."""
    if value is None:
        return None
    if isinstance(value, dict):
        return _mapping((str, Any), value, where, limits)
    if isinstance(value, (list, tuple)):
        kept = _list((Any, Ellipsis), value, where, limits)
        return list(kept) if isinstance(value, list) else kept
    return _single(type(value), value, where, limits)


def _check_count(value: Any, where: str, limits: Limits) -> None:
    if len(value) > limits.most_entries:
        raise ValueError(f"{where} must have at most {limits.most_entries} entries, got {len(value)}")


@functools.lru_cache(maxsize=64)
def _fields(kind: type) -> dict[str, tuple[Any, bool]]:
    """The fields of a dataclass: their types, and whether they must be given."""
    hints = typing.get_type_hints(kind, include_extras=True)
    missing = dataclasses.MISSING
    return {
        f.name: (hints[f.name], f.default is missing and f.default_factory is missing) for f in dataclasses.fields(kind)
    }


def _show(value: Any) -> str:
    """The start of a bad value, as an error shows it."""
    if value and isinstance(value, (dict, list, tuple)):  # whose text could be long
        return f"{'an object' if isinstance(value, dict) else 'a list'} of {len(value)}"
    return printable(f"{value!r:.{SHOWN}}")


def _check_memory(content: str | bytes, what: str) -> None:
    """Raises ValueError for text whose values could take more than MOST_MEMORY, before they are made."""
    marks: tuple[Any, ...] = (
        ("{", ":", "[", ",", "\\u") if isinstance(content, str) else (b"{", b":", b"[", b",", b"\\u")
    )
    objects, keys, lists, entries, escapes = (content.count(mark) for mark in marks)
    each = PLAIN_CHARACTER if content.isascii() and not escapes else CHARACTER
    needed = each * len(content) + OBJECT * objects + KEY * keys + LIST * lists + ENTRY * entries
    if needed > MOST_MEMORY:
        raise ValueError(f"{what} must need at most {MOST_MEMORY} bytes of memory, got up to {needed}")


def _check_depth(value: Any, what: str) -> None:
    layer = [value]
    for _ in range(DEEPEST + 1):
        layer = [v for each in layer if isinstance(each, (dict, list)) for v in _parts(each)]
        if not layer:
            return
    raise ValueError(f"{what} must be nested at most {DEEPEST} deep, got more")


def _parts(value: dict[str, Any] | list[Any]) -> Any:
    return value.values() if isinstance(value, dict) else value
