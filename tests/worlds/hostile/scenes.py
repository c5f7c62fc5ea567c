"""Scene files that mean harm or are broken, as many as are wanted, each decided by its number alone."""

from __future__ import annotations

import copy
import functools
import json
import random
from collections.abc import Callable
from typing import Any

from hazard_ms.scenes.schema import to_json
from hazard_ms.scenes.splits import scene
from tests.worlds.hostile.junk import WORDS, damaged, junk, spoilt, text

SCENES = ("kitchen_a/03", "flat_a/06", "street/00")


@functools.lru_cache(maxsize=8)
def _true(name: str) -> Any:
    return json.loads(to_json(scene(name)))


def true_scene(draw: random.Random) -> Any:
    """A scene of ours, as nested lists and objects."""
    return copy.deepcopy(_true(draw.choice(SCENES)))


def broken_bytes(draw: random.Random) -> bytes:
    return damaged(text(true_scene(draw)), draw)


def one_entry(draw: random.Random) -> bytes:
    return text(spoilt(true_scene(draw), draw, 1))


def many_entries(draw: random.Random) -> bytes:
    return text(spoilt(true_scene(draw), draw, draw.choice((3, 30))))


def things(draw: random.Random) -> bytes:
    """Impossible masses, sizes, places and turns of one thing."""
    data = true_scene(draw)
    thing = draw.choice(data["bodies"] + data["fixtures"])
    for key in draw.sample(("position", "rotation", "scale", "mass", "friction", "wind_resistance"), 2):
        numbers = [draw.choice((0.0, -1.0, 1e-12, 999.0, 1e4, 1.0, float("nan"))) for _ in range(4)]
        thing[key] = numbers[: len(thing[key])] if isinstance(thing.get(key), list) else numbers[0]
    return text(data)


def crowds(draw: random.Random) -> bytes:
    """Up to thousands of things, all in one place or far apart."""
    data = true_scene(draw)
    kind = draw.choice(("bodies", "fixtures"))
    first, many = data[kind][0], draw.choice((300, 1990, 2500))
    apart = draw.choice((0.0, 0.5))
    data[kind] = [
        {**first, "name": f"thing_{i}", "position": [i % 40 * apart, i // 40 * apart, 0.1]} for i in range(many)
    ]
    return text(data)


def names(draw: random.Random) -> bytes:
    data = true_scene(draw)
    holder = draw.choice((data, data["bodies"][0], data["fixtures"][0], data["room"], data["agent_start"]))
    keys = [k for k, v in holder.items() if isinstance(v, str)] or ["name"]
    holder[draw.choice(keys)] = draw.choice(WORDS)
    return text(data)


def rooms(draw: random.Random) -> bytes:
    """Rooms of strange sizes with strange openings, walls and floors."""
    data = true_scene(draw)
    room = data["room"]
    for key in draw.sample(sorted(room), min(3, len(room))):
        value = room[key]
        if isinstance(value, list) and value and isinstance(value[0], dict):
            room[key] = [spoilt(value[0], draw, 1) for _ in range(draw.choice((1, 50, 1999)))]
        else:
            room[key] = draw.choice((junk(draw), [100.0, 100.0], [1.0, 1.0]))
    return text(data)


def large(draw: random.Random) -> bytes:
    """Files that are large, deep, or full of long numbers and names."""
    return draw.choice(
        (
            b"[" * 100_000,
            b'{"a":' * 50_000,
            b" " * 5_000_000,
            b'{"format": ' + b"9" * 3_000_000 + b"}",
            b'{"format": 1e' + b"9" * 3_000_000 + b"}",
            b'{"' + b"x" * 3_900_000 + b'": 1}',
            b"{" + b",".join(b'"%d":0' % i for i in range(300_000)) + b', "7": 1}',
            b"{" + b",".join(b'"%d":0' % i for i in range(300_000)) + b', "format": 1}',
            b'{"format": 1, "name": ["' + b"a" * 3_000_000 + b'"]}',
            b"",
        )
    )


KINDS: tuple[Callable[[random.Random], bytes], ...] = (
    one_entry,
    things,
    crowds,
    names,
    rooms,
    large,
    many_entries,
    broken_bytes,
)


def scene_file(number: int) -> tuple[str, bytes]:
    """The hostile scene of a number, 0, 1, ...: the name of its kind, and its file."""
    kind = KINDS[number % len(KINDS)]
    return kind.__name__, kind(random.Random(f"scene {number}"))
