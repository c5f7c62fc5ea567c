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
