"""Reads the JSON of the original benchmark's files strictly, and names file, line and place of what it refuses.

A log holds one list of commands after the other, usually one on each line.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from hazard_ms.spec.foreign.files import printable, read_foreign
from hazard_ms.spec.foreign.json_hooks import HOOKS

LARGEST_FILE = 8_000_000  # [bytes]; the largest published log has 200,000
FARTHEST = 10_000.0  # any number's absolute value, in its unit; ids are larger
LONGEST_TEXT = 200  # of a name [characters]
SPACE = re.compile(r"[ \t\r\n]*")


@dataclass(frozen=True)
class Record:
    """A JSON object and where it stands, with strict access to what it holds."""

    data: dict[str, Any]
    place: str  # "DIR/log.txt, line 3, command 2 (add_object)"

    def only(self, must: tuple[str, ...], may: tuple[str, ...] = ()) -> Record:
        """The record itself, if its keys are all of `must` and any of `may`. Raises ValueError for others."""
        for key in must:
            if key not in self.data:
                raise ValueError(f"{self.place}: keys must include {', '.join(must)}, got no {key!r}")
        for key in self.data:
            if key not in must and key not in may:
                raise ValueError(f"{self.place}: keys must be among {', '.join((*must, *may))}, got {key!r:.100}")
        return self

    def number(self, key: str, default: float | None = None) -> float:
        """The finite number at `key`. Raises ValueError for anything else."""
        value = self.data.get(key, default)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) <= FARTHEST:
            self.refuse(key, f"a number between -{FARTHEST:g} and {FARTHEST:g}")
        return float(value)

    def id(self, key: str = "id") -> int:
        """The id at `key`: a whole number that names a thing. Raises ValueError for anything else."""
        return self.ids(key, [self.data.get(key)])[0]

    def ids(self, key: str, values: Any = None) -> list[int]:
        """The list of ids at `key`. Raises ValueError for anything else."""
        values = self.data.get(key) if values is None else values
        if not isinstance(values, list) or not all(
            isinstance(v, int) and not isinstance(v, bool) and 0 <= v < 2**63 for v in values
        ):
            self.refuse(key, "ids, whole numbers from 0")
        return list(values)

    def text(self, key: str) -> str:
        """The text at `key`, of printable characters. Raises ValueError for anything else."""
        value = self.data.get(key)
        if not isinstance(value, str) or not 0 < len(value) <= LONGEST_TEXT or not value.isprintable():
            self.refuse(key, f"a text of 1 to {LONGEST_TEXT} printable characters")
        return str(value)

    def flag(self, key: str, default: bool | None = None) -> bool:
        """The truth value at `key`. Raises ValueError for anything else."""
        value = self.data.get(key, default)
        if not isinstance(value, bool):
            self.refuse(key, "true or false")
        return bool(value)

    def vector(self, key: str) -> tuple[float, float, float]:
        """The vector at `key`: {"x": .., "y": .., "z": ..} or [x, y, z]. Raises ValueError for anything else."""
        value = self.data.get(key)
        if isinstance(value, list) and len(value) == 3:
            value = dict(zip("xyz", value, strict=True))
        if not isinstance(value, dict) or set(value) != set("xyz"):
            self.refuse(key, "three numbers x, y, z")
        inner = Record(value, f"{self.place}, {key}")
        return inner.number("x"), inner.number("y"), inner.number("z")

    def inner(self, key: str) -> Record:
        """The object at `key`, inside this one. Raises ValueError for anything else."""
        value = self.data.get(key)
        if not isinstance(value, dict):
            self.refuse(key, "an object")
        return Record(value, f"{self.place}, {key}")

    def refuse(self, key: str, allowed: str) -> NoReturn:
        """Refuse the value at `key`. Always raises ValueError, which says what is `allowed`."""
        raise ValueError(f"{self.place}: {key} must be {allowed}, got {self.data.get(key)!r:.100}")


def read_object(path: Path) -> Record:
    """The one JSON object of a file. Raises ValueError for anything else."""
    values, shown = list(_values(path)), printable(str(path))
    if len(values) != 1 or not isinstance(values[0][1], dict):
        raise ValueError(f"{shown}, line 1: a file must hold one JSON object, got {len(values)} values")
    return Record(values[0][1], f"{shown}, line 1")


def read_commands(path: Path) -> Iterator[Record]:
    """All commands of a log in their order; `place` of each says where it stands.

    Raises ValueError that names the line for anything that is not a command.
    """
    shown = printable(str(path))
    for line, commands in _values(path):
        if not isinstance(commands, list):
            raise ValueError(f"{shown}, line {line}: a line must be a list of commands, got {commands!r:.100}")
        for number, command in enumerate(commands, 1):
            place = f"{shown}, line {line}, command {number}"
            if not isinstance(command, dict) or not isinstance(command.get("$type"), str):
                raise ValueError(f"{place}: a command must be an object with a '$type', got {command!r:.100}")
            yield Record(command, f"{place} ({printable(command['$type'][:60])})")


def _values(path: Path) -> Iterator[tuple[int, Any]]:
    """The JSON values of a file one after the other, each with the line on which it starts."""
    text, shown = _text(path), printable(str(path))
    decoder = json.JSONDecoder(**HOOKS)
    at, line, counted = 0, 1, 0
    while (at := SPACE.match(text, at).end()) < len(text):  # type: ignore[union-attr]
        line, counted = line + text.count("\n", counted, at), at
        try:
            value, at = decoder.raw_decode(text, at)
        except json.JSONDecodeError as error:
            raise ValueError(
                f"{shown}, line {error.lineno}, column {error.colno}: not valid JSON: {error.msg}"
            ) from None
        except (RecursionError, ValueError) as error:
            raise ValueError(f"{shown}, line {line}: {error}") from None
        yield line, value


def _text(path: Path) -> str:
    shown = printable(str(path))
    if not path.exists():
        raise ValueError(
            f"{shown}: there is no such file; a scene's folder holds log.txt, info.json and, indoors, flood.json"
        )
    raw = read_foreign(path, LARGEST_FILE)
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise ValueError(f"{shown}, line {line}: not UTF-8: {error.reason}") from None
