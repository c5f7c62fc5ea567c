"""What the training of the small detector begins with, what a step draws, and what it counts."""

from __future__ import annotations

import json
import math
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from safetensors.torch import save_file

from hazard_ms.perception.detectors.small_network import SmallNetwork
from hazard_ms.perception.layout import category_ids
from hazard_ms.perception.training.drawing import Drawing, state_of
from hazard_ms.perception.training.options import TrainOptions
from hazard_ms.perception.training.pictures import read
from hazard_ms.perception.training.run import student, train
from hazard_ms.perception.training.small import of_things
from tests.worlds.drawn_pictures import USUAL, draw

CLASSES = ["apple", "box"]
APPLE = category_ids()["apple"]


@pytest.mark.parametrize(
    ("changed", "state"),
    [
        ({}, "dry, not burnt"),
        ({"status": "burning", "wet": True}, "burning"),
        ({"status": "burnt", "speed_mps": 1.0}, "burnt"),
        ({"wet": True, "submerged": 0.51, "floating": True}, "more than half under water"),
        ({"wet": True, "submerged": 0.5, "floating": True, "speed_mps": 1.0}, "floating"),
        ({"wet": True, "speed_mps": 1.0}, "moving"),
        ({"wet": True}, "wet"),
        ({"status": None, "wet": None, "submerged": None, "floating": None, "speed_mps": None}, "dry, not burnt"),
    ],
)
def test_the_state_of_a_thing_is_the_first_that_fits(changed: dict[str, Any], state: str) -> None:
    assert state_of({"attributes": {**USUAL, **changed}}) == state


def test_a_thing_of_which_nothing_is_told_is_dry() -> None:
    assert state_of({}) == state_of({"attributes": None}) == "dry, not burnt"


def test_things_of_rare_categories_and_states_are_drawn_more_often(tmp_path: Path) -> None:
    """One burning apple among many: by 1 / sqrt(n) of its group it gets sqrt(n) times the chance of another apple."""
    pictures = read([draw(tmp_path / "data", "train", 40, 96, edge=(17, 20))], "train")
    apples = [(k, t) for k, p in enumerate(pictures) for t in p.things if t["category_id"] == APPLE]
    k, burning = apples[0]
    hot = {**burning, "attributes": {**USUAL, "status": "burning"}}
    pictures[k] = replace(pictures[k], things=tuple(hot if t is burning else t for t in pictures[k].things))
    drawing = Drawing(pictures, CLASSES, 64)
    chances = np.diff(drawing._chances, prepend=0.0)
    of_apples = [c for c, (_, t) in zip(chances, drawing._things, strict=True) if t["category_id"] == APPLE]
    others = sorted(of_apples)[:-1]
    assert max(of_apples) / others[0] == pytest.approx(math.sqrt(len(apples) - 1), rel=1e-6)
    assert others[0] == pytest.approx(others[-1])


def test_small_things_are_drawn_less_often(tmp_path: Path) -> None:
    """A box of 4 x 4 pixels has the least share of the chance, one of 8 x 8 the half of one of 16 x 16 or more."""
    (picture, *_) = read([draw(tmp_path / "data", "train", 1)], "train")
    thing = picture.things[0]
    edges = (4, 8, 16, 32)
    things = tuple({**thing, "bbox": [0, 0, edge, edge]} for edge in edges)
    chances = np.diff(Drawing([replace(picture, things=things)], CLASSES, 64)._chances, prepend=0.0)
    assert chances / chances[-1] == pytest.approx([0.25, 0.5, 1.0, 1.0])


def test_crops_have_several_scales_and_show_what_they_are_cut_around(tmp_path: Path) -> None:
    """The focal length of a crop is that of the picture times its scale, from one half to one and a half."""
    pictures = read([draw(tmp_path / "data", "train", 4, 256, edge=(16, 40))], "train")
    drawing = Drawing(pictures, CLASSES, 64)
    focal = float(pictures[0].intrinsic()[0, 0])
    crops = [drawing.crop(np.random.default_rng([7, k])) for k in range(200)]
    scales = np.array([crop.intrinsic[0, 0] / focal for crop in crops])
    assert all(crop.depth.shape == (64, 64) and crop.rgb.shape == (64, 64, 3) for crop in crops)
    assert 0.49 < scales.min() < 0.6 and 1.35 < scales.max() < 1.53
    assert 0.25 < (np.abs(scales - 1.0) < 1e-6).mean() < 0.55
    assert np.mean([bool((crop.label > 0).any()) for crop in crops]) > 0.85


def test_a_crop_is_never_larger_than_its_picture(tmp_path: Path) -> None:
    pictures = read([draw(tmp_path / "data", "train", 2, 96)], "train")
    drawing = Drawing(pictures, CLASSES, 160)
    assert drawing.sides == (96, 96)
    sides = Counter(drawing.crop(np.random.default_rng(k)).depth.shape for k in range(30))
    assert set(sides) == {(96, 96)}


def test_whole_things_count_by_the_root_of_their_area_until_they_are_large() -> None:
    """400, 1024 and 16 pixels with chances 0.5, 0.5 and 0.25, by hand: weights 1, 1 and 1 / 4; a speck is none."""
    thing = torch.zeros(2, 32, 64, dtype=torch.int64)
    right = torch.full((2, 32, 64), 0.9)
    thing[0, :20, :20], right[0, :20, :20] = 3, 0.5
    thing[0, :, 32:], right[0, :, 32:48], right[0, :, 48:] = 2, 0.2, 0.8
    thing[1, :4, :2], right[1, :4, :2] = 3, 0.1
    thing[1, :4, 2:4], right[1, :4, 2:4] = 3, 0.4
    thing[1, 10, 10:17], right[1, 10, 10:17] = 1, 0.001  # seven pixels
    expected = (2 * math.log(2) + math.log(4) / 4) / 2.25
    assert float(of_things(right.flatten(), thing)) == pytest.approx(expected, rel=1e-5)
    assert float(of_things(right.flatten(), torch.zeros_like(thing))) == 0.0


def test_a_small_network_begins_with_the_weights_of_another(tmp_path: Path) -> None:
    """Of one that told boxes and books: boxes keep their weights, apples are new, and so are parts that it lacked."""
    data = draw(tmp_path / "data" / "HazardFire-v1", "train", 6, 64)
    torch.manual_seed(3)
    before = {
        k: v for k, v in SmallNetwork(4).state_dict().items() if not k.startswith(("afar.", "kinds.", "down.3.3."))
    }
    path = tmp_path / "before.safetensors"
    save_file(before, path)
    path.with_suffix(".json").write_text(json.dumps({"network": "small", "classes": ["box", "book"]}))
    asked = TrainOptions((data,), tmp_path / "out", model="small", weights=str(path), batch=2, size=64)
    state = student(asked, read((data,), "train")).network.state_dict()
    for name, value in before.items():
        if not name.startswith("logits."):
            assert torch.equal(state[name].cpu(), value), name
    kept = {0: 0, 2: 1, 3: 3}  # structure, box of apple and box, and others
    for row, old in kept.items():
        assert torch.equal(state["logits.weight"][row].cpu(), before["logits.weight"][old])
    assert all(not torch.equal(state["logits.weight"][1].cpu(), row) for row in before["logits.weight"])
    assert train(replace(asked, steps=1)) == 0
    path.unlink()
    assert train(replace(asked, steps=2)) == 0  # goes on without them
    save_file({"weight": torch.zeros(3)}, path)
    with pytest.raises(ValueError, match="weights must be those of a small network with 4 classes, got .*before"):
        train(replace(asked, output=tmp_path / "other"))
