"""RF-DETR-Seg of Roboflow (Apache-2.0) with weights from a file of the user's.

Beside the weights FILE.pth or FILE.safetensors, plain tensors by name, stands FILE.json with the network, its classes
and the checksum of the weights:

    {"network": "rfdetr_seg_nano", "classes": ["bowl", "mug", ...], "sha256": "..."}

Classes are the catalogue's categories, in the order in which the network numbers them from 0. `size`, the side to which
the network brings pictures [pixels], may be given where it is not the network's own. A checkpoint of rfdetr's training
holds more than tensors, and must be converted (docs/perception.md).
"""

from __future__ import annotations

import logging
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.perception.detectors.weights import read_recipe, read_weights
from hazard_ms.sensing.detection.detector import Detection, Detector
from hazard_ms.spec.foreign.files import printable, sha256_of

NETWORKS = {  # classes of the package rfdetr
    "rfdetr_seg_nano": "RFDETRSegNano",
    "rfdetr_seg_small": "RFDETRSegSmall",
    "rfdetr_seg_medium": "RFDETRSegMedium",
    "rfdetr_seg_large": "RFDETRSegLarge",
    "rfdetr_seg_xlarge": "RFDETRSegXLarge",
    "rfdetr_seg_2xlarge": "RFDETRSeg2XLarge",
}
LEAST_SCORE = 0.05  # of what is told, as in torchvision's Mask R-CNN
DIGEST = re.compile(r"[0-9a-f]{64}")


class RfDetr(Detector):
    """A trained RF-DETR-Seg; it looks at colours only."""

    def __init__(self, path: str) -> None:
        """Load the weights at `path`.

        Raises ValueError where rfdetr is missing, for files that are missing or do not fit each other, and for weights
        of another checksum.
        """
        file = Path(path)
        recipe = read_recipe(file.with_suffix(".json"), tuple(NETWORKS))
        wanted = recipe.get("sha256")
        if not isinstance(wanted, str) or not DIGEST.fullmatch(wanted):
            raise ValueError(
                f"{printable(str(file.with_suffix('.json')))} must hold the sha256 of the weights, got {wanted!r:.100}"
            )
        if (found := sha256_of(file)) != wanted:
            raise ValueError(f"weights must have the sha256 {wanted}, got {found}: {printable(str(file))}")
        made = network(recipe["network"], len(recipe["classes"]), recipe.get("size"))
        load(made.model.model, read_weights(file), f"the network {recipe['network']}, got {printable(str(file))}")
        self._model, self._classes = made, recipe["classes"]

    @torch.inference_mode()
    def detect(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        """Find things in the colours `rgb`, [H, W, 3]; the `depth`, [H, W] [m], is not looked at."""
        found = self._model.predict(np.ascontiguousarray(rgb), threshold=LEAST_SCORE, include_source_image=False)
        masks = np.zeros((len(found), *rgb.shape[:2]), bool) if found.mask is None else np.asarray(found.mask, bool)
        boxes = [(float(a), float(b), float(c), float(d)) for a, b, c, d in found.xyxy.tolist()]
        every = zip(found.class_id.tolist(), found.confidence.tolist(), boxes, masks, strict=True)
        # one class more than there are stands for nothing
        known = (row for row in every if row[0] < len(self._classes))
        return [Detection(self._classes[k], score, box, mask) for k, score, box, mask in known]


def network(name: str, classes: int, size: int | None = None) -> Any:
    """The untrained network called `name`, of rfdetr's class, for so many `classes`.

    It brings pictures to squares of `size` [pixels], if given. Raises ValueError where rfdetr is missing.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import rfdetr
    except ImportError as error:
        raise ValueError(
            f"perception rf_detr needs the package rfdetr ({error}): pip install 'hazard_ms[rfdetr]'"
        ) from None
    logging.getLogger("rf-detr").setLevel(logging.ERROR)  # it warns that weights are not downloaded
    more = {} if size is None else {"resolution": size}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return getattr(rfdetr, NETWORKS[name])(pretrain_weights=None, num_classes=classes, **more)


def load(network: Any, weights: dict[str, torch.Tensor], what: str) -> None:
    """Fill a torch `network` with `weights`, [...] [-] by name; its own flags stay as they are.

    Raises ValueError if they do not fit.
    """
    flags = {name for name, value in network.state_dict().items() if not value.is_floating_point()}
    try:
        left = network.load_state_dict(weights, strict=False)
    except RuntimeError as error:
        raise ValueError(f"weights must fit {what}: {str(error).splitlines()[-1].strip():.200}") from None
    lost = sorted({*left.missing_keys} - flags) + sorted(left.unexpected_keys)
    if lost:
        raise ValueError(
            f"weights must fit {what}, got {len(lost)} names that differ, such as {printable(lost[0])[:100]}"
        )
