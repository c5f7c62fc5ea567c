"""The training of the second stage of the small detector: patches of all things in the pictures, one at a time."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from hazard_ms.perception.detectors.second_stage import (
    LEAST_PIXELS,
    PREFIX,
    SIDE,
    SecondNetwork,
    loaded,
    patch_of,
    sizes_of,
)
from hazard_ms.perception.detectors.small import NETWORK, Small
from hazard_ms.perception.detectors.small_network import SmallNetwork, features
from hazard_ms.perception.detectors.weights import read_recipe, read_weights
from hazard_ms.perception.training.pictures import Picture
from hazard_ms.perception.training.student import AveragedStudent, device, half_precision, relit

# [ours], all of them
RATE, FINE, WARM = 3e-3, 1e-3, 200  # rates with random and trained weights; steps until these are reached
DECAY, AVERAGE_DECAY = 2e-2, 0.998  # of weights; and as in small.py
SMOOTH = 0.05  # of the chance that is given to other categories than the right one
FULLY = 256  # pixels from which a thing is drawn as often as others
OTHERS = 0.3  # share of things of no known category that are learned from
SAME, NONE = 0.5, 0.2  # intersection over union from which what is found is a thing, and below which it is none
KEPT, KEPT_MARGIN = 96, 2.25  # side of what is kept of a thing [pixels], and what it shows, as MARGIN
FINEST = 50.0  # by which what is kept is rounded: 1 / FINEST
ZOOM, TURN, SHIFT = (0.55, 0.9), 0.08, 0.05  # patches are this share of what is kept, turned [rad], and moved
COARSE, COARSEST = 0.4, 16  # share of patches that are seen with fewer pixels, and the fewest of these
SPOILT = ((3, True), (5, True), (7, True), (3, False), (5, False), (7, False))  # masks grown or shrunk, each a twelfth
LIGHT, TINT, CONTRAST = 0.3, 0.12, 0.25
UNSURE = 0.06  # of the sizes that are told


class SecondStageStudent(AveragedStudent):
    """The network of the second stage, and the things that it learns from; the first stage stays as it is."""

    average: SecondNetwork
    decay = AVERAGE_DECAY

    def __init__(
        self,
        pictures: Sequence[Picture],
        batch: int,
        weights: Path | None,
        recipe: Mapping[str, Any] | None = None,
        seed: int = 0,
    ) -> None:
        """Learn from the things in `pictures`, `batch` at a time; `weights`: of the first stage, NAME.safetensors.

        If they hold a second stage, too, training begins with that one, at a lower rate. `recipe`: that of a training
        that goes on; `seed`: of the draw of things of other categories.

        Raises ValueError without weights of the small detector, and for pictures without things that it tells.
        """
        if weights is None:
            raise ValueError(
                "weights must be those of a small detector, so that its second stage can be trained, got none"
            )
        self.classes: list[str] = read_recipe(weights.with_suffix(".json"), (NETWORK,))["classes"]
        if recipe is not None and list(recipe["classes"]) != self.classes:
            raise ValueError(f"weights must have the categories that the training began with, got {weights}")
        kept = read_weights(weights)
        self._first = {name: value for name, value in kept.items() if not name.startswith(PREFIX)}
        self._network = SmallNetwork(len(self.classes) + 2)
        try:
            begun = loaded(kept, len(self.classes))
            self._network.load_state_dict({name: value.float() for name, value in self._first.items()})
        except RuntimeError as error:
            raise ValueError(f"weights must be those of a small detector, got {weights}: {error!s:.200}") from None
        self._batch, self._device = batch, device()
        first = Small.of(self._network, self.classes)
        self._patches, self._sizes, self._kinds, pixels = gathered(pictures, first, np.random.default_rng(seed))
        print(f"{len(pixels):,} things", flush=True)
        if not bool((self._kinds < len(self.classes)).any()):
            raise ValueError(f"DATA must hold things of the categories {', '.join(self.classes)}, got none")
        count = np.bincount(self._kinds.numpy(), minlength=len(self.classes) + 1)
        chances = np.sqrt((pixels / FULLY).clip(max=1.0)) / np.sqrt(count[self._kinds.numpy()])
        self._chances = np.cumsum(chances / chances.sum())
        self._rate = RATE if begun is None else FINE
        self.network = (begun or SecondNetwork(len(self.classes) + 1)).to(self._device)
        self.average = copy.deepcopy(self.network).eval()
        self.optimiser = torch.optim.AdamW(self.network.parameters(), self._rate, weight_decay=DECAY)

    def losses(self, chance: np.random.Generator) -> Mapping[str, Tensor]:
        drawn = np.searchsorted(self._chances, chance.random(self._batch)).clip(max=len(self._kinds) - 1)
        chosen = torch.from_numpy(drawn)
        patches = changed(self._patches[chosen].float() / FINEST, chance).to(self._device)
        noise = torch.from_numpy(chance.normal(0.0, UNSURE, self._sizes[chosen].shape)).float()
        with torch.autocast(self._device.type, torch.bfloat16, enabled=half_precision(self._device)):
            told = self.network(patches, (self._sizes[chosen] + noise).to(self._device))
        right = self._kinds[chosen].to(self._device)
        return {"categories": functional.cross_entropy(told.float(), right, label_smoothing=SMOOTH)}

    def pace(self, step: int, share: float) -> float:
        return self._rate * min(1.0, (step + 1) / WARM) * 0.5 * (1.0 + math.cos(math.pi * min(share, 0.99)))

    def detector(self) -> Small:
        return Small.of(copy.deepcopy(self._network), self.classes, copy.deepcopy(self.average))

    def weights(self) -> dict[str, Tensor]:
        found = {f"{PREFIX}{name}": value for name, value in self.average.state_dict().items()}
        found = {name: value.half() if value.ndim == 4 else value for name, value in found.items()}
        return {name: value.cpu().contiguous() for name, value in {**self._first, **found}.items()}

    def recipe(self) -> dict[str, Any]:
        return {"network": NETWORK, "classes": self.classes}


def gathered(
    pictures: Sequence[Picture], first: Small, chance: np.random.Generator
) -> tuple[Tensor, Tensor, Tensor, NDArray[np.int64]]:
    """All things of LEAST_PIXELS pixels or more in `pictures`, as they are kept, 90 kB each.

    They are masked as in the truth and, once more, as `first` finds them. Patches, int8 [N, C, KEPT, KEPT] [1/FINEST];
    what `sizes_of` tells, [N, SIZES]; numbers of their categories in `classes`, or their count for others, [N]; pixels,
    [N]. Takes half a second to a second a picture on one core. Raises ValueError for pictures without things.
    """
    patches, sizes, kinds, pixels = [], [], [], []
    for picture in pictures:
        depth, camera = picture.depth(), (picture.intrinsic(), picture.cam2world())
        told = (torch.from_numpy(np.ascontiguousarray(a))[None] for a in (picture.rgb(), depth, *camera))
        given = features(*told)[0]
        for mask, kind in shown(picture, first):
            count = int(mask.sum())
            if count < LEAST_PIXELS or (kind == len(first.classes) and chance.random() >= OTHERS):
                continue
            patch = (FINEST * patch_of(given, mask, KEPT, KEPT_MARGIN)).round().clamp(-127, 127)
            patches.append(patch.to(torch.int8))
            sizes.append(torch.from_numpy(sizes_of(depth, camera, mask)))
            kinds.append(kind)
            pixels.append(count)
    if not patches:
        raise ValueError(f"DATA must hold things of {LEAST_PIXELS} pixels or more, got none")
    return torch.stack(patches), torch.stack(sizes), torch.tensor(kinds), np.array(pixels)


def shown(picture: Picture, first: Small) -> Iterator[tuple[NDArray[np.bool_], int]]:
    """The masks, [H, W], of all things in a picture, and of what `first` finds there, with numbers of their categories.

    What it finds is the thing with which it shares the most, if that is SAME or more of both; it is none, numbered like
    things of no known category, if it shares less than NONE with any; what lies between is left out.
    """
    ids, names = picture.ids(), picture.categories()
    numbers = {name: k for k, name in enumerate(first.classes)}
    kinds = {number: numbers.get(name, len(numbers)) for number, name in names.items()}
    area = np.bincount(ids.ravel())
    for number in (1 + np.flatnonzero(area[1:])).tolist():
        yield ids == number, kinds.get(number, len(numbers))
    first.aim(picture.intrinsic(), picture.cam2world())
    where = device()
    with torch.autocast(where.type, torch.bfloat16, enabled=half_precision(where)):
        found = first.detect(picture.rgb(), picture.depth())
    for one in found:
        common = np.bincount(ids[one.mask], minlength=len(area))
        common[0] = 0
        best = int(common.argmax())
        share = common[best] / (one.mask.sum() + area[best] - common[best])
        if share >= SAME:
            yield one.mask, kinds.get(best, len(numbers))
        elif share < NONE:
            yield one.mask, len(numbers)


def changed(kept: Tensor, chance: np.random.Generator) -> Tensor:
    """Patches, [N, C, SIDE, SIDE], of what is `kept` of things, [N, C, KEPT, KEPT], as other looks might show them.

    Zoomed, turned, moved and mirrored; some with fewer pixels; in other lights; some with masks that are a little
    wrong.
    """
    count = len(kept)
    zoom, turn = chance.uniform(*ZOOM, count), chance.normal(0.0, TURN, count)
    mirror, shift = chance.choice([-1.0, 1.0], count), chance.normal(0.0, SHIFT, (count, 2))
    turned = [[zoom * mirror * np.cos(turn), -zoom * np.sin(turn), shift[:, 0]]]
    turned += [[zoom * mirror * np.sin(turn), zoom * np.cos(turn), shift[:, 1]]]
    grid = functional.affine_grid(
        torch.from_numpy(np.array(turned).transpose(2, 0, 1)).float(), [count, 1, SIDE, SIDE], align_corners=False
    )
    made = functional.grid_sample(kept, grid, "bilinear", "border", align_corners=False)
    order = torch.from_numpy(chance.permutation(count))
    for some in order[: int(COARSE * count)].tensor_split(4):
        fewer = int(chance.integers(COARSEST, SIDE - 8))
        if len(some):
            small = functional.interpolate(made[some], (fewer, fewer), mode="area")
            made[some] = functional.interpolate(small, (SIDE, SIDE), mode="bilinear")
    made[:, :3] = relit(made[:, :3], chance, LIGHT, TINT, CONTRAST)
    order = torch.from_numpy(chance.permutation(count))
    for some, (width, grown) in zip(order.tensor_split(2 * len(SPOILT)), SPOILT, strict=False):
        mask, sign = made[some, -1:], 1.0 if grown else -1.0
        if len(some):
            made[some, -1:] = sign * functional.max_pool2d(sign * mask, width, 1, width // 2)
    return made
