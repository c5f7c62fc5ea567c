"""Exports of datasets that somebody else made, or that are broken; and what an export never does."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.perception import layout
from hazard_ms.perception.exports.export import export
from hazard_ms.perception.exports.source import mask
from tests.worlds.drawn_pictures import draw


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two drawn pictures for training, one for tests."""
    folder = draw(tmp_path_factory.mktemp("exports") / "Drawn", "train", 2, 96)
    return draw(folder, "test", 1, 96, seed=1)


def source(data: Path, split: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((data / layout.instances(split)).read_text())
    return found


@pytest.mark.parametrize("to", ["yolo", "hf", "coco"])
def test_pictures_are_the_same_bytes_in_all_layouts(data: Path, tmp_path: Path, to: str) -> None:
    export(data, to, tmp_path / "out")
    found = sorted(path.read_bytes() for path in (tmp_path / "out").rglob("*.jpg"))
    assert found == sorted(
        (data / row["file_name"]).read_bytes() for s in ("train", "test") for row in source(data, s)["images"]
    )


def test_nothing_is_overwritten_and_nothing_is_left_where_an_export_fails(data: Path, tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    with pytest.raises(ValueError, match="output must be a new folder"):
        export(data, "yolo", tmp_path / "there")
    with pytest.raises(ValueError, match="to must be one of"):
        export(data, "voc", tmp_path / "out")
    broken = draw(tmp_path / "broken", "train", 2, 64)
    os.truncate(broken / source(broken, "train")["images"][1]["file_name"], 10)
    with pytest.raises(ValueError, match="must be a PNG or JPEG picture"):
        export(broken, "coco", tmp_path / "out")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["broken", "there"]


def changed(tmp_path: Path, **row: Any) -> Path:
    """A dataset of one picture, the first annotation of which is another."""
    folder = draw(tmp_path / "data", "train", 1, 64)
    rows = source(folder, "train")
    rows["annotations"][0].update(row)
    (folder / layout.instances("train")).write_text(json.dumps(rows))
    return folder


def test_polygons_and_plain_run_lengths_of_others_are_read() -> None:
    square = [[10.0, 10.0, 20.0, 10.0, 20.0, 20.0, 10.0, 20.0]]
    found = mask(square, (40, 40), "it")
    assert found[11:20, 11:20].all() and 100 <= found.sum() <= 121 and not found[:9].any()
    assert mask({"size": [2, 3], "counts": [1, 2, 3]}, (2, 3), "it").T.ravel().tolist() == [0, 1, 1, 0, 0, 0]


def test_crowds_are_left_out_of_label_files_and_told_elsewhere(tmp_path: Path) -> None:
    folder = changed(tmp_path, iscrowd=1)
    count = len(source(folder, "train")["annotations"])
    export(folder, "yolo", tmp_path / "yolo")
    (text,) = (tmp_path / "yolo").rglob("*.txt")
    assert len(text.read_text().splitlines()) == count - 1
    export(folder, "coco", tmp_path / "coco")
    assert [r["iscrowd"] for r in source(tmp_path / "coco" / "annotations", "train")["annotations"]].count(1) == 1


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ({"category_id": 99999}, "category_id must be one of the file's categories"),
        ({"segmentation": {"size": [9, 9], "counts": "0"}}, "segmentation must be run lengths of size"),
        ({"segmentation": [[0.0, 0.0, 1e12, 0.0, 0.0, 1e12]]}, "segmentation in annotation"),
        ({"segmentation": None}, "must have segmentation"),
        ({"image_id": 77}, "image_id must be the id of an image"),
    ],
)
def test_rows_of_strangers_are_checked(tmp_path: Path, row: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        export(changed(tmp_path, **row), "yolo", tmp_path / "out")


@pytest.mark.parametrize("name", ["../x.jpg", "/etc/hostname", "a\nb.jpg"])
def test_files_outside_are_never_copied(tmp_path: Path, name: str) -> None:
    folder = draw(tmp_path / "data", "train", 1, 64)
    rows = source(folder, "train")
    rows["images"][0]["file_name"] = name
    (folder / layout.instances("train")).write_text(json.dumps(rows))
    with pytest.raises(ValueError, match="inside its folder"):
        export(folder, "hf", tmp_path / "out")


@pytest.mark.parametrize("name", ['a"b', "a\nb", "x: y", ""])
def test_names_of_categories_cannot_break_yaml(tmp_path: Path, name: str) -> None:
    folder = draw(tmp_path / "data", "train", 1, 64)
    rows = source(folder, "train")
    rows["categories"][0]["name"] = name
    (folder / layout.instances("train")).write_text(json.dumps(rows))
    with pytest.raises(ValueError, match="name of a category"):
        export(folder, "yolo", tmp_path / "out")


def test_the_command_exports(data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from hazard_ms.cli.perception import export as command

    assert command(data, "coco", tmp_path / "deep" / "out") == 0
    assert "3 pictures" in capsys.readouterr().out
