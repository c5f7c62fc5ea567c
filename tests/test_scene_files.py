"""Scenes as JSON: round trip, and refusal of everything that is no scene."""

from __future__ import annotations

import dataclasses
import json
import time
from typing import Any

import pytest

from hazard_ms.scenes.schema import LARGEST_FILE, check, from_json, to_json
from hazard_ms.scenes.splits import scene
from hazard_ms.spec import SceneSpec

SPEC = scene("kitchen_a/03")


def changed(at: str, value: Any) -> str:
    """The scene's JSON with another value at a path like "bodies.0.mass"."""
    data = json.loads(to_json(SPEC))
    *way, last = [int(w) if w.isdigit() else w for w in at.split(".")]
    inner = data
    for step in way:
        inner = inner[step]
    inner[last] = value
    return json.dumps(data)


def test_round_trip_is_exact() -> None:
    text = to_json(SPEC)
    assert from_json(text) == SPEC
    assert to_json(from_json(text)) == text
    assert from_json(text.encode()) == SPEC


def test_what_may_be_left_out_gets_its_default() -> None:
    data = json.loads(to_json(SPEC))
    for body in data["bodies"]:
        del body["scale"], body["mass"]
    assert from_json(json.dumps(data)) == SPEC


@pytest.mark.parametrize(
    ("at", "value", "message"),
    [
        ("colour", "red", "unknown key 'colour'; allowed: name, room"),
        ("bodies.0.velocity", [0, 0, 0], r"bodies\[0\]: unknown key 'velocity'"),
        ("bodies.0.position", [0, 0, float("nan")], "NaN is no number"),
        ("bodies.0.position", [0, 0, float("inf")], "Infinity is no number"),
        ("bodies.0.position", [0, 0, 1e9], r"bodies\[0\].position\[2\]: 1000000000.0 is no number between"),
        ("bodies.0.position", [0, 0], r"position: 2 entries; 3 are needed"),
        ("bodies.0.position", "0,0,0", "is no list"),
        ("bodies.0.position.1", True, "True is no number"),
        ("bodies.0.rotation", [1.0, 1.0, 0.0, 0.0], "no unit quaternion"),
        ("bodies.0.scale", [1.0, 0.0, 1.0], "only positive numbers"),
        ("bodies.0.mass", -1, "mass -1.0"),
        ("bodies.0.name", 7, r"bodies\[0\].name: 7 is no str"),
        ("bodies.0.asset", "../../etc/passwd", "is no name of letters"),
        ("bodies.0.asset", "/etc/passwd", "is no name of letters"),
        ("bodies.0.asset", "a" * 300, "is no name of letters"),
        ("bodies.0.category", "dragon", "category of .* is 'dragon'; allowed: bag"),
        ("bodies.0", None, r"bodies\[0\]: None is no object"),
        ("bodies", {}, "bodies: {} is no list"),
        ("bodies", [{}] * 5000, "5000 entries; at most 2000"),
        ("target_categories.0", "dragon", "'dragon'; allowed"),
        ("fires.0", [50.0, 1.0], "fire at .50.0, 1.0. is outside of the room"),
        ("agent_start.position", [-1.0, 1.0], "agent start at"),
        ("room.size", [0.0, 5.0], "room of"),
        ("room.floor", "lava", "no material is called 'lava'"),
        ("room.openings.0.wall", "upper", "no wall is called"),
        ("room.openings.0.kind", "hole", "none of door, window, doorway"),
        ("format", 2, "format: 2 is not the format 1"),
    ],
)
def test_hostile_scenes_are_refused(at: str, value: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        from_json(changed(at, value))


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "null",
        "{",
        "[" * 100_000,
        '"scene"',
        '{"format": 1}',
        '{"format": 1, "format": 1}',
        b"\xff\xfe{}",
        '{"format": 1e999}',
    ],
)
def test_what_is_no_scene_is_refused(text: str | bytes) -> None:
    with pytest.raises(ValueError, match="format|JSON|lacks|twice"):
        from_json(text)


def test_large_files_are_refused_at_once() -> None:
    before = time.process_time()
    with pytest.raises(ValueError, match=f"at most {LARGEST_FILE}"):
        from_json("x" * 100_000_000)
    with pytest.raises(ValueError, match="digits"):
        from_json('{"format": ' + "9" * (LARGEST_FILE - 100) + "}")
    assert time.process_time() - before < 2.0


def test_names_must_differ() -> None:
    twin = dataclasses.replace(SPEC, bodies=(*SPEC.bodies, SPEC.bodies[0]))
    with pytest.raises(ValueError, match="2 things are called"):
        check(twin)


def test_every_field_is_written() -> None:
    """A field that a later version adds to the spec must be in the file, too."""
    data = json.loads(to_json(SPEC))
    assert set(data) == {"format"} | {f.name for f in dataclasses.fields(SceneSpec)}
    assert set(data["bodies"][0]) == {f.name for f in dataclasses.fields(SPEC.bodies[0])}
    assert set(data["room"]["openings"][0]) == {f.name for f in dataclasses.fields(SPEC.room.openings[0])}
