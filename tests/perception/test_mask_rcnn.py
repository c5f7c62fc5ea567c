"""Mask R-CNN from a user's files: what it finds by its own weights, and files that are refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from hazard_ms.perception.detectors.mask_rcnn import FIRST, RESNET18, MaskRcnn, network

CLASSES = ["bowl", "mug"]
SIDE = 64  # of a picture [pixels]


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A network that takes everything for a mug with the same score."""
    torch.manual_seed(0)
    made = network(RESNET18, 1 + len(CLASSES))
    made.roi_heads.box_predictor.cls_score.weight.data.zero_()
    made.roi_heads.box_predictor.cls_score.bias.data = torch.tensor([0.0, -9.0, 2.0])
    path = tmp_path_factory.mktemp("weights") / "mugs.pth"
    torch.save(made.state_dict(), path)
    path.with_suffix(".json").write_text(json.dumps({"network": RESNET18, "classes": CLASSES}))
    return path


def test_classes_scores_boxes_and_masks_are_those_of_the_network(weights: Path) -> None:
    rgb = np.random.default_rng(0).integers(0, 255, (SIDE, SIDE + 8, 3)).astype(np.uint8)
    found = MaskRcnn(str(weights)).detect(rgb, np.zeros((SIDE, SIDE + 8), np.float32))
    expected = np.exp(2.0) / (1.0 + np.exp(2.0) + np.exp(-9.0))  # softmax of the three biases
    assert found and all(d.category == "mug" and d.score == pytest.approx(expected, abs=1e-4) for d in found)
    for detection in found:
        left, top, right, bottom = detection.box
        assert 0 <= left < right <= SIDE + 8 and 0 <= top < bottom <= SIDE
        assert detection.mask.shape == (SIDE, SIDE + 8) and detection.mask.dtype == bool


def test_weights_may_be_safetensors(weights: Path, tmp_path: Path) -> None:
    from safetensors.torch import save_file

    save_file(torch.load(weights, weights_only=True), tmp_path / "mugs.safetensors")
    (tmp_path / "mugs.json").write_text(weights.with_suffix(".json").read_text())
    MaskRcnn(str(tmp_path / "mugs.safetensors"))


@pytest.mark.parametrize(
    ("recipe", "told"),
    [
        (None, "there is no file .*mugs.json"),
        ({"network": "yolo", "classes": CLASSES}, "must hold the network maskrcnn_resnet50_fpn_v2 or .*got .*yolo"),
        ({"network": RESNET18}, "must hold the network .* and its classes"),
        ({"network": RESNET18, "classes": ["bowl", "bowl"]}, "must be a list of distinct categories"),
        ({"network": RESNET18, "classes": ["bowl", "unicorn"]}, "a class in .* must be one of"),
        ({"network": RESNET18, "classes": ["bowl", "mug", "apple"]}, "weights must fit the network resnet18_fpn"),
    ],
)
def test_recipes_that_cannot_be_are_refused(weights: Path, tmp_path: Path, recipe: object, told: str) -> None:
    path = tmp_path / "mugs.pth"
    path.symlink_to(weights)
    if recipe is not None:
        path.with_suffix(".json").write_text(json.dumps(recipe))
    with pytest.raises(ValueError, match=told):
        MaskRcnn(str(path))


def test_code_in_a_file_of_weights_is_not_run(weights: Path, tmp_path: Path) -> None:
    path = tmp_path / "mugs.pth"
    torch.save({"weight": Path("/")}, path)  # an object, which is made by code
    path.with_suffix(".json").write_text(weights.with_suffix(".json").read_text())
    with pytest.raises(ValueError, match="weights must be a file .pth or .safetensors"):
        MaskRcnn(str(path))


def test_batch_normalisation_of_the_older_network_never_learns() -> None:
    """As where torchvision fine-tunes its weights for COCO; with their variances, as low as 1e-7, 1e-5 would count."""
    from torchvision.models import detection

    torch.manual_seed(0)
    theirs = detection.maskrcnn_resnet50_fpn(weights=None, weights_backbone=None, num_classes=3)
    norms = [m for m in theirs.modules() if isinstance(m, torch.nn.BatchNorm2d)]
    for norm in norms:
        norm.eps = 0.0
        norm.running_mean.normal_(0.0, 0.1)
        norm.running_var.uniform_(0.5, 2.0)
    ours = network(FIRST, 3)
    ours.load_state_dict(theirs.state_dict())
    rgb = torch.rand(1, 3, SIDE, SIDE)
    ours.train()
    theirs.eval()
    for mine, other in zip(ours.backbone(rgb).values(), theirs.backbone(rgb).values(), strict=True):
        torch.testing.assert_close(mine, other, rtol=1e-4, atol=1e-4)
    kept = ours.state_dict()
    assert all(torch.equal(kept[k], v) for k, v in theirs.state_dict().items() if "running" in k)
    learning = sum(p.requires_grad for p in ours.parameters())
    assert learning == sum(p.requires_grad for p in theirs.parameters()) - 2 * len(norms)
