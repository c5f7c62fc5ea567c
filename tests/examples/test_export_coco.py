"""The example that reads labelled pictures without any code of ours."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from hazard_ms.perception import layout
from hazard_ms.perception.coco import box_of, run_lengths
from tests.worlds.registering import loaded

EXAMPLE = Path(__file__).parents[2] / "examples" / "export_coco.py"


@pytest.fixture(scope="module")
def example() -> Iterator[Any]:
    with loaded(EXAMPLE) as module:
        yield module


def test_what_the_file_holds_is_counted_and_handed_to_torchvision(
    example: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mask = np.zeros((40, 50), bool)
    mask[10:30, 5:20] = True
    states = [("burning", 0.0), ("normal", 0.4), ("normal", 0.0)]
    rows = [
        {
            "id": k + 1,
            "image_id": 1,
            "category_id": 3,
            "segmentation": run_lengths(mask),
            "bbox": box_of(mask),
            "area": 300,
            "iscrowd": 0,
            "attributes": {"status": status, "submerged": submerged},
        }
        for k, (status, submerged) in enumerate(states)
    ]
    images = [{"id": 1, "file_name": "picture.jpg", "height": 40, "width": 50}]
    path = tmp_path / "instances_train.json"
    path.write_text(json.dumps({"images": images, "annotations": rows, "categories": layout.categories()}))
    cv2.imwrite(str(tmp_path / "picture.jpg"), np.full((40, 50, 3), 90, np.uint8))
    example.main([str(path)])
    out = capsys.readouterr().out
    assert "burning: 1" in out and "under water: 1" in out and "normal: 1" in out
    assert "picture (3, 40, 50), boxes (3, 4), masks (3, 40, 50)" in out
