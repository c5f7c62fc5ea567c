"""Scores of a detector on captured pictures that it was not trained on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from hazard_ms.perception.coco import run_lengths
from hazard_ms.perception.layout import category_ids
from hazard_ms.perception.training.pictures import Picture
from hazard_ms.sensing.detection.detector import Detector


def results_of(detector: Detector, pictures: Sequence[Picture]) -> list[dict[str, Any]]:
    """Detections of `detector` in COCO's results format; pictures are numbered from 1 in their order."""
    numbers, found = category_ids(), []
    for number, picture in enumerate(pictures, start=1):
        detector.aim(picture.intrinsic(), picture.cam2world())
        for one in detector.detect(picture.rgb(), picture.depth()):
            if one.mask.any():
                left, top, right, bottom = one.box
                found.append(
                    {
                        "image_id": number,
                        "category_id": numbers[one.category],
                        "score": one.score,
                        "bbox": [left, top, right - left, bottom - top],
                        "segmentation": run_lengths(one.mask),
                    }
                )
    return found


def spread(pictures: Sequence[Picture], most: int) -> list[Picture]:
    """Some of the pictures, `most` or fewer, taken evenly from all of them."""
    count = min(most, len(pictures))
    return [pictures[k * len(pictures) // count] for k in range(count)]
