"""Scenes as JSON: round trip, and refusal of everything that is not a scene."""

from __future__ import annotations

import dataclasses
import json
import time
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.scenes.files import read_scenes
from hazard_ms.scenes.schema import LARGEST_FILE, check, from_json, to_json
from hazard_ms.scenes.splits import scene
from hazard_ms.spec import Opening, Parameter, SceneSpec

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
        ("colour", "red", "key of scene must be one of name, room, .*, got 'colour'"),
        ("bodies.0.velocity", [0, 0, 0], r"key of scene.bodies\[0\] must be one of .*, got 'velocity'"),
        ("bodies.0.position", [0, 0, float("nan")], "numbers must be finite, got NaN"),
        ("bodies.0.position", [0, 0, float("inf")], "numbers must be finite, got Infinity"),
        ("bodies.0.position", [0, 0, 1e9], r"bodies\[0\].position\[2\] must be a number .*, got 1000000000.0"),
        ("bodies.0.position", [0, 0], r"position must have 3 entries, got 2"),
        ("bodies.0.position", "0,0,0", "must be a list, got"),
        ("bodies.0.position.1", True, "must be a number .*, got True"),
        ("bodies.0.rotation", [1.0, 1.0, 0.0, 0.0], "must be a unit quaternion"),
        ("bodies.0.scale", [1.0, 0.0, 1.0], "scale of .* must be above 0"),
        ("bodies.0.mass", -1, "mass of .* must be None or above 0 kg, got -1.0"),
        ("bodies.0.name", 7, r"bodies\[0\].name must be a str, got 7"),
        ("bodies.0.asset", "../../etc/passwd", "must be a name of at most 200 letters"),
        ("bodies.0.asset", "/etc/passwd", "must be a name of at most 200 letters"),
        ("bodies.0.asset", "a" * 300, "must be a name of at most 200 letters"),
        ("bodies.0.category", "dragon", "category of .* must be one of .* names .*, got 'dragon'"),
        ("bodies.0", None, r"bodies\[0\] must be an object .*, got None"),
        ("bodies", {}, "bodies must be a list, got {}"),
        ("bodies", [{}] * 5000, "at most 2000 entries, got 5000"),
        ("target_categories.0", "dragon", "target category must be one of .*, got 'dragon'"),
        ("fires.0", [50.0, 1.0], "fire must be within the room .*, got .50.0, 1.0."),
        ("agent_start.position", [-1.0, 1.0], "agent start must be within the room"),
        ("room.size", [0.0, 5.0], "size of the room must be from 1 to 100 m, got 0.0"),
        ("room.floor", "lava", "material must be one of .* names such as wood, .*, got 'lava'"),
        ("room.openings.0.wall", "upper", "a wall must be one of south, .*, got 'upper'"),
        ("room.openings.0.kind", "hole", "must be one of door, window, doorway"),
        ("format", 2, "format must be 1, got 2"),
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
def test_what_is_not_a_scene_is_refused(text: str | bytes) -> None:
    with pytest.raises(ValueError, match="format|JSON|must have|twice|nested"):
        from_json(text)


def test_large_files_are_refused_at_once() -> None:
    before = time.process_time()
    with pytest.raises(ValueError, match=f"at most {LARGEST_FILE}"):
        from_json("x" * 100_000_000)
    with pytest.raises(ValueError, match="digits"):
        from_json('{"format": ' + "9" * (LARGEST_FILE - 100) + "}")
    assert time.process_time() - before < 2.0


def test_a_folder_gives_its_scenes_in_the_order_of_their_names(tmp_path: Path) -> None:
    """That in which `hazard-ms evaluate --scenes` plays them, too."""
    for name in ("room10", "room9", "yard"):
        (tmp_path / f"{name}.json").write_text(to_json(dataclasses.replace(SPEC, name=name)))
    assert tuple(read_scenes(tmp_path)) == ("room9", "room10", "yard")


def test_names_must_differ() -> None:
    twin = dataclasses.replace(SPEC, bodies=(*SPEC.bodies, SPEC.bodies[0]))
    with pytest.raises(ValueError, match="names of things must differ, got .* 2 times"):
        check(twin)


def test_every_field_is_written() -> None:
    """A field that a later version adds to the spec must be in the file, too."""
    other = next(wall for wall in ("east", "west") if wall != SPEC.flood_side)
    bodies = (dataclasses.replace(SPEC.bodies[0], value=7.0), *SPEC.bodies[1:])
    given = dataclasses.replace(
        SPEC, bodies=bodies, second_flood_side=other, parameters=(Parameter("earthquake", "peak", 3.5),)
    )
    data = json.loads(to_json(given))
    assert set(data) == {"format"} | {f.name for f in dataclasses.fields(SceneSpec)}
    assert from_json(to_json(given)) == given
    assert "parameters" not in json.loads(to_json(SPEC))  # as in the files of scenes that have none
    assert given.parameter("earthquake", "peak", 1.0) == 3.5
    assert given.parameter("fire", "peak", 1.0) == 1.0 == SPEC.parameter("earthquake", "peak", 1.0)
    assert "value" not in json.loads(to_json(SPEC))["bodies"][0]  # nor those of things without values of their own
    assert set(data["bodies"][0]) == {f.name for f in dataclasses.fields(SPEC.bodies[0])}
    fields = {f.name for f in dataclasses.fields(SPEC.room.openings[0])}
    assert set(data["room"]["openings"][0]) == fields - {"open"}  # as in the files of scenes whose doors are closed
    ajar = Opening("door", "south", 1.0, 0.9, 2.0, open=0.25)
    room = dataclasses.replace(SPEC.room, openings=(ajar,))
    again = from_json(to_json(dataclasses.replace(SPEC, room=room)))
    assert again.room.openings == (ajar,) and again.room.openings[0].share == 0.25
