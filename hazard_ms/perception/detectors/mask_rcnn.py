"""Mask R-CNN as torchvision builds it, with weights from a file of the user's.

Beside the weights FILE.pth or FILE.safetensors stands FILE.json with the network and its classes:

    {"network": "maskrcnn_resnet50_fpn_v2", "classes": ["bowl", "mug", ...], "size": 800}

`size`, the shorter side to which the network brings pictures [pixels], may be left out.
Classes are the catalogue's categories, in the order in which the network numbers them from 1; 0 is the background.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.perception.detectors.weights import read_recipe, read_weights
from hazard_ms.sensing.detection.detector import Detection, Detector

RESNET18 = "resnet18_fpn"  # smaller, for pictures of 192 pixels
FIRST = "maskrcnn_resnet50_fpn"  # torchvision's older one
NETWORKS = ("maskrcnn_resnet50_fpn_v2", FIRST, RESNET18)
SIDE, LONGEST = 192, 2  # usual shorter side of its pictures [pixels], and longer sides as multiples of that at most
ANCHORS = ((8,), (16,), (32,), (64,), (128,))  # sides of its boxes to begin with, level by level [pixels] [ours]
RATIOS = (0.5, 1.0, 2.0)  # of their heights to their widths, as in torchvision
WIDTH, MASK_WIDTH = 256, 128  # of its heads, a quarter and half of those of the larger networks [ours]
POOLED = 7  # side of what torchvision's box heads look at [cells]
MODEST = {"rpn_post_nms_top_n_train": 500, "rpn_post_nms_top_n_test": 300, "box_batch_size_per_image": 128}  # [ours]
INSIDE = 0.5  # of a mask: a pixel with at least this much belongs to the thing [-]


class MaskRcnn(Detector):
    """A trained Mask R-CNN; it looks at colours only."""

    def __init__(self, path: str) -> None:
        """Load the weights at `path`. Raises ValueError for files that are missing or do not fit each other."""
        file = Path(path)
        recipe = read_recipe(file.with_suffix(".json"), NETWORKS)
        made = network(recipe["network"], 1 + len(recipe["classes"]), recipe.get("size"))
        try:
            made.load_state_dict(read_weights(file))
        except RuntimeError as error:
            told = str(error).splitlines()[0]
            raise ValueError(f"weights must fit the network {recipe['network']}, got {file}: {told:.200}") from None
        self._use(made, recipe["classes"])

    @classmethod
    def of(cls, network: Any, classes: list[str]) -> MaskRcnn:
        """The detector that asks `network`, whose classes from 1 on are the categories `classes`."""
        made = cls.__new__(cls)
        made._use(network, classes)
        return made

    def _use(self, network: Any, classes: list[str]) -> None:
        self._classes = classes
        self._device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
        self._network = network.to(self._device).eval()

    @torch.inference_mode()
    def detect(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        """Find things in the colours `rgb`, [H, W, 3]; the `depth`, [H, W] [m], is not looked at."""
        picture = torch.from_numpy(rgb).to(self._device).permute(2, 0, 1).float() / 255.0
        (found,) = self._network([picture])
        names = [self._classes[number - 1] for number in found["labels"].tolist()]
        masks = (found["masks"][:, 0] >= INSIDE).cpu().numpy()
        boxes = [tuple(box) for box in found["boxes"].tolist()]
        every = zip(names, found["scores"].tolist(), boxes, masks, strict=True)
        return [Detection(name, score, box, mask) for name, score, box, mask in every]


def network(name: str, classes: int, size: int | None = None) -> Any:
    """An untrained network called `name` for so many `classes`, the background included.

    It brings pictures to a shorter side of `size` [pixels]; if not given, of 192, larger networks of 800. The batch
    normalisation of FIRST never learns and divides by the variance alone, as when torchvision trained its weights.
    """
    import torchvision
    from torchvision.models import detection
    from torchvision.models.detection.anchor_utils import AnchorGenerator

    sides = {} if size is None else {"min_size": size, "max_size": LONGEST * size}
    if name == FIRST:
        frozen = partial(torchvision.ops.FrozenBatchNorm2d, eps=0.0)
        backbone = detection.backbone_utils.resnet_fpn_backbone(
            backbone_name="resnet50", weights=None, trainable_layers=5, norm_layer=frozen
        )
        return detection.MaskRCNN(backbone, classes, **sides)
    if name != RESNET18:
        return getattr(detection, name)(weights=None, weights_backbone=None, num_classes=classes, **sides)
    backbone = detection.backbone_utils.resnet_fpn_backbone(
        backbone_name="resnet18", weights=None, trainable_layers=5, norm_layer=torch.nn.BatchNorm2d
    )
    anchors = AnchorGenerator(ANCHORS, (RATIOS,) * len(ANCHORS))
    usual = {"min_size": SIDE, "max_size": LONGEST * SIDE, **sides}
    made = detection.MaskRCNN(backbone, classes, rpn_anchor_generator=anchors, **MODEST, **usual)
    heads, channels = made.roi_heads, backbone.out_channels
    heads.box_head = detection.faster_rcnn.TwoMLPHead(channels * POOLED**2, WIDTH)
    heads.box_predictor = detection.faster_rcnn.FastRCNNPredictor(WIDTH, classes)
    heads.mask_head = detection.mask_rcnn.MaskRCNNHeads(channels, (MASK_WIDTH, MASK_WIDTH), 1)
    heads.mask_predictor = detection.mask_rcnn.MaskRCNNPredictor(MASK_WIDTH, MASK_WIDTH, classes)
    return made
