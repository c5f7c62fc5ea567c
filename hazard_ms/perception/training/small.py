"""The training of our own small detector: crops around things, whose pixels count more the fewer a thing has."""

from __future__ import annotations

import copy
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from hazard_ms.perception.detectors.small import NETWORK, Small
from hazard_ms.perception.detectors.small_network import REACH, SCALE, SmallNetwork, features
from hazard_ms.perception.layout import category_ids
from hazard_ms.perception.training.pictures import Picture, classes_of, names_of
from hazard_ms.perception.training.student import Student, device, half_precision
from hazard_ms.spec.catalogue import CATEGORIES

# [ours], all of them
OF_THINGS = 0.8  # share of crops that are cut around a thing; the others are cut anywhere
OFF_CENTRE = 0.375  # by which such a thing may be beside the middle of its crop, as a share of the side
RATE, WARM, DECAY = 2e-3, 200, 1e-4  # highest rate of learning; steps until then; decay of weights
AVERAGE_DECAY = 0.999  # share of the averaged weights that a step leaves
USUAL = 256  # area of a thing whose pixels have the weight 1 [pixels]
LEAST, MOST = 0.5, 4.0  # weight of a pixel of large and of small things
OF_STRUCTURE, OF_OTHERS = 0.4, 0.5  # weight of a pixel of floor and walls, and of things that are not known
HARD = 1.0  # exponent by which pixels that are known for sure count less (focal loss)
OF_OFFSETS = 0.5  # weight of the offsets in the loss
LIGHT, CONTRAST, TINT = 0.35, 0.3, 0.15  # by which crops are made brighter, starker and more colourful
CARTS = ("cart",)  # furniture that agents bring things to


class Crop(NamedTuple):
    """A part of a picture, and what is to be learned of each pixel."""

    rgb: NDArray[np.uint8]  # [H, W, 3]
    depth: NDArray[np.float32]  # [H, W] [m]
    intrinsic: NDArray[np.float32]  # [3, 3] [pixels]
    cam2world: NDArray[np.float32]  # [4, 4] [m]
    label: NDArray[np.int64]  # [H, W]: 0 structure, 1 to C the classes, C + 1 other things
    weight: NDArray[np.float32]  # [H, W]
    offset: NDArray[np.float32]  # [2, H, W], right and down to the middle of the thing [pixels]


