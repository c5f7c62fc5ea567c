"""Rows of the user's index, orders and folders that are not as they must be are refused, and change nothing."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.scenes.assets import user_models
from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.assets.intake import adding
from hazard_ms.scenes.assets.intake.model import Model
from tests.worlds.files.model_files import glb, gltf, good, uri

NAN, INF = float("nan"), float("inf")


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The user's folder, empty but for two files, of a model that does not convert itself."""
    folder = tmp_path / "mine"
    (folder / "models/thing").mkdir(parents=True)
    (folder / "models/thing/model.glb").write_bytes(glb(gltf()))
    (folder / "models/thing/hulls.ply").write_bytes(b"ply")
    (tmp_path / "outside.glb").write_bytes(glb(gltf()))
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(folder))
    return folder


ROW = {
    "id": "thing",
    "kind": "object",
    "category": "bowl",
    "visual": "models/thing/model.glb",
    "hulls": "models/thing/hulls.ply",
    "licence": "CC-BY-SA-4.0",
    "author": "a",
    "source": "s",
    "changes": "",
    "extent": [0.1, 0.1, 0.1],
    "mass": 0.2,
}
ROWS: dict[str, tuple[Any, str]] = {
    "upwards": ({"visual": "../outside.glb"}, "outside.glb"),
    "absolute": ({"visual": "/etc/passwd"}, "/etc/passwd"),
    "backslash": ({"hulls": "..\\outside.glb"}, "outside.glb"),
    "absent file": ({"visual": "models/thing/none.glb"}, "no file"),
    "category": ({"category": "unicorn"}, "unicorn"),
    "kind": ({"kind": "fixture"}, "fixture"),
    "texture": ({"kind": "texture"}, "texture"),
    "key": ({"colour": "red"}, "colour"),
    "licence empty": ({"licence": ""}, "licence"),
    "licence with lines": ({"licence": "MIT\n\x1b[31m"}, "licence"),
    "licence a number": ({"licence": 3}, "licence"),
    "id upwards": ({"id": "../thing"}, "../thing"),
    "id with a space": ({"id": "a thing"}, "a thing"),
    "id in letters of elsewhere": ({"id": "thıng"}, "thıng"),
    "id of a shipped model": ({"id": "bottle_1"}, "bottle_1"),
    "mass": ({"mass": "heavy"}, "heavy"),
    "mass not finite": ({"mass": NAN}, "must be finite"),
    "extent": ({"extent": [0.1, 0.1]}, "3 numbers"),
    "boxes": ({"boxes": [[0, 0, 0, INF, 1, 1]]}, "must be finite"),
    "boxes short": ({"boxes": [[0, 0]]}, "6 numbers"),
    "supports": ({"supports": [{"z": 0.1}]}, "min"),
    "supports no list": ({"supports": 7}, "cannot be read"),
}


def test_a_good_row_is_read(mine: Path) -> None:
    (mine / "index.json").write_text(json.dumps([ROW]))
    assert asset("thing").visual == str(mine / "models/thing/model.glb")


@pytest.mark.parametrize("case", ROWS)
def test_a_hostile_row_is_refused_by_name(case: str, mine: Path) -> None:
    change, word = ROWS[case]
    (mine / "index.json").write_text(json.dumps([{**ROW, **change}]))
    with pytest.raises(ValueError, match="asset '|^ids in |numbers must be finite") as refusal:
        user_models.user_index()
    assert word in str(refusal.value)


@pytest.mark.parametrize("missing", ["licence", "id", "visual", "kind"])
def test_a_row_that_lacks_an_entry_is_refused(missing: str, mine: Path) -> None:
    (mine / "index.json").write_text(json.dumps([{k: v for k, v in ROW.items() if k != missing}]))
    with pytest.raises(ValueError, match=missing):
        user_models.user_index()


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("[" * 100_000, "nested at most 64 deep"),
        ("{", "must be valid JSON"),
        ("{}", "a list of rows"),
        ("[7]", "7"),
        (json.dumps([ROW, ROW]), "twice"),
    ],
)
def test_an_index_that_is_none_is_refused(text: str, word: str, mine: Path) -> None:
    (mine / "index.json").write_text(text)
    with pytest.raises(ValueError, match=word):
        user_models.user_index()


