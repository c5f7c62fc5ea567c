"""Scenes and folders of the original that mean harm: nothing waits, nothing goes on for minutes, no terminal obeys."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.scenes.files import read_scene
from hazard_ms.scenes.original.log import replay
from hazard_ms.scenes.original.things import MOST_STEPS
from hazard_ms.scenes.schema import from_json, to_json
from hazard_ms.scenes.splits import scene
from tests.worlds.files.original_folders import FIRE_INFO, FLOOD, add, folder, kitchen, xyz

LONG = 20.0  # of processor time, that no refusal may take [s]


def brought(where: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    """The exit code of an import, and all that it printed."""
    code = main(["scenes", "import", str(where), "-o", str(where.parent / "out")])
    said = capsys.readouterr()
    return code, said.out + said.err


@pytest.mark.parametrize(
    "command",
    [
        {"$type": "set_mass", "id": 2, "mass": 5000.0},
        {"$type": "scale_object", "id": 2, "scale_factor": xyz(5000, 5000, 5000)},
        {"$type": "teleport_object", "id": 2, "position": xyz(0, 5000, 0)},
        {"$type": "set_physic_material", "id": 2, "dynamic_friction": 9999, "static_friction": 9999},
    ],
)
def test_an_import_that_cannot_be_read_back_fails(
    command: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    where = folder(tmp_path / "a", [*kitchen(), command], FIRE_INFO, FLOOD)
    code, said = brought(where, capsys)
    assert code == 1 and "must be a number from -1000 to 1000" in said and "info.json" in said
    assert list((tmp_path / "out").iterdir()) == []


def test_an_import_that_succeeds_can_be_read_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    heavy = {"$type": "set_mass", "id": 2, "mass": 999.0}
    assert brought(folder(tmp_path / "a", [*kitchen(), heavy], FIRE_INFO, FLOOD), capsys)[0] == 0
    (mass,) = (b.mass for b in read_scene(tmp_path / "out/a.json").bodies if b.name.endswith("_2"))
    assert mass == 999.0


@pytest.mark.parametrize("place", ["type", "folder", "key", "scene", "inner folder"])
def test_no_words_of_others_command_the_terminal(
    place: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    word = "x\x1b[31m\x1b]0;pwned\x07\x9b"
    log = kitchen()
    if place == "type":
        log[0]["$type"] = word
    if place == "key":
        log[2][word] = 1
    if place == "scene":
        log[1]["name"] = word
    outer = tmp_path / word if place == "folder" else tmp_path
    outer.mkdir(exist_ok=True)
    where = folder(outer / (word if place == "inner folder" else "a"), log, FIRE_INFO, FLOOD)
    (where / "flood.json").unlink()
    code, said = brought(where, capsys)
    assert code == 1 and "hazard-ms: " in said
    assert not [c for c in said if not c.isprintable() and c != "\n"], ascii(said)
    if place == "type":
        assert r"command 1 (x\x1b[31m" in said


@pytest.mark.parametrize("command", ["show", "check"])
def test_scenes_that_are_no_files_are_refused_without_waiting(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe.json")
    Path("zero.json").symlink_to("/dev/zero")
    Path("folder.json").mkdir()
    Path("\x1b[31m.json").write_text("{")
    for name, word in (
        ("pipe.json", "pipe.json must be a regular file"),
        ("zero.json", "zero.json must be a regular file"),
        ("folder.json", "folder.json must be a regular file"),
        ("\x1b[31m.json", r"\x1b[31m.json: a scene must be valid JSON"),
    ):
        more = ["--workers", "1"] if command == "check" else []
        assert main(["scenes", command, name, *more]) == {"show": 2, "check": 1}[command]
        said = capsys.readouterr()
        assert word in said.out + said.err and "\x1b" not in said.out + said.err


@pytest.mark.parametrize("name", ["log.txt", "info.json", "flood.json"])
@pytest.mark.parametrize("kind", ["pipe", "device"])
def test_pipes_and_devices_in_a_folder_are_refused(
    name: str, kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    where = folder(tmp_path / "a", kitchen(), FIRE_INFO, FLOOD)
    (where / name).unlink()
    os.mkfifo(where / name) if kind == "pipe" else (where / name).symlink_to("/dev/zero")
    code, said = brought(where, capsys)
    assert code in (1, 2) and (f"{name} must be a regular file" in said or "1 to 2000 scene folders" in said)


def crowd(many: int, chain: bool) -> list[dict[str, Any]]:
    """A log of bottles that are all attached to the first, or each to the one before."""
    made = [{"$type": "add_scene", "name": "mm_kitchen_2a", "url": "https://example.org"}]
    made += [add(i, "b04_whiskeybottle", "bottle", (0.01 * i, 0.0, 0.0)) for i in range(many)]
    pairs = [(i, i - 1 if chain else 0) for i in range(1, many)]
    return [*made, *({"$type": "parent_object_to_object", "id": i, "parent_id": above} for i, above in pairs)]


def move(x: float, times: int = 1) -> list[dict[str, Any]]:
    return [{"$type": "teleport_object", "id": 0, "position": xyz(x, 0, 0)}] * times


@pytest.mark.parametrize("chain", [True, False])
def test_thousands_of_moves_of_hundreds_of_things_are_refused_soon(chain: bool, tmp_path: Path) -> None:
    log = [*crowd(400 if chain else 900, chain), *move(1.0, 20_000)]
    where = folder(tmp_path / "a", log, FIRE_INFO, FLOOD)
    before = time.process_time()
    with pytest.raises(ValueError, match=f"a log must move at most {MOST_STEPS} things with others, got more"):
        replay(where / "log.txt")
    assert time.process_time() - before < LONG


def test_all_that_hangs_on_a_thing_moves_with_it_however_long_the_chain(tmp_path: Path) -> None:
    """Bottle i stood i cm along x, so it stands i cm from where the first went."""
    found = replay(folder(tmp_path / "a", [*crowd(440, True), *move(2.0)], FIRE_INFO, FLOOD) / "log.txt").things
    for i, bottle in found.items():
        assert bottle.position == pytest.approx((2.0 + 0.01 * i, 0.0, 0.0))


def test_what_was_let_go_or_destroyed_moves_nothing(tmp_path: Path) -> None:
    changes = [
        {"$type": "unparent_object", "id": 1},
        {"$type": "destroy_object", "id": 2},
        add(2, "b04_whiskeybottle", "bottle", (0.5, 0.0, 0.0)),
        {"$type": "parent_object_to_object", "id": 3, "parent_id": 1},
    ]
    log = [*crowd(5, False), *changes, *move(2.0)]
    found = replay(folder(tmp_path / "a", log, FIRE_INFO, FLOOD) / "log.txt").things
    assert [found[i].position[0] for i in range(5)] == pytest.approx([2.0, 0.01, 0.5, 0.03, 2.04])


def test_a_key_that_stands_twice_among_very_many_is_found_soon() -> None:
    keys = ",".join(f'"{i}":0' for i in range(300_000))
    before = time.process_time()
    with pytest.raises(ValueError, match="keys of an object must differ, got '299999' twice"):
        from_json(f'{{{keys},"299999":0}}')
    assert time.process_time() - before < LONG


def test_a_scene_larger_than_allowed_is_refused_unread(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text(json.dumps(json.loads(to_json(scene("kitchen_a/00")))) + " " * 4_000_000)
    with pytest.raises(ValueError, match="a.json must have at most 4000000 bytes, got"):
        read_scene(tmp_path / "a.json")
