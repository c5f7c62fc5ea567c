"""The check of a dataset: each way of spoiling one is found."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import pytest

from hazard_ms.perception import layout
from hazard_ms.perception.check import check, faults

pytestmark = pytest.mark.render
INSTANCES = layout.instances("train")


@pytest.fixture
def copied(dataset: Path, tmp_path: Path) -> Path:
    shutil.copytree(dataset, tmp_path / "copy")
    return tmp_path / "copy"


def edited(folder: Path, change: Callable[[Any], None]) -> None:
    path = folder / INSTANCES
    rows = json.loads(path.read_text())
    change(rows)
    path.write_text(json.dumps(rows))


def lose(folder: Path) -> None:
    next(folder.rglob("depth/*.png")).unlink()


def add(folder: Path) -> None:
    (next(folder.rglob("rgb")) / "9999.jpg").write_bytes(b"")


def repaint(folder: Path) -> None:
    """The ids show one thing more."""
    path = sorted(folder.rglob("ids/*.png"))[0]
    ids = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert ids is not None
    ids[:20, :20] = 60000
    cv2.imwrite(str(path), ids)


def move_box(folder: Path) -> None:
    def change(rows: Any) -> None:
        rows["annotations"][0]["bbox"][0] += 1

    edited(folder, change)


def double(folder: Path) -> None:
    edited(folder, lambda rows: rows["images"].append({**rows["images"][0], "id": 7}))


def same_id(folder: Path) -> None:
    edited(folder, lambda rows: rows["annotations"].append(rows["annotations"][0]))


def second_split(folder: Path) -> None:
    shutil.copy(folder / INSTANCES, folder / layout.instances("test"))


def empty_sums(folder: Path) -> None:
    (folder / layout.SUMS).write_text("nothing\n")


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (lose, "it is missing"),
        (add, "it is not in SHA256SUMS"),
        (repaint, "its annotations are of the things"),
        (repaint, "its checksum is not that"),
        (move_box, "is not the tight one"),
        (double, "another picture shows the same frame from the same place"),
        (same_id, "two annotations have one id"),
        (second_split, "its room kitchen_a is in instances_test.json, too"),
        (empty_sums, "must hold a checksum and a path"),
    ],
)
def test_what_is_spoilt_is_found(copied: Path, spoil: Callable[[Path], None], told: str) -> None:
    spoil(copied)
    assert any(told in fault for fault in faults(copied))


def test_the_check_ends_with_what_it_found(copied: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert check(copied) == 0
    assert "12 pictures, no faults" in capsys.readouterr().out
    lose(copied)
    assert check(copied) == 1
    assert "2 faults" in capsys.readouterr().out, "of the checksums, and of the picture"


def test_a_folder_that_is_no_dataset_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="must be a dataset"):
        check(tmp_path)
