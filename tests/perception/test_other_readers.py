"""Readers of COCO data that are not ours, unchanged, read what is captured."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
import supervision
from pycocotools import mask as tools

from hazard_ms.perception import layout
from hazard_ms.perception.exports.export import export

pytestmark = pytest.mark.render


def test_supervision_has_the_same_boxes_masks_and_categories(dataset: Path) -> None:
    path = dataset / layout.instances("train")
    rows = json.loads(path.read_text())
    names = {row["id"]: row["name"] for row in rows["categories"]}
    read = supervision.DetectionDataset.from_coco(str(dataset), str(path), force_masks=True)
    assert len(read) == len(rows["images"])
    compared = 0
    for image in rows["images"]:
        found = read.annotations[str((dataset / image["file_name"]).resolve())]
        wanted = [row for row in rows["annotations"] if row["image_id"] == image["id"]]
        assert [read.classes[k] for k in found.class_id] == [names[row["category_id"]] for row in wanted]
        for box, mask, row in zip(found.xyxy, found.mask, wanted, strict=True):
            left, top, width, height = row["bbox"]
            assert box.tolist() == [left, top, left + width, top + height]
            assert np.array_equal(mask, tools.decode(row["segmentation"]).astype(bool))
            compared += 1
    assert compared == len(rows["annotations"]) > 50


def test_supervision_draws_its_masks(dataset: Path) -> None:
    path = dataset / layout.instances("train")
    read = supervision.DetectionDataset.from_coco(str(dataset), str(path), force_masks=True)
    name, image, found = next(one for one in read if len(one[2]))
    drawn = supervision.MaskAnnotator().annotate(image.copy(), found)
    assert np.array_equal(image, cv2.imread(name))
    changed = (drawn != image).any(-1)
    assert changed[found.mask.any(0)].mean() > 0.9 and not changed[~found.mask.any(0)].any()


def test_label_files_of_yolo_give_back_captured_masks(dataset: Path, tmp_path: Path) -> None:
    """One part without holes exactly; joined parts, which gain a line of one pixel, are few of all pixels."""
    export(dataset, "yolo", tmp_path / "out")
    rows = json.loads((dataset / layout.instances("train")).read_text())
    places = (str(tmp_path / "out" / kind / "train") for kind in ("images", "labels"))
    read = supervision.DetectionDataset.from_yolo(*places, str(tmp_path / "out" / "data.yaml"), force_masks=True)
    shared = covered = 0
    for image in rows["images"]:
        found = read.annotations[str(tmp_path / "out" / "images" / "train" / f"{image['id']:012d}.jpg")]
        wanted = [row for row in rows["annotations"] if row["image_id"] == image["id"]]
        for mask, row in zip(found.mask, wanted, strict=True):
            true = tools.decode(row["segmentation"]).astype(bool)
            parts = cv2.connectedComponents(true.astype(np.uint8))[0] - 1
            ways = cv2.connectedComponents(1 - np.pad(true.astype(np.uint8), 1), connectivity=4)[0] - 1
            assert np.array_equal(mask, true) or parts > 1 or ways > 1
            shared, covered = shared + int((mask & true).sum()), covered + int((mask | true).sum())
    assert shared / covered > 0.97  # 0.998 in pictures of 512 pixels, where lines are small beside things
