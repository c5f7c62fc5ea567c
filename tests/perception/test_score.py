"""Average precision: of the truth itself, of boxes beside it, by groups; and files that are refused."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.perception import layout
from hazard_ms.perception.coco import box_of, run_lengths
from hazard_ms.perception.score import average_precision, read_results, score

SIDE = 64  # of a picture [pixels]


def thing(number: int, image: int, category: int, corner: tuple[int, int], edge: int, **state: Any) -> dict[str, Any]:
    """The annotation of a square."""
    mask = np.zeros((SIDE, SIDE), bool)
    mask[corner[1] : corner[1] + edge, corner[0] : corner[0] + edge] = True
    usual = {"status": "normal", "wet": False, "submerged": 0.0, "floating": False, "speed_mps": 0.0, "damaged": False}
    told = {**usual, "distance_m": 1.5, "pixels": edge**2, **state}
    return {
        "id": number,
        "image_id": image,
        "category_id": category,
        "segmentation": run_lengths(mask),
        "area": edge**2,
        "bbox": box_of(mask),
        "iscrowd": 0,
        "attributes": told,
    }


@pytest.fixture
def truth() -> dict[str, Any]:
    rows = [
        thing(1, 1, 1, (4, 4), 20),
        thing(2, 1, 2, (34, 30), 16, status="burning"),
        thing(3, 2, 1, (10, 10), 10, wet=True, submerged=0.75, distance_m=3.0),
        thing(4, 2, 1, (40, 40), 20),
    ]
    images = [{"id": k, "file_name": f"{k}.jpg", "width": SIDE, "height": SIDE} for k in (1, 2)]
    return {"info": {}, "images": images, "annotations": rows, "categories": layout.categories()}


def found_in(truth: dict[str, Any], shift: float = 0.0) -> list[dict[str, Any]]:
    """What a detector would find that knows the truth, its boxes moved by a `shift` of their width."""
    kept = ("image_id", "category_id", "segmentation")
    moved = [[r["bbox"][0] + shift * r["bbox"][2], *r["bbox"][1:]] for r in truth["annotations"]]
    rows = zip(truth["annotations"], moved, strict=True)
    return [{**{k: r[k] for k in kept}, "bbox": box, "score": 0.9} for r, box in rows]


def test_a_detector_that_finds_nothing_scores_nothing(truth: dict[str, Any]) -> None:
    assert average_precision(truth, [], "bbox") == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("kind", ["bbox", "segm"])
def test_the_truth_as_detections_is_perfect(truth: dict[str, Any], kind: str) -> None:
    assert average_precision(truth, found_in(truth), kind) == pytest.approx((1.0, 1.0, 1.0))


def test_boxes_beside_things_find_nothing(truth: dict[str, Any]) -> None:
    """By half their width: they share a third of what both cover, less than the half that AP50 asks for."""
    assert average_precision(truth, found_in(truth, 0.5), "bbox") == (0.0, 0.0, 0.0)
    assert average_precision(truth, found_in(truth, 0.25), "bbox")[1] == pytest.approx(1.0), "three fifths are enough"


def test_only_the_things_of_a_group_count_in_it(truth: dict[str, Any]) -> None:
    """A detector that misses what burns is perfect for all the rest."""
    found = [row for row in found_in(truth) if row["category_id"] != 2]
    assert average_precision(truth, found, "segm", lambda a: a["status"] == "burning") == (0.0, 0.0, 0.0)
    assert average_precision(truth, found, "segm", lambda a: a["wet"])[0] == pytest.approx(1.0)
    assert average_precision(truth, found, "segm")[0] == pytest.approx(0.5), "of two categories, one is found"


def test_a_detection_of_nothing_lowers_the_precision(truth: dict[str, Any]) -> None:
    wrong = {**found_in(truth)[0], "bbox": [50, 2, 8, 8], "score": 0.99}
    assert average_precision(truth, [*found_in(truth), wrong], "bbox")[0] < 1.0


@pytest.mark.parametrize("kind", ["bbox", "segm"])
def test_a_small_detection_of_nothing_costs_large_things_nothing(truth: dict[str, Any], kind: str) -> None:
    """As in COCO: it counts among things of its own area, from 0 to below 256 pixels."""
    mask = np.zeros((SIDE, SIDE), bool)
    mask[50:58, 2:10] = True
    wrong = {**found_in(truth)[0], "segmentation": run_lengths(mask), "bbox": box_of(mask), "score": 0.99}
    found = [*found_in(truth), wrong]
    assert average_precision(truth, found, kind, area=(256.0, float("inf")))[0] == pytest.approx(1.0)
    assert average_precision(truth, found, kind, area=(0.0, 256.0))[0] == pytest.approx(0.5), "one of two is a thing"
    assert average_precision(truth, found, kind, area=(0.0, 257.0))[0] == pytest.approx((0.5 + 1.0) / 2), "two kinds"


def test_the_tables_have_the_groups_that_there_are(truth: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / layout.instances("test")).write_text(json.dumps(truth))
    results = tmp_path / "found.json"
    results.write_text(json.dumps(found_in(truth)))
    told = score(tmp_path, results, "test")
    assert told.count("| all | 4 | 1.000 | 1.000 | 1.000 |") == 2, "boxes and masks"
    assert "| burning | 1 | 1.000" in told and "| more than half under water | 1 |" in told
    assert "| 2 to 4 m away | 1 |" in told and "| 256 to 1024 pixels | 3 |" in told and "| burnt |" not in told
    with pytest.raises(ValueError, match="split must be one of test"):
        score(tmp_path, results, "train")


@pytest.mark.parametrize(
    ("spoilt", "told"),
    [
        ({"image_id": 77}, "image_id must be the id of a picture"),
        ({"category_id": -5}, "category_id must be one of"),
        ({"score": float("nan")}, "numbers must be finite, got NaN"),
        ({"bbox": [1, 2, 3]}, "bbox must have 4 entries"),
        ({"bbox": [1, 2, -3, 4]}, "bbox must be left, top"),
        ({"segmentation": {"size": [9, 9], "counts": "0"}}, "segmentation must be run lengths of size"),
    ],
)
def test_bad_detections_are_named(truth: dict[str, Any], tmp_path: Path, spoilt: dict[str, Any], told: str) -> None:
    found = copy.deepcopy(found_in(truth))
    found[2] |= spoilt
    path = tmp_path / "found.json"
    path.write_text(json.dumps(found))
    with pytest.raises(ValueError, match=told) as refusal:
        read_results(path, truth)
    assert "entry 2 of" in str(refusal.value) or "NaN" in told


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"iscrowd": None}, r"annotations\[1\] of .* must have iscrowd, got none"),
        ({"id": 0}, "ids of annotations of .* must be positive and distinct, got 0"),
        ({"id": -3}, "must be positive and distinct, got -3"),
        ({"id": 1}, "must be positive and distinct, got 1"),
    ],
)
def test_ids_and_crowds_that_pycocotools_needs_are_asked_for(
    truth: dict[str, Any], tmp_path: Path, change: dict[str, Any], told: str
) -> None:
    """Pycocotools ignores a thing with the id 0, and one of two with the same id, without a word (cocoapi 442, 418)."""
    truth["annotations"][1] |= change
    (tmp_path / layout.instances("test")).write_text(json.dumps(truth))
    (tmp_path / "found.json").write_text(json.dumps(found_in(truth)))
    with pytest.raises(ValueError, match=told):
        score(tmp_path, tmp_path / "found.json", "test")


def test_the_command_scores_an_empty_list(
    truth: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / layout.instances("test")).write_text(json.dumps(truth))
    (tmp_path / "found.json").write_text("[]")
    assert main(["perception", "score", str(tmp_path), str(tmp_path / "found.json")]) == 0
    assert capsys.readouterr().out.count("| all | 4 | 0.000 | 0.000 | 0.000 |") == 2, "boxes and masks"


@pytest.mark.parametrize("text", ["", "{}", '{"annotations": []}', "[1]", '[{"image_id": 1}]'])
def test_files_that_hold_no_detections_are_refused(truth: dict[str, Any], tmp_path: Path, text: str) -> None:
    path = tmp_path / "found.json"
    path.write_text(text)
    with pytest.raises(ValueError, match="must (be|have)"):
        read_results(path, truth)
