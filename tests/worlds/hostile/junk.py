"""Values that no reader expects, and ways to put them into JSON, chosen by a seed."""

from __future__ import annotations

import copy
import json
import random
from typing import Any

WORDS = (
    "",
    " ",
    "a" * 300,
    "../../etc/passwd",
    "/etc/passwd",
    "\x1b[31mred\x1b]0;title\x07",
    "\u202egnp.exe",
    "\ud800",
    "nul\0byte",
    "line\nbreak",
    "٣",
    "ﬃ",
    "__class__",
    "$type",
    "file:///dev/zero",
    "data:;base64,@@",
)
NUMBERS = (0, -1, 1, 7, -0.0, 1e-320, 1e9, -1e9, 1e308, 2**31, 2**32, 2**63, -(2**63), 10**29, 0.5, 5000.0, -5000.0)
NOT_FINITE = (float("nan"), float("inf"), float("-inf"))


def junk(draw: random.Random) -> Any:
    """A value that is mostly of the wrong type or size."""
    nested: Any = 0
    for _ in range(draw.choice((1, 10, 200))):
        nested = [nested] if draw.random() < 0.5 else {"a": nested}
    pools: tuple[Any, ...] = (WORDS, NUMBERS, NOT_FINITE, (None, True, False, [], {}, [None] * 3, {"x": 1}, nested))
    return draw.choice(draw.choice(pools))


def places(value: Any) -> list[tuple[Any, Any]]:
    """All entries of nested lists and objects, each as what holds it and its key there."""
    found: list[tuple[Any, Any]] = []
    waiting = [value]
    while waiting:
        at = waiting.pop()
        inner = list(at.items()) if isinstance(at, dict) else list(enumerate(at)) if isinstance(at, list) else []
        found += [(at, key) for key, _ in inner]
        waiting += [each for _, each in inner]
    return found


def spoilt(value: Any, draw: random.Random, changes: int) -> Any:
    """A copy of nested lists and objects with some entries replaced, deleted, doubled or made strange."""
    made = copy.deepcopy(value)
    for _ in range(changes):
        holder, key = draw.choice(places(made) or [([0], 0)])
        way = draw.randrange(5)
        if way == 0 and isinstance(holder, dict):
            del holder[key]
        elif way == 1 and isinstance(holder, dict):
            holder[draw.choice(WORDS)] = junk(draw)
        elif way == 2 and isinstance(holder, list):
            holder.append(copy.deepcopy(holder[key]))
        elif way == 3 and isinstance(holder[key], float):
            holder[key] *= draw.choice((-1.0, 0.0, 1e3, 1e6, 1e300))
        else:
            holder[key] = junk(draw)
    return made


def text(value: Any) -> bytes:
    """The value as JSON, with NaN, infinities and lone surrogates as they come."""
    return json.dumps(value).encode()


def damaged(data: bytes, draw: random.Random) -> bytes:
    """The bytes, cut off, with some changed, doubled, or in another encoding."""
    way = draw.randrange(5)
    if way == 0:
        return data[: draw.randrange(len(data))]
    if way == 1:
        return data + data
    if way == 2:
        return b"\xff\xfe" + data.decode("latin-1").encode("utf-16-le")
    made = bytearray(data)
    for _ in range(draw.choice((1, 5, 50))):
        made[draw.randrange(len(made))] = draw.randrange(256)
    return bytes(made)