class SmallStudent(Student):
    """The small network, an average of its weights over the last steps, and the pictures that it learns from."""

    def __init__(
        self, pictures: Sequence[Picture], batch: int, size: int, recipe: Mapping[str, Any] | None = None
    ) -> None:
        """Learn from crops with sides of `size` [pixels], or of the smallest picture, `batch` at a time.

        `recipe`: that of a training that goes on.

        Raises ValueError for pictures without things that can move, for an invalid side, and for categories that the
        recipe does not have.
        """
        if size % SCALE:
            raise ValueError(f"size must be a multiple of {SCALE} for the model small, got {size}")
        moving = [n for n in names_of(pictures) if CATEGORIES[n].kind == "object" or n in CARTS]
        self.classes = classes_of(moving, recipe)
        self._pictures, self._batch = list(pictures), batch
        least = (min(picture.row[side] for picture in pictures) for side in ("width", "height"))
        self._sides = tuple(min(size, edge - edge % SCALE) for edge in least)
        self._number = {name: k for k, name in enumerate(self.classes, start=1)}
        names = {number: name for name, number in category_ids().items()}
        known = [(k, t, names[t["category_id"]]) for k, p in enumerate(pictures) for t in p.things]
        self._things = [(k, t["bbox"], name) for k, t, name in known if name in self._number]
        count = Counter(name for *_, name in self._things)
        chances = np.array([1.0 / math.sqrt(count[name]) for *_, name in self._things])
        self._chances = np.cumsum(chances / chances.sum())
        self._device = device()
        self._half = half_precision(self._device)
        made = SmallNetwork(len(self.classes) + 2)
        self.network = made.to(self._device).to(memory_format=torch.channels_last)
        self._average = copy.deepcopy(made).eval()
        self._steps = 0
        self.optimiser = torch.optim.AdamW(made.parameters(), RATE, weight_decay=DECAY)

    def losses(self, chance: np.random.Generator) -> Mapping[str, Tensor]:
        crops = [self._crop(chance) for _ in range(self._batch)]
        rgb, depth, intrinsic, cam2world, label, weight, offset = (
            torch.from_numpy(np.stack(part)).to(self._device) for part in zip(*crops, strict=True)
        )
        given = features(rgb, depth, intrinsic, cam2world)
        given[:, :3] = _relit(given[:, :3], chance)
        with torch.autocast(self._device.type, torch.bfloat16, enabled=self._half):
            logits, told = self.network(given.contiguous(memory_format=torch.channels_last))
        ordinary = functional.cross_entropy(logits, label, reduction="none")
        hard = (1.0 - torch.exp(-ordinary.detach())) ** HARD
        things = (weight * ((label > 0) & (label <= len(self.classes)))).flatten()
        away = ((told - offset).abs().sum(1) / REACH).flatten()
        return {
            "categories": (weight * hard * ordinary).sum() / weight.sum(),
            "middles": OF_OFFSETS * (things * away).sum() / things.sum().clamp(min=1.0),
        }

    def pace(self, step: int, share: float) -> float:
        return RATE * min(1.0, (step + 1) / WARM) * 0.5 * (1.0 + math.cos(math.pi * min(share, 0.99)))

    @torch.no_grad()
    def learned(self) -> None:
        self._steps += 1
        kept = min(AVERAGE_DECAY, (1 + self._steps) / (10 + self._steps))
        for mean, now in zip(self._average.state_dict().values(), self.network.state_dict().values(), strict=True):
            mean.copy_(now if not mean.is_floating_point() else torch.lerp(now, mean, kept))

    def detector(self) -> Small:
        return Small.of(copy.deepcopy(self._average), self.classes)

    def weights(self) -> dict[str, Tensor]:
        found = self._average.state_dict()
        return {k: (v.half() if v.ndim == 4 else v).cpu().contiguous() for k, v in found.items()}

    def recipe(self) -> dict[str, Any]:
        return {"network": NETWORK, "classes": self.classes}

    def state(self) -> dict[str, Any]:
        return {**super().state(), "average": self._average.state_dict(), "steps": self._steps}

    def resume(self, state: Mapping[str, Any]) -> None:
        super().resume(state)
        self._average.load_state_dict(state["average"])
        self._steps = int(state["steps"])

    def _crop(self, chance: np.random.Generator) -> Crop:
        """A crop around a thing of which there are few, or anywhere; every other one is seen in a mirror."""
        if chance.random() < OF_THINGS:
            number, box, _ = self._things[int(np.searchsorted(self._chances, chance.random()))]
            middle = (box[0] + box[2] / 2, box[1] + box[3] / 2) + chance.uniform(
                -OFF_CENTRE, OFF_CENTRE, 2
            ) * self._sides
        else:
            number = int(chance.integers(len(self._pictures)))
            middle = chance.uniform(0.0, 1e4, 2)
        picture = self._pictures[number]
        width, height = picture.row["width"], picture.row["height"]
        left = int(np.clip(middle[0] - self._sides[0] / 2, 0, width - self._sides[0]))
        top = int(np.clip(middle[1] - self._sides[1] / 2, 0, height - self._sides[1]))
        made = self.cut(picture, left, top, self._sides)
        return mirrored(made) if chance.random() < 0.5 else made

    def cut(self, picture: Picture, left: int, top: int, sides: tuple[int, int]) -> Crop:
        """The part of a picture that begins at (`left`, `top`) and has these `sides` (width, height) [pixels]."""
        window = slice(top, top + sides[1]), slice(left, left + sides[0])
        intrinsic = picture.intrinsic()
        intrinsic[:2, 2] -= (left, top)
        ids = picture.ids()[window].astype(np.int64)
        kinds = picture.categories()
        table = np.zeros(max(kinds, default=0) + 1, np.int64)
        for number, name in kinds.items():
            table[number] = self._number.get(name, len(self.classes) + 1)
        area = np.bincount(ids.ravel(), minlength=len(table)).astype(np.float32)
        weight = np.sqrt(USUAL / np.maximum(area, 1.0)).clip(LEAST, MOST)
        weight[table == len(self.classes) + 1] = OF_OTHERS
        weight[0] = OF_STRUCTURE
        rows, columns = np.indices(ids.shape, np.float32)
        across, down = (
            np.bincount(ids.ravel(), grid.ravel(), minlength=len(table)) / np.maximum(area, 1.0)
            for grid in (columns, rows)
        )
        offset = np.stack([across[ids] - columns, down[ids] - rows]).astype(np.float32)
        seen = picture.rgb()[window], picture.depth()[window]
        return Crop(*seen, intrinsic, picture.cam2world(), table[ids], weight[ids].astype(np.float32), offset)


def mirrored(crop: Crop) -> Crop:
    """The same crop seen in an upright mirror."""
    rgb, depth, intrinsic, cam2world, label, weight, offset = crop
    intrinsic, cam2world = intrinsic.copy(), cam2world.copy()
    intrinsic[0, 2] = depth.shape[1] - intrinsic[0, 2]
    cam2world[:3, 0] *= -1.0
    flipped = (np.ascontiguousarray(part[:, ::-1]) for part in (rgb, depth, label, weight))
    rgb, depth, label, weight = flipped  # type: ignore[assignment]
    moved = np.ascontiguousarray(offset[..., ::-1]) * np.array([-1.0, 1.0], np.float32)[:, None, None]
    return Crop(rgb, depth, intrinsic, cam2world, label, weight, moved)


def _relit(colours: Tensor, chance: np.random.Generator) -> Tensor:
    """The `colours` of crops, [N, 3, H, W], -1 to 1, in another light for each."""
    count = len(colours)
    light = np.exp(chance.normal(0.0, LIGHT, (count, 1)) + chance.normal(0.0, TINT, (count, 3)))
    gamma = np.exp(chance.normal(0.0, CONTRAST, (count, 1)))
    gain, power = (torch.from_numpy(a).float().to(colours.device)[:, :, None, None] for a in (light, gamma))
    return (gain * (0.5 * colours + 0.5).clamp(min=1e-3) ** power).clamp(0.0, 1.0) * 2.0 - 1.0
