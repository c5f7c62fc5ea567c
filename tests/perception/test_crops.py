"""Crops of pictures, of several scales, and what is to be learned of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from hazard_ms.perception.detectors.small_network import features
from hazard_ms.perception.training.crops import cut, depth_at, mirrored
from hazard_ms.perception.training.pictures import read
from tests.worlds.drawn_pictures import draw

CLASSES = ["apple", "box"]


def test_a_crop_tells_class_middle_and_weight_of_each_pixel(tmp_path: Path) -> None:
    (picture, *_) = read([draw(tmp_path / "data", "train", 2)], "train")
    numbers = {name: k for k, name in enumerate(CLASSES, start=1)}
    crop, ids = cut(picture, numbers, (8, 32), (64, 64), (64, 64)), picture.ids()[32:96, 8:72]
    for index, thing in enumerate(("apple", "box", "apple", "box")):
        mask = ids == index + 1
        if mask.any():
            rows, columns = np.nonzero(mask)
            assert set(crop.label[mask]) == {numbers[thing]}
            assert crop.offset[0][mask] + columns == pytest.approx(columns.mean(), abs=1e-3)
            assert crop.offset[1][mask] + rows == pytest.approx(rows.mean(), abs=1e-3)
    assert set(crop.label[ids == 0]) == {0}
    given = [torch.from_numpy(np.asarray(part))[None] for part in crop[:4]]
    floor = features(*given)[0, 4].numpy()[(ids == 0) & (crop.depth > 0)]
    assert floor == pytest.approx(0.0, abs=2e-3)  # the camera of the crop is right
    twice = mirrored(mirrored(crop))
    assert all(np.allclose(a, b) for a, b in zip(twice, crop, strict=True))
    flipped = [torch.from_numpy(np.asarray(part))[None] for part in mirrored(crop)[:4]]
    assert torch.allclose(features(*flipped), features(*given).flip(-1), atol=1e-4)


@pytest.mark.parametrize("side", [48, 112])
def test_a_crop_of_another_scale_shows_the_same_places(tmp_path: Path, side: int) -> None:
    """The floor stays level, and the middle of each thing stays where it was in the picture, whatever the scale."""
    (picture, *_) = read([draw(tmp_path / "data", "train", 1)], "train")
    numbers, corner, window = {name: k for k, name in enumerate(CLASSES, start=1)}, (8, 32), (64, 64)
    crop = cut(picture, numbers, corner, window, (side, side))
    given = features(*(torch.from_numpy(np.asarray(part))[None] for part in crop[:4]))[0].numpy()
    floor = (crop.label == 0) & (crop.depth > 0)
    assert (np.abs(given[4][floor]) < 2e-3).mean() > 0.97  # the others are beside things, whose edges are blurred
    ids = picture.ids()[32:96, 8:72]
    rows, columns = np.indices(crop.label.shape)
    for number in np.unique(ids[ids > 0]).tolist():
        down, right = np.nonzero(ids == number)
        if len(down) < 40:
            continue
        middle = (right.mean() + 0.5) * side / 64 - 0.5, (down.mean() + 0.5) * side / 64 - 0.5
        near = np.hypot(crop.offset[0] + columns - middle[0], crop.offset[1] + rows - middle[1])[crop.label > 0]
        assert (near < 1.0).sum() > 0.5 * len(down) * (side / 64) ** 2


def test_depth_at_another_scale_keeps_planes_and_edges() -> None:
    """The nearness of a plane is linear over the picture; a step in depth stays a step, and nothing stays nothing."""
    columns = (np.arange(64, dtype=np.float32) + 0.5) / 64
    plane = np.tile(1.0 / (0.2 + 0.3 * columns), (64, 1))
    inner = slice(2, -2)
    for side in (40, 96):
        there = (np.arange(side, dtype=np.float32) + 0.5) / side
        made = depth_at(plane.astype(np.float32), (side, side))
        assert made[:, inner] == pytest.approx(np.tile(1.0 / (0.2 + 0.3 * there), (side, 1))[:, inner], rel=1e-4)
    step = np.where(columns < 0.5, 1.0, 3.0) * np.ones((64, 1), np.float32)
    step[:8] = 0.0
    assert set(np.unique(depth_at(step.astype(np.float32), (96, 96)))) == {0.0, 1.0, 3.0}
