"""The training of torchvision's Mask R-CNN: from weights of COCO's photographs, or a smaller one from nothing."""

from __future__ import annotations

import bisect
import copy
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torchvision import tv_tensors
from torchvision.transforms import v2

from hazard_ms.perception.detectors.mask_rcnn import NETWORKS, RESNET18, MaskRcnn, network
from hazard_ms.perception.detectors.weights import read_recipe, read_weights
from hazard_ms.perception.layout import category_ids
from hazard_ms.perception.training.pictures import Picture, classes_of, names_of
from hazard_ms.perception.training.student import Student, device, half_precision

FINE, COARSE = 0.005, 0.01  # rates of learning with trained and with random weights, for 2 pictures a step [ours]
MOMENTUM, DECAY = 0.9, 1e-4  # as in torchvision's own training
WARM, WARM_SHARE = 500, 0.1  # steps until the rate is reached, or the share of a shorter training [ours]
DROPS = (8 / 12, 11 / 12)  # shares of the training after which the rate is a tenth of what it was
HEADS = ("roi_heads.box_predictor.", "roi_heads.mask_predictor.mask_fcn_logits.")  # that are as many as classes


class MaskRcnnStudent(Student):
    """Mask R-CNN, and the pictures that it learns from."""

    def __init__(
        self,
        pictures: Sequence[Picture],
        batch: int,
        size: int | None,
        weights: Path | None,
        recipe: Mapping[str, Any] | None = None,
    ) -> None:
        """Learn from `pictures`, `batch` at a time, brought to `size` [pixels]; begin with `weights`, or untrained.

        `recipe`: that of a training that goes on, which needs no `weights` any more.

        Raises ValueError for weights that cannot be used, for pictures in which nothing is annotated, and for
        categories that the recipe does not have.
        """
        self._pictures, self._batch = [picture for picture in pictures if picture.things], batch
        self.classes = classes_of(names_of(pictures), recipe)
        self._device = device()
        self._half = self._device.type == "cuda" and half_precision(self._device)
        name, start = RESNET18, None
        if recipe is not None:
            name, size = recipe["network"], recipe.get("size")
        elif weights is not None:
            name, start, size = begun(weights, size)
        self._recipe: dict[str, Any] = {"network": name, "classes": self.classes} | ({"size": size} if size else {})
        self.network = network(name, 1 + len(self.classes), size)
        if start is not None:
            self.network.load_state_dict(start, strict=False)
        self.network.to(self._device)
        numbers = category_ids()
        self._labels = {numbers[category]: k for k, category in enumerate(self.classes, start=1)}
        self._rate = (COARSE if weights is None else FINE) * batch / 2
        learning = [p for p in self.network.parameters() if p.requires_grad]
        self.optimiser = torch.optim.SGD(learning, self._rate, momentum=MOMENTUM, weight_decay=DECAY)
        self._changed = v2.Compose(
            [
                v2.RandomHorizontalFlip(0.5),
                v2.ColorJitter(0.4, 0.3, 0.3),
                v2.ToDtype({tv_tensors.Image: torch.float32, "others": None}, scale=True),
                v2.SanitizeBoundingBoxes(labels_getter=lambda given: (given[1]["labels"], given[1]["masks"])),
            ]
        )

    def losses(self, chance: np.random.Generator) -> Mapping[str, Tensor]:
        chosen = chance.choice(len(self._pictures), self._batch, replace=len(self._pictures) < self._batch)
        pictures, targets = zip(*(self.example(self._pictures[k]) for k in chosen), strict=True)
        given = [picture.to(self._device) for picture in pictures]
        wanted = [{name: value.to(self._device) for name, value in target.items()} for target in targets]
        with torch.autocast(self._device.type, torch.bfloat16, enabled=self._half):
            parts: dict[str, Tensor] = self.network(given, wanted)
        return {name.removeprefix("loss_"): value.float() for name, value in parts.items()}

    def example(self, picture: Picture) -> tuple[Tensor, dict[str, Tensor]]:
        """A picture, [3, H, W], 0 to 1, with boxes, labels and masks of its things, both changed by chance."""
        ids = torch.from_numpy(picture.ids().astype(np.int64))
        height, width = ids.shape
        boxes = torch.tensor([[x, y, x + w, y + h] for x, y, w, h in (t["bbox"] for t in picture.things)]).float()
        target = {
            "boxes": tv_tensors.BoundingBoxes(boxes, format="XYXY", canvas_size=(height, width)),
            "labels": torch.tensor([self._labels[thing["category_id"]] for thing in picture.things]),
            "masks": tv_tensors.Mask(torch.stack([ids == thing["instance"] + 1 for thing in picture.things])),
        }
        return self._changed(tv_tensors.Image(torch.from_numpy(picture.rgb()).permute(2, 0, 1)), target)

    def pace(self, step: int, share: float) -> float:
        warmth = min(1.0, max((step + 1) / WARM, share / WARM_SHARE))
        return self._rate * warmth * 0.1 ** bisect.bisect_right(DROPS, share)

    def detector(self) -> MaskRcnn:
        return MaskRcnn.of(copy.deepcopy(self.network), self.classes)

    def weights(self) -> dict[str, Tensor]:
        return {name: value.detach().cpu().contiguous() for name, value in self.network.state_dict().items()}

    def recipe(self) -> dict[str, Any]:
        return self._recipe


def begun(path: Path, size: int | None) -> tuple[str, dict[str, Tensor], int | None]:
    """The network of which `path` holds trained weights, these, [...] [-] by name, without its heads, and its size.

    A file NAME.json beside it names the network and, unless `size` [pixels] is given, the size; without, it is the
    network that they fit. Raises ValueError if none does.
    """
    beside = path.with_suffix(".json")
    recipe = read_recipe(beside, NETWORKS) if beside.is_file() else {}
    names, size = (recipe["network"],) if recipe else NETWORKS, size or recipe.get("size")
    kept = {name: value for name, value in read_weights(path).items() if not name.startswith(HEADS)}
    faults = []
    for name in names:
        made = network(name, 2, size)
        try:
            lack, spare = made.load_state_dict(kept, strict=False)
        except RuntimeError as error:
            faults.append(f"{name}: {str(error).splitlines()[-1].strip()}")
            continue
        lack = [key for key in lack if not key.startswith(HEADS) and not key.endswith("num_batches_tracked")]
        if not lack and not spare:
            return name, kept, size
        faults.append(f"{name}: {len(lack)} tensors are missing and {len(spare)} are not known")
    raise ValueError(f"weights must be those of torchvision's Mask R-CNN, got {path}: {'; '.join(faults):.300}")