def test_an_index_of_100_megabytes_is_refused_unread(mine: Path) -> None:
    with (mine / "index.json").open("wb") as file:
        file.truncate(100_000_000)
    with pytest.raises(ValueError, match="at most .* bytes, got 100000000"):
        user_models.user_index()


def test_links_out_of_the_folder_are_not_followed(mine: Path, tmp_path: Path) -> None:
    """Neither for reading, nor for writing, nor for deleting."""
    (mine / "models/thing/model.glb").unlink()
    (mine / "models/thing/model.glb").symlink_to(tmp_path / "outside.glb")
    (mine / "index.json").write_text(json.dumps([ROW]))
    with pytest.raises(ValueError, match="leads out of"):
        user_models.user_index()
    outside = tmp_path / "elsewhere"
    outside.mkdir()
    (outside / "model.glb").write_bytes(b"precious")
    (mine / "models/linked").symlink_to(outside)
    (mine / "index.json").write_text(json.dumps([{**ROW, "id": "linked"}]))
    with pytest.raises(ValueError, match="leads out of"):
        adding.remove("linked")
    assert (outside / "model.glb").read_bytes() == b"precious"
    (mine / "index.json").unlink()
    (mine / "index.json").symlink_to(tmp_path / "index_elsewhere.json")
    with pytest.raises(ValueError, match="leads out of"):
        adding.remove("thing")
    assert not (tmp_path / "index_elsewhere.json").exists()


def test_a_hostile_row_can_be_removed_and_deletes_nothing_else(mine: Path, tmp_path: Path) -> None:
    (mine / "index.json").write_text(json.dumps([ROW, {**ROW, "id": "../../outside.glb", "visual": "/etc/passwd"}]))
    adding.remove("../../outside.glb")
    assert list(user_models.user_index()) == ["thing"]
    assert (tmp_path / "outside.glb").exists()


ORDERS: dict[str, tuple[Callable[[Model], Model], dict[str, Any], str]] = {
    "category": (lambda m: dataclasses.replace(m, category="unicorn"), {}, "unicorn"),
    "no category": (lambda m: dataclasses.replace(m, category=""), {}, "category"),
    "licence": (lambda m: dataclasses.replace(m, licence=""), {}, "licence"),
    "id upwards": (lambda m: m, {"name": "../x"}, "../x"),
    "id hidden": (lambda m: m, {"name": ".x"}, "id"),
    "id empty": (lambda m: m, {"name": ""}, "id"),
    "id long": (lambda m: m, {"name": "x" * 41}, "id"),
    "id shipped": (lambda m: m, {"name": "bottle_1"}, "shipped"),
    "id to be shipped": (lambda m: m, {"name": "bottle_77"}, "shipped"),
    "mass": (lambda m: m, {"mass": NAN}, "mass"),
    "negative": (lambda m: m, {"mass": -1.0}, "mass"),
    "size": (lambda m: m, {"size": INF}, "size"),
    "up": (lambda m: dataclasses.replace(m, up="north"), {}, "north"),
    "hostile file": (lambda m: m, {}, "must lie beside it"),
}


@pytest.mark.parametrize("case", ORDERS)
def test_what_cannot_be_added_leaves_the_folder_as_it_was(
    case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    change, options, word = ORDERS[case]
    folder = tmp_path / "mine"
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(folder))
    (tmp_path / "m.gltf").write_bytes(uri("/etc/passwd"))
    with pytest.raises(ValueError, match=".") as refusal:
        adding.add(change(good(tmp_path / "m.gltf")), **{"name": "x", **options})
    assert word in str(refusal.value)
    assert not folder.exists() or [p.name for p in folder.iterdir()] == [".lock"]


def test_what_is_in_the_way_is_not_deleted(mine: Path, tmp_path: Path) -> None:
    (tmp_path / "m.gltf").write_bytes(uri("/etc/passwd"))
    (mine / "models/mine").mkdir()
    (mine / "models/mine/thesis.txt").write_text("years of work")
    with pytest.raises(ValueError, match="must be free, got a folder"):
        adding.add(good(tmp_path / "m.gltf"), "mine")
    assert (mine / "models/mine/thesis.txt").read_text() == "years of work"


def test_a_model_without_a_row_gives_way(mine: Path) -> None:
    """An add that was killed before its last step leaves files that no index names."""
    assert adding._free_place(mine, "thing") == mine / "models/thing"
    assert not (mine / "models/thing").exists()
