"""RF-DETR-Seg: real loading code on random weights where the package is installed, and clear errors where not."""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms.perception.detectors import rf_detr
from hazard_ms.perception.detectors.rf_detr import LEAST_SCORE, RfDetr, load
from hazard_ms.sensing.detection.perception import parts, perception

CLASSES = ["apple", "bowl", "mug"]
NANO = "rfdetr_seg_nano"


def recipe(file: Path, **changed: Any) -> None:
    digest = hashlib.sha256(file.read_bytes()).hexdigest()
    row = {"network": NANO, "classes": CLASSES, "sha256": digest, **changed}
    file.with_suffix(".json").write_text(json.dumps(row))


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The smallest network with random weights, at half precision, and a head that is sure of mugs."""
    pytest.importorskip("rfdetr")
    from safetensors.torch import save_file

    torch.manual_seed(0)
    made = rf_detr.network(NANO, len(CLASSES)).model.model.state_dict()
    made["class_embed.bias"][:] = torch.tensor([-9.0, -9.0, 4.0, 4.0])  # the last one stands for nothing
    file = tmp_path_factory.mktemp("rf") / "rf.safetensors"
    save_file({k: v.half().contiguous() for k, v in made.items() if v.is_floating_point()}, file)
    recipe(file)
    return file


def test_a_user_s_weights_are_asked(weights: Path) -> None:
    made = perception(f"rf_detr:{weights},threshold=0.3")
    assert isinstance(made.detector, RfDetr) and made.threshold == 0.3
    rgb = np.random.default_rng(0).integers(0, 255, (96, 128, 3)).astype(np.uint8)
    found = made.detector.detect(rgb, np.ones((96, 128), np.float32))
    assert found and {d.category for d in found} == {"mug"}  # not the class that stands for nothing
    for detection in found:
        left, top, right, bottom = detection.box
        assert LEAST_SCORE <= detection.score <= 1.0
        assert -1 <= left <= right <= 129 and -1 <= top <= bottom <= 97
        assert detection.mask.shape == (96, 128) and detection.mask.dtype == bool
    again = made.detector.detect(rgb, np.ones((96, 128), np.float32))
    assert [d.box for d in again] == [d.box for d in found]


def test_the_weights_in_the_file_are_those_that_are_used(weights: Path) -> None:
    from safetensors.torch import load_file

    own = RfDetr(str(weights))._model.model.model.state_dict()
    for name, value in load_file(weights).items():
        assert torch.equal(own[name].cpu(), value.float()), name


def test_weights_of_another_number_of_classes_are_refused(weights: Path, tmp_path: Path) -> None:
    file = tmp_path / weights.name
    file.symlink_to(weights)
    recipe(file, classes=[*CLASSES, "table"])
    with pytest.raises(ValueError, match="weights must fit the network rfdetr_seg_nano"):
        RfDetr(str(file))


def plain(tmp_path: Path) -> Path:
    file = tmp_path / "rf.pth"
    torch.save({"weight": torch.zeros(2)}, file)
    recipe(file)
    return file


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"sha256": "0" * 64}, "weights must have the sha256 0000"),
        ({"sha256": None}, "must hold the sha256 of the weights"),
        ({"sha256": "nonsense"}, "must hold the sha256 of the weights"),
        ({"network": "rfdetr_seg_giant"}, "must hold the network rfdetr_seg_nano or"),
        ({"classes": ["unicorn"]}, "a class in"),
    ],
)
def test_files_that_do_not_belong_together_are_refused(tmp_path: Path, changed: dict[str, Any], words: str) -> None:
    file = plain(tmp_path)
    recipe(file, **changed)
    with pytest.raises(ValueError, match=words):
        RfDetr(str(file))


def test_without_the_package_one_is_told_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rfdetr", None)
    with pytest.raises(
        ValueError, match=r"perception rf_detr needs the package rfdetr .* pip install 'hazard_ms\[rfdetr\]'"
    ):
        RfDetr(str(plain(tmp_path)))


def test_weights_must_have_the_names_of_the_network_but_for_its_flags() -> None:
    network = torch.nn.BatchNorm1d(2)  # num_batches_tracked is no weight
    load(network, {k: v + 3.0 for k, v in network.state_dict().items() if v.is_floating_point()}, "it")
    assert network.weight.tolist() == [4.0, 4.0]
    with pytest.raises(ValueError, match="weights must fit it, got 1 names that differ, such as scale"):
        load(network, {**network.state_dict(), "scale": torch.zeros(2)}, "it")
    with pytest.raises(ValueError, match="weights must fit it, .* such as weight"):
        load(network, {"bias": torch.zeros(2), "running_mean": torch.zeros(2), "running_var": torch.zeros(2)}, "it")
    with pytest.raises(ValueError, match="weights must fit it"):
        load(network, {**network.state_dict(), "weight": torch.zeros(3)}, "it")


def test_it_is_registered_and_needs_a_file() -> None:
    with pytest.raises(ValueError, match="rf_detr:PATH"):
        parts("rf_detr")
