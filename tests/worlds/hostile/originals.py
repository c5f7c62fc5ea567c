"""Folders of the original benchmark's format that mean harm or are broken, each decided by its number alone."""

from __future__ import annotations

import os
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.worlds.files.original_folders import FIRE_INFO, FLOOD, WIND_INFO, add, kitchen, street, xyz
from tests.worlds.hostile.junk import WORDS, damaged, spoilt, text

Parts = dict[str, bytes]  # files of a folder
START = {"$type": "add_scene", "name": "mm_kitchen_2a", "url": "https://example.org"}
BOTTLE = "b04_whiskeybottle"


def _parts(draw: random.Random) -> dict[str, Any]:
    if draw.random() < 0.6:
        return {"log.txt": kitchen(), "info.json": dict(FIRE_INFO), "flood.json": dict(FLOOD)}
    return {"log.txt": street(), "info.json": dict(WIND_INFO)}


def _written(parts: dict[str, Any]) -> Parts:
    return {name: part if isinstance(part, bytes) else text(part) for name, part in parts.items()}


def entries(draw: random.Random) -> Parts:
    parts = _parts(draw)
    victim = draw.choice(list(parts))
    return _written({**parts, victim: spoilt(parts[victim], draw, draw.choice((1, 1, 5)))})


def broken_bytes(draw: random.Random) -> Parts:
    parts = _written(_parts(draw))
    victim = draw.choice(list(parts))
    return {**parts, victim: damaged(parts[victim], draw)}


def numbers(draw: random.Random) -> Parts:
    """Numbers that the reader of logs allows, and the reader of scenes perhaps not."""
    parts = _parts(draw)
    far = draw.choice((1e-9, 999.0, 1001.0, 5000.0, 9999.0))
    log = parts["log.txt"]
    log.append(
        draw.choice(
            (
                {"$type": "set_mass", "id": 2, "mass": far},
                {"$type": "scale_object", "id": 3, "scale_factor": xyz(far, 1, far)},
                {"$type": "teleport_object", "id": 4, "position": xyz(far, 0, -far)},
                add(77, BOTTLE, "bottle", (far, 0.0, 0.0)),
                add(78, BOTTLE, "bottle", (0.0, 0.0, 0.0), scale_factor=far),
            )
        )
    )
    return _written(parts)


def attached(draw: random.Random) -> Parts:
    """Hundreds of things attached to each other, moved thousands of times."""
    many, moves = draw.choice((899, 990)), draw.choice((100, 20_000))
    log = [START, *(add(i, BOTTLE, "bottle", (0.01 * (i % 50), 0.0, 0.01 * (i // 50))) for i in range(1, many + 1))]
    chain = draw.random() < 0.5
    log += [{"$type": "parent_object_to_object", "id": i, "parent_id": i - 1 if chain else 1} for i in range(2, many)]
    log += [{"$type": "teleport_object", "id": 1, "position": xyz(0, 0, 0)}] * moves
    return _written({"log.txt": log, "info.json": dict(FIRE_INFO), "flood.json": dict(FLOOD)})


def crowds(draw: random.Random) -> Parts:
    """As many things as are allowed, or more, holding and hiding each other."""
    many = draw.choice((500, 999, 1001))
    models = (("cabinet_36_two_door_wood_beech_honey_composite", "cabinet"), (BOTTLE, "bottle"), ("no_model", "lamp"))
    log: list[dict[str, Any]] = [START]
    for i in range(many):
        name, category = draw.choice(models)
        log.append(add(i, name, category, (draw.uniform(-2, 2), draw.uniform(0, 2), draw.uniform(-2, 2))))
        if draw.random() < 0.3:
            log.append({"$type": "set_kinematic_state", "id": i, "is_kinematic": True})
        box = {"position": xyz(0, draw.random(), 0), "tag": "on", "half_extents": xyz(1, 0.01, 1)}
        log += [{"$type": "add_box_container", "id": i, "container_id": 0, **box}] * draw.choice((0, 1, 30))
    log.append(add(5000, BOTTLE, "bottle", (0.0, 0.0, 0.0)))
    return _written({"log.txt": log, "info.json": dict(FIRE_INFO), "flood.json": dict(FLOOD)})


def words(draw: random.Random) -> Parts:
    parts = _parts(draw)
    command, word = draw.choice(parts["log.txt"]), draw.choice(WORDS)
    command[draw.choice([k for k, v in command.items() if isinstance(v, str)])] = word
    return _written(parts)


def missing(draw: random.Random) -> Parts:
    parts = _written(_parts(draw))
    victim = draw.choice(list(parts))
    return {**parts, victim: draw.choice((b"", b"{}", b"[]", b"null", b"[[]]", b'["a"]', b"7" * 100, b"[" * 99_999))}


KINDS: tuple[Callable[[random.Random], Parts], ...] = (
    entries,
    numbers,
    attached,
    words,
    crowds,
    broken_bytes,
    missing,
)


def original_folder(number: int, where: Path) -> tuple[str, Path]:
    """Write the hostile folder of a number, 0, 1, ... into `where`; the name of its kind, and the folder."""
    kind, draw = KINDS[number % len(KINDS)], random.Random(f"original {number}")
    parts = kind(draw)
    odd = number % 5 == 4
    folder = where / ("a\x1b[31m\x1b]0;b\x07c" if odd else "suburb_scene_2023-1-7")
    folder.mkdir()
    for name, data in parts.items():
        (folder / name).write_bytes(data)
    if number % 11 == 10:  # files that a reader would wait for, or that never end
        victim = folder / draw.choice(list(parts))
        victim.unlink()
        os.mkfifo(victim) if draw.random() < 0.5 else victim.symlink_to("/dev/zero")
    return kind.__name__, folder
