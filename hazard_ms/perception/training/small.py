"""The training of our own small detector: crops around things, whose pixels count more the fewer a thing has."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from hazard_ms.perception.detectors.second_stage import PREFIX
from hazard_ms.perception.detectors.small import NETWORK, Small
from hazard_ms.perception.detectors.small_network import REACH, SCALE, SmallNetwork, features
from hazard_ms.perception.detectors.weights import read_recipe, read_weights
from hazard_ms.perception.training.drawing import Drawing
from hazard_ms.perception.training.pictures import Picture, classes_of, names_of
from hazard_ms.perception.training.student import AveragedStudent, device, half_precision, relit
from hazard_ms.spec.catalogue import CATEGORIES

# [ours], all of them
RATE, FINE, WARM, DECAY = 2e-3, 1e-3, 200, 1e-4  # rates with random and trained weights; steps until then; decay
AVERAGE_DECAY = 0.999  # share of the averaged weights that a step leaves
HARD = 1.0  # exponent by which pixels that are known for sure count less (focal loss)
MISTAKEN = 2.0  # by which a pixel of structure or other things counts more where it is taken for a known one
OF_OFFSETS, OF_THINGS = 0.5, 0.5  # weights of the offsets, and of the categories of whole things in the loss
FEWEST, FULLY = 8, 256  # pixels from which a thing counts as a whole, and from which it counts fully
LIGHT, CONTRAST, TINT = 0.35, 0.3, 0.15  # by which crops are made brighter, starker and more colourful
CARTS = ("cart",)  # furniture that agents bring things to


class SmallStudent(AveragedStudent):
    """The small network, an average of its weights over the last steps, and the pictures that it learns from."""

    average: SmallNetwork
    decay = AVERAGE_DECAY

    def __init__(
        self,
        pictures: Sequence[Picture],
        batch: int,
        size: int,
        recipe: Mapping[str, Any] | None = None,
        weights: Path | None = None,
    ) -> None:
        """Learn from crops with sides of `size` [pixels], or of the smallest picture, `batch` at a time.

        `recipe`: that of a training that goes on, which needs no `weights` any more; `weights`: of another small
        network, with which this one begins.

        Raises ValueError for pictures without things that can move, for an invalid side, for categories that the
        recipe does not have, and for weights that do not fit.
        """
        if size % SCALE:
            raise ValueError(f"size must be a multiple of {SCALE} for the model small, got {size}")
        moving = [n for n in names_of(pictures) if CATEGORIES[n].kind == "object" or n in CARTS]
        self.classes = classes_of(moving, recipe)
        self._drawing, self._batch = Drawing(pictures, self.classes, size), batch
        self._device = device()
        self._half = half_precision(self._device)
        made = SmallNetwork(len(self.classes) + 2)
        self._rate = RATE if weights is None else FINE
        if weights is not None and recipe is None:
            begin(made, self.classes, weights)
        self.network = made.to(self._device).to(memory_format=torch.channels_last)
        self.average = copy.deepcopy(made).eval()
        self.optimiser = torch.optim.AdamW(made.parameters(), self._rate, weight_decay=DECAY)

    def losses(self, chance: np.random.Generator) -> Mapping[str, Tensor]:
        crops = [self._drawing.crop(chance) for _ in range(self._batch)]
        rgb, depth, intrinsic, cam2world, label, weight, offset, thing = (
            torch.from_numpy(np.stack(part)).to(self._device) for part in zip(*crops, strict=True)
        )
        given = features(rgb, depth, intrinsic, cam2world)
        given[:, :3] = relit(given[:, :3], chance, LIGHT, TINT, CONTRAST)
        with torch.autocast(self._device.type, torch.bfloat16, enabled=self._half):
            logits, told = self.network(given.contiguous(memory_format=torch.channels_last))
        by_pixel = functional.log_softmax(logits.permute(0, 2, 3, 1).flatten(0, 2), -1)  # [P, C] as they lie in memory
        right = by_pixel.gather(1, label.view(-1, 1))[:, 0]
        known = ((label > 0) & (label <= len(self.classes))).flatten()
        with torch.no_grad():
            taken = 1.0 - by_pixel[:, 0].exp() - by_pixel[:, -1].exp()
            hard = (1.0 - right.exp()) ** HARD * torch.where(known, 1.0, 1.0 + MISTAKEN * taken)
        every = weight.flatten()
        things = every * known
        away = ((told - offset).abs().sum(1) / REACH).flatten()
        return {
            "categories": -(every * hard * right).sum() / every.sum(),
            "middles": OF_OFFSETS * (things * away).sum() / things.sum().clamp(min=1.0),
            "things": OF_THINGS * of_things(right.exp(), torch.where(known.view_as(thing), thing, 0)),
        }

    def pace(self, step: int, share: float) -> float:
        return self._rate * min(1.0, (step + 1) / WARM) * 0.5 * (1.0 + math.cos(math.pi * min(share, 0.99)))

    def detector(self) -> Small:
        return Small.of(copy.deepcopy(self.average), self.classes)

    def weights(self) -> dict[str, Tensor]:
        found = self.average.state_dict()
        return {k: (v.half() if v.ndim == 4 else v).cpu().contiguous() for k, v in found.items()}

    def recipe(self) -> dict[str, Any]:
        return {"network": NETWORK, "classes": self.classes}


def of_things(right: Tensor, thing: Tensor) -> Tensor:
    """The loss by the categories of whole things, 0-dimensional [...] [-], which a detector tells as a whole.

    By the mean chance of its category over the pixels of a thing. Things of FULLY pixels or more count alike, smaller
    ones as the root of their area. `right`, [N H W]: the chance of each pixel's own category; `thing`, [N, H, W]: the
    number of its thing, 0: none that counts.
    """
    count = int(thing.max()) + 1
    number = (thing + count * torch.arange(len(thing), device=thing.device)[:, None, None]).flatten()
    pixels = torch.bincount(number, minlength=count * len(thing)).float()
    total = torch.zeros_like(pixels).index_add(0, number, right)
    whole = pixels >= FEWEST
    whole[::count] = False
    mean = (total[whole] / pixels[whole]).clamp(min=1e-4)
    weight = (pixels[whole] / FULLY).clamp(max=1.0).sqrt()
    return -(weight * torch.log(mean)).sum() / weight.sum().clamp(min=1.0)


def begin(network: SmallNetwork, classes: Sequence[str], path: Path) -> None:
    """Give `network`, which tells `classes`, the trained weights at `path` of a small network, NAME.json beside it.

    Parts that those lack, and categories that they do not tell, stay untrained; a second stage is left out. Raises
    ValueError for weights of another network.
    """
    before = ["", *read_recipe(path.with_suffix(".json"), (NETWORK,))["classes"], "other"]
    given = {name: value.float() for name, value in read_weights(path).items() if not name.startswith(PREFIX)}
    state = network.state_dict()
    rows = {k: before.index(name) for k, name in enumerate(["", *classes, "other"]) if name in before}
    told = {"logits.weight", "logits.bias", *(name for name in given if name.startswith("kinds."))}
    for name in sorted(told):
        if name not in state or len(given.get(name, ())) != len(before):
            raise ValueError(f"weights must be those of a small network with {len(before)} classes, got {path}")
        kept, given[name] = given[name], state[name].clone()
        given[name][list(rows)] = kept[list(rows.values())]
    try:
        _, spare = network.load_state_dict(given, strict=False)
    except RuntimeError as error:
        spare = [str(error).splitlines()[-1].strip()]
    if spare:
        raise ValueError(f"weights must fit the network small, got {path}: {spare[0]:.200}")
