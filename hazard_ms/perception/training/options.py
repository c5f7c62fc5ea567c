"""Options of `hazard-ms perception train` as plain data: loading them for a help text imports nothing heavy."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from hazard_ms.evaluation.choices import flag
from hazard_ms.perception.options import LARGEST, SMALLEST

UNTRAINED = "none"  # weights to begin with
MOST_STEPS, MOST_BATCH = 10**8, 4096  # [ours]
SIDES = 32  # of which those of the crops of small are multiples [pixels]
SIZES = {
    "small": 160,
    "mask_rcnn": 192,
}  # of crops, and of pictures for an untrained network [pixels] [ours]


@dataclass(frozen=True)
class TrainOptions:
    """Options of `hazard-ms perception train`."""

    data: Annotated[tuple[Path, ...], tyro.conf.Positional]
    """Datasets, OUTPUT/TASK; one or more."""
    output: Annotated[Path, flag("-o")]
    """Folder for MODEL.safetensors, MODEL.json, MODEL.csv and MODEL.svg (the curve) and MODEL.training."""
    model: Literal["mask_rcnn", "small", "second_stage"] = "mask_rcnn"
    """Network to train: Mask R-CNN of torchvision, the small detector, which also uses depth, or the second stage of a
    trained small detector, which names what that one finds."""
    weights: str = UNTRAINED
    """File .pth or .safetensors to begin with: torchvision's COCO weights, or an earlier training's; for small those of
    another small one, with its NAME.json; for second_stage those of its first stage, or of both; none: random weights,
    for Mask R-CNN of a smaller network."""
    split: str = "train"
    """Split to learn from."""
    validate: tuple[Path, ...] = ()
    """Datasets to score the network on, in rooms that it did not learn from."""
    validate_split: str = "test"
    """Split of the datasets in --validate."""
    epochs: float = 12.0
    """Passes over the pictures after which training ends."""
    steps: int | None = None
    """Steps after which training ends, in place of epochs."""
    minutes: float = 1e6
    """Wall time after which training ends, if it has not ended before [min]."""
    every: int = 500
    """Interval in steps at which files are written and the network is scored."""
    seed: Annotated[int, flag("-s")] = 0
    """Seed of weights, pictures and crops."""
    batch: int | None = None
    """Pictures or crops per step; by default 2, with small 8, with second_stage 64 things."""
    size: int | None = None
    """Shorter side to which Mask R-CNN brings pictures (by default 192 untrained, else as `weights` learned, or
    torchvision's), or side of the crops of small (160, a multiple of 32), in pixels."""

    def check(self) -> None:
        """Check all options. Raises ValueError for invalid ones."""
        from hazard_ms.spec.checks import whole  # loads numpy

        if not self.data:
            raise ValueError("DATA must be at least one dataset, got none")
        for name, number in (("epochs", self.epochs), ("minutes", self.minutes)):
            if not number > 0:
                raise ValueError(f"{name} must be positive, got {number!r}")
        if not math.isfinite(self.epochs):
            raise ValueError(f"epochs must be finite, got {self.epochs!r}: give --steps instead")
        for name, count, most in (("steps", self.steps, MOST_STEPS), ("batch", self.batch, MOST_BATCH)):
            if count is not None:
                whole(count, 1, most, name)
        whole(self.every, 1, MOST_STEPS, "every")
        whole(self.seed, 0, 2**31 - 1, "seed")
        if self.size is not None:
            whole(self.size, SMALLEST, LARGEST, "size")
        if self.model == "small" and (self.size or 0) % SIDES:
            raise ValueError(f"size must be a multiple of {SIDES} for the model small, got {self.size}")

    @property
    def batch_size(self) -> int:
        """Pictures or crops of a step."""
        return self.batch or {"small": 8, "mask_rcnn": 2, "second_stage": 64}[self.model]

    @property
    def command(self) -> str:
        """The command that resumes this training, without what may change on the way."""
        given: dict[str, Any] = {"model": self.model, "weights": self.weights, "split": self.split, "seed": self.seed}
        given |= {"batch": self.batch_size} | ({"size": self.size} if self.size else {})
        words = [f"--{name} {value}" for name, value in given.items()]
        return " ".join(["hazard-ms perception train", *map(str, self.data), *words])
