"""`hazard-ms scenes ...`: what it prints and writes, and how it ends."""

from __future__ import annotations

import dataclasses
import os
import signal
import time
from pathlib import Path

import cv2
import numpy as np
import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.pictures.scene_plan import plan, save
from hazard_ms.scenes.schema import from_json, to_json
from hazard_ms.scenes.splits import scene, scene_names
from hazard_ms.validation import scene_checks


def test_list(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenes", "list", "--split", "test", "--family", "indoor"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[1] for line in lines] == list(scene_names("test"))
    assert all(line.startswith("test ") and "60 things" in line for line in lines)


def test_make_writes_what_can_be_read_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenes", "make", "craft_room_a/05", "-o", str(tmp_path / "scene.json")]) == 0
    assert from_json((tmp_path / "scene.json").read_bytes()) == scene("craft_room_a/05")
    capsys.readouterr()
    assert main(["scenes", "make", "craft_room_a/05"]) == 0
    assert capsys.readouterr().out == to_json(scene("craft_room_a/05"))


def test_check_ends_with_1_where_there_is_a_problem(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = scene("kitchen_b/02")
    x, y, z = spec.targets[0].position
    bodies = tuple(dataclasses.replace(b, position=(x, y, z + 1.2)) if b == spec.targets[0] else b for b in spec.bodies)
    (tmp_path / "bad.json").write_text(to_json(dataclasses.replace(spec, bodies=bodies)))
    assert main(["scenes", "check", "kitchen_b/02", str(tmp_path / "bad.json"), "attic/00", "--workers", "1"]) == 1
    out = capsys.readouterr().out
    assert "ok kitchen_b/02" in out and f" of {spec.targets[0].name} " in out and "got 'attic/00'" in out
    assert "3 scenes, 2 with problems" in out


def test_reach_names_the_targets_that_a_robot_cannot_get_at(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = scene("kitchen_b/02")
    out = spec.targets[0]
    high = dataclasses.replace(out, position=(*out.position[:2], 2.4))
    bodies = tuple(high if b == out else b for b in spec.bodies)
    (tmp_path / "high.json").write_text(to_json(dataclasses.replace(spec, name="high", bodies=bodies)))
    assert main(["scenes", "reach", str(tmp_path), "kitchen_b/02", "-r", "fetch"]) == 0
    count = len(spec.targets)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == f"high fetch {count - 1} of {count} targets; not {out.name}".split()
    assert lines[1].split() == f"kitchen_b/02 fetch {count} of {count} targets".split()
    assert lines[2].startswith(f"2 scenes: fetch can get at {2 * count - 1} of {2 * count} targets, ")


def crash_or_hang(name: str) -> scene_checks.CheckedScene:
    """In the place of the true check: what PhysX can do to a process."""
    if name == "hangs":
        time.sleep(1000.0)
    if name == "crashes":
        os.kill(os.getpid(), signal.SIGKILL)
    return scene_checks.CheckedScene(name, ())


@pytest.mark.long
def test_a_check_that_hangs_or_crashes_is_a_problem(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(scene_checks, "check_one", crash_or_hang)
    monkeypatch.setattr(scene_checks, "LONGEST", 30.0)
    before = time.monotonic()
    assert scene_checks.check_all(["hangs", "crashes", "fine"], workers=2) == 1
    assert time.monotonic() - before < 800.0, "it waited for one that sleeps for 1,000 s"
    out = capsys.readouterr().out
    assert (
        "PROBLEM hangs" in out and "PROBLEM crashes" in out and "ok fine" in out and "3 scenes, 2 with problems" in out
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["check"], "must be given as names, or by --split and --family, or by --all"),
        (["check", "kitchen_a/00", "--all"], "must be given as names"),
        (["check", "kitchen_a/00", "--workers", "0"], "workers must be a whole number from 1 to 64, got 0"),
        (["check", "--split", "tst"], "did you mean 'test'"),
        (["reach"], "must be given as names"),
        (["reach", "kitchen_a/00", "-r", "fetsch"], "did you mean 'fetch'"),
        (["list", "--family", "indor"], "did you mean 'indoor'"),
        (["make", "kitchen_a/99"], "got 'kitchen_a/99'"),
        (["make", "kitchen_a/00", "-o", "no/such/folder/x.json"], "writable"),
        (["show", "kitchen_a/00", "-o", "scene.exe"], ".jpeg, got '.exe'"),
        (["show", "kitchen_a/00", "-o", "no/such/folder/x.png"], "there is no folder"),
        (["show", "missing.json"], "there is no file missing.json"),
    ],
)
def test_bad_input_ends_with_2_and_says_why(
    arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["scenes", *arguments]) == 2
    assert words in capsys.readouterr().err


def test_the_plan_shows_everything_where_it_is() -> None:
    spec = scene("flat_a/06")
    image = plan(spec)
    metre = image.shape[1] / (spec.room.size[0] + 0.6)
    assert image.shape[0] == pytest.approx((spec.room.size[1] + 0.6) * metre, abs=2)

    def colour(x: float, y: float) -> np.ndarray:
        return image[round((spec.room.size[1] + 0.3 - y) * metre), round((x + 0.3) * metre)]

    for x, y in spec.fires:
        assert any(np.array_equal(colour(x + dx, y), (255, 140, 0)) for dx in (-0.08, 0.08)), "orange around the word"
    wall, way = spec.room.partitions[0].at, next(o for o in spec.room.openings if o.kind == "doorway").centre
    assert not np.array_equal(colour(wall, way), colour(wall, 0.05 if way > 4.0 else spec.room.size[1] - 0.05)), (
        "a gap in the wall"
    )


@pytest.mark.render
def test_show_writes_a_picture(tmp_path: Path) -> None:
    save(scene("living_room_a/04"), tmp_path / "room.png")
    image = cv2.imread(str(tmp_path / "room.png"))
    assert image is not None and image.shape[1] > 1000
    view = image[26:506, -640:]
    assert view.std() > 20 and len(np.unique(view.reshape(-1, 3), axis=0)) > 1000, "there is something to see"
