"""Trainings of detectors: what they write, that they go on as if nothing had interrupted them, and what is refused."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import torch

from hazard_ms.perception.detectors.mask_rcnn import RESNET18, MaskRcnn, network
from hazard_ms.perception.layout import category_ids
from hazard_ms.perception.training.mask_rcnn import MaskRcnnStudent, begun
from hazard_ms.perception.training.options import TrainOptions
from hazard_ms.perception.training.pictures import read
from hazard_ms.perception.training.run import student, train
from hazard_ms.perception.training.validation import spread
from hazard_ms.sensing.detection.perception import perception
from tests.worlds.drawn_pictures import draw

SIDE = 64  # of a picture [pixels]


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six pictures to learn from and two to be scored on."""
    folder = tmp_path_factory.mktemp("data") / "HazardFire-v1"
    draw(folder, "test", 2, SIDE, seed=1)
    return draw(folder, "train", 6, SIDE)


def options(data: Path, output: Path, other: dict[str, Any] | None = None, **more: Any) -> TrainOptions:
    usual: dict[str, Any] = {"model": "small", "steps": 4, "every": 2, "batch": 2, "size": 64, "validate": (data,)}
    return TrainOptions(**{"data": (data,), "output": output, **usual, **more, **(other or {})})


@pytest.mark.parametrize("model", ["small", "mask_rcnn"])
def test_a_training_writes_a_detector_and_its_curve(
    model: str, data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    steps = 3
    assert train(options(data, tmp_path, model=model, steps=steps, every=2)) == 0
    rows = list(csv.DictReader((tmp_path / f"{model}.csv").open()))
    assert [float(row["step"]) for row in rows] == [2.0, 3.0]
    for row in rows:
        parts = [float(row[name]) for name in row if name.startswith("loss ")]
        assert float(row["loss"]) == pytest.approx(sum(parts), rel=1e-4)
        assert 0.0 <= float(row["box AP50"]) <= 1.0
    assert ElementTree.parse(tmp_path / f"{model}.svg").getroot().tag.endswith("svg")
    told = capsys.readouterr().out
    assert "6 pictures, 2 categories, 3 steps" in told and "| dry, not burnt |" in told and "pixels |" in told
    path = tmp_path / f"{model}.safetensors"
    (command,) = re.findall(r"^hazard-ms evaluate .*--perception (.*)$", told, re.MULTILINE)
    assert command == f"{model}:{path}"
    detector = perception(command).detector
    assert detector is not None
    (picture, *_) = read((data,), "test")
    detector.aim(picture.intrinsic(), picture.cam2world())
    for found in detector.detect(picture.rgb(), picture.depth()):
        assert found.category in ("apple", "box") and found.mask.shape == (SIDE, SIDE)
    recipe = json.loads(path.with_suffix(".json").read_text())
    assert recipe["step"] == steps and recipe["classes"] == ["apple", "box"]


@pytest.mark.parametrize("model", ["small", pytest.param("mask_rcnn", marks=pytest.mark.long)])
def test_an_interrupted_training_ends_with_the_same_weights(model: str, data: Path, tmp_path: Path) -> None:
    """The rate of learning depends on how many steps there will be, so it is the loop that is interrupted."""
    whole = options(data, tmp_path / "whole", model=model, validate=(), every=1, steps=3)
    train(whole)
    halves = replace(whole, output=tmp_path / "halves")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hazard_ms.perception.training.run.Run._check", _stopped_after(2))
        with pytest.raises(KeyboardInterrupt):
            train(halves)
    train(halves)
    one, other = (torch.load(f / f"{model}.training", weights_only=True) for f in (whole.output, halves.output))
    assert one["step"] == other["step"] == 3
    for name, value in one["student"]["network"].items():
        assert torch.equal(value, other["student"]["network"][name]), name
    shipped = [(f / f"{model}.safetensors").read_bytes() for f in (whole.output, halves.output)]
    assert shipped[0] == shipped[1]


def _stopped_after(step: int) -> Any:
    """`Run._check`, at the end of which the process is interrupted once so many steps are done."""
    from hazard_ms.perception.training.run import Run

    real = Run._check

    def check(self: Run, steps: int, minutes: float) -> None:
        real(self, steps, minutes)
        if self._step == step:
            raise KeyboardInterrupt

    return check


def test_a_finished_training_goes_on_with_more_steps_and_not_with_another_seed(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first = options(data, tmp_path, validate=(), steps=1)
    train(first)
    train(replace(first, steps=2))
    assert "resumes at step 1" in capsys.readouterr().out
    with pytest.raises(ValueError, match="must belong to the training .* give another folder, or delete it"):
        train(replace(first, seed=1))
    (tmp_path / "small.training").write_bytes(b"no state")
    with pytest.raises(ValueError, match="must be the state of a training.*; delete it"):
        train(first)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"data": ()}, "DATA must be at least one dataset"),
        ({"data": (Path("nowhere"),)}, "folder must be a dataset of `hazard-ms perception capture`, got nowhere"),
        ({"split": "hard"}, "split must be one of test, train in"),
        ({"minutes": float("nan")}, "minutes must be positive"),
        ({"batch": 0}, "batch must be"),
        ({"size": 100}, "size must be a multiple of 32 for the model small, got 100"),
        ({"weights": "coco.pth"}, "weights must be a file .pth or .safetensors, got coco.pth"),
        ({"model": "mask_rcnn", "weights": "coco.pth"}, "weights must be a file .pth or .safetensors, got coco.pth"),
    ],
)
def test_options_that_cannot_be_are_refused(data: Path, tmp_path: Path, given: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        train(options(data, tmp_path / "output", given))
    assert not (tmp_path / "output").exists()


@pytest.mark.long
def test_weights_of_a_network_with_other_classes_are_taken_but_for_their_heads(data: Path, tmp_path: Path) -> None:
    """As COCO's weights have 91 classes; the network is the one that they fit."""
    torch.manual_seed(1)
    coco = network(RESNET18, 91)
    path = tmp_path / "coco.pth"
    torch.save(coco.state_dict(), path)
    assert begun(path, None)[0] == RESNET18
    student = MaskRcnnStudent(read((data,), "train"), 2, SIDE, path)
    state = student.network.state_dict()
    given = {name: value for name, value in coco.state_dict().items() if state[name].shape == value.shape}
    assert len(given) == len(state) - 6  # weights and biases of classes, boxes and masks
    assert all(torch.equal(state[name].cpu(), value) for name, value in given.items())
    torch.save({"weight": torch.zeros(3)}, path)
    with pytest.raises(ValueError, match="weights must be those of torchvision's Mask R-CNN"):
        begun(path, None)


def test_boxes_labels_and_masks_stay_together_in_the_mirror(data: Path) -> None:
    (picture, *_) = pictures = read((data,), "train")
    learner = MaskRcnnStudent(pictures, 2, SIDE, None)
    mirrored = set()
    for seed in range(8):
        torch.manual_seed(seed)
        colours, target = learner.example(picture)
        assert colours.dtype == torch.float32 and 0.0 <= float(colours.min()) <= float(colours.max()) <= 1.0
        assert len(target["labels"]) == len(target["masks"]) == len(picture.things)
        for box, mask in zip(target["boxes"].tolist(), target["masks"], strict=True):
            y, x = np.nonzero(mask.numpy())
            assert box == [x.min(), y.min(), x.max() + 1, y.max() + 1]
        for label, mask in zip(target["labels"].tolist(), target["masks"], strict=True):
            red, _, blue = colours[:, mask].mean(1).tolist()
            assert learner.classes[label - 1] == ("apple" if red > blue else "box")
        mirrored.add(tuple(target["boxes"][0].tolist()))
    assert len(mirrored) == 2


@pytest.mark.parametrize("model", ["small", "mask_rcnn"])
def test_a_training_does_not_go_on_with_things_of_other_kinds(model: str, data: Path, tmp_path: Path) -> None:
    """A dataset of apples alone, to which boxes are added."""
    asked = options(data, tmp_path / "out", model=model, validate=(), steps=1)
    pictures = read((data,), "train")
    apple = category_ids()["apple"]
    apples = [replace(p, things=tuple(t for t in p.things if t["category_id"] == apple)) for p in pictures]
    begun_with = student(asked, apples)
    assert begun_with.classes == ["apple"]
    with pytest.raises(
        ValueError, match="DATA must hold only the categories that the training began with, got box as well"
    ):
        student(asked, pictures, {"recipe": begun_with.recipe()})


def test_a_training_resumes_without_the_weights_that_it_began_with(data: Path, tmp_path: Path) -> None:
    """And pictures keep the size with which those weights were learned."""
    train(options(data, tmp_path / "first", model="mask_rcnn", validate=(), steps=1, every=1))
    weights = tmp_path / "first" / "mask_rcnn.safetensors"
    assert begun(weights, None)[2] == 64 and begun(weights, 96)[2] == 96
    fine = {"weights": str(weights), "size": None}
    second = options(data, tmp_path / "second", fine, model="mask_rcnn", validate=(), steps=1)
    train(second)
    assert json.loads((tmp_path / "second" / "mask_rcnn.json").read_text())["size"] == 64
    weights.unlink()
    train(replace(second, steps=2))


def test_pictures_of_several_sizes_are_cropped_to_the_smallest(data: Path, tmp_path: Path) -> None:
    larger = draw(tmp_path / "larger", "train", 2, 2 * SIDE)
    train(options(data, tmp_path / "out", {"data": (data, larger), "size": 96}, validate=(), batch=8, steps=2))


def test_pictures_to_look_at_are_spread_evenly() -> None:
    numbers: Any = list(range(10))
    assert spread(numbers, 5) == [0, 2, 4, 6, 8]
    assert spread(numbers, 50) == numbers


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_mask_r_cnn_from_nothing_learns_eight_pictures_by_heart(tmp_path: Path) -> None:
    data = draw(tmp_path / "data", "train", 8, 128, edge=(14, 40))
    asked = TrainOptions((data,), tmp_path, validate=(data,), validate_split="train", steps=200, every=25, size=128)
    train(asked)
    rows = list(csv.DictReader((tmp_path / "mask_rcnn.csv").open()))
    losses = [float(row["loss"]) for row in rows]
    assert losses[7] < losses[0] / 2
    assert float(rows[-1]["box AP50"]) >= 0.8 and float(rows[-1]["mask AP50"]) >= 0.8


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_the_small_detector_learns_eight_pictures_by_heart(tmp_path: Path) -> None:
    data = draw(tmp_path / "data", "train", 8, 128, edge=(6, 40))
    asked = TrainOptions(
        (data,), tmp_path, model="small", validate=(data,), validate_split="train", steps=100, every=50
    )
    train(asked)
    last = list(csv.DictReader((tmp_path / "small.csv").open()))[-1]
    assert float(last["mask AP50"]) >= 0.8


def test_the_network_of_a_training_without_weights_is_the_smaller_one(data: Path) -> None:
    student = MaskRcnnStudent(read((data,), "train"), 2, SIDE, None)
    assert student.recipe()["network"] == RESNET18
    assert isinstance(student.detector(), MaskRcnn)
