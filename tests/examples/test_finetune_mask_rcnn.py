"""The example that fine-tunes Mask R-CNN with torchvision alone."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import torch

from hazard_ms.perception.detectors.mask_rcnn import MaskRcnn
from tests.worlds.drawn_pictures import draw
from tests.worlds.registering import loaded

EXAMPLE = Path(__file__).parents[2] / "examples" / "finetune_mask_rcnn.py"


@pytest.fixture(scope="module")
def example() -> Iterator[Any]:
    with loaded(EXAMPLE) as module:
        yield module


def test_pictures_come_with_labels_from_one_on_and_masks(example: Any, tmp_path: Path) -> None:
    data = draw(tmp_path / "data", "train", 2, 64)
    pictures, names = example.training_set(data / "instances_train.json")
    assert names == ["apple", "box"]
    for k in range(len(pictures)):
        picture, target = pictures[k]
        assert picture.dtype == torch.float32 and float(picture.max()) <= 1.0
        for label, mask in zip(target["labels"].tolist(), target["masks"].bool(), strict=True):
            red, _, blue = picture[:, mask].mean(1).tolist()
            assert (names[label - 1] == "apple") == (red > blue)


@pytest.mark.long
def test_what_it_writes_is_a_detector(example: Any, tmp_path: Path) -> None:
    data = draw(tmp_path / "data", "train", 2, 64)
    path = tmp_path / "detector.pth"
    words = [str(data / "instances_train.json"), "-o", str(path), "--steps", "2", "--batch", "1", "--size", "64"]
    assert len(example.main(words)) == 2
    MaskRcnn(str(path))
