"""What Python's decoder of JSON is told: numbers are finite and short, and the keys of an object differ."""

from __future__ import annotations

import math
from typing import Any, NoReturn

LONGEST_NUMBER = 30  # of a whole number [characters]
SHOWN = 100  # characters of a bad value in an error


def _not_finite(word: str) -> NoReturn:
    raise ValueError(f"numbers must be finite, got {word}")


def _finite(digits: str) -> float:
    if math.isinf(number := float(digits)):
        raise ValueError(f"numbers must be finite, got {digits[:SHOWN]}")
    return number


def _whole_number(digits: str) -> int:
    """The whole number that JSON writes with `digits`. Raises ValueError for one that is absurdly long."""
    if len(digits) > LONGEST_NUMBER:
        raise ValueError(f"a whole number must have at most {LONGEST_NUMBER} digits, got {len(digits)}")
    return int(digits)


def _unique_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object of JSON. Raises ValueError for a key that occurs twice."""
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise ValueError(f"keys of an object must differ, got {key!r:.100} twice")
        found[key] = value
    return found


HOOKS: dict[str, Any] = {
    "parse_constant": _not_finite,
    "parse_int": _whole_number,
    "parse_float": _finite,
    "object_pairs_hook": _unique_keys,
}
