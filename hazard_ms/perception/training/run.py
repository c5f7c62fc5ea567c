"""A training and its files, which are written together at every check.

MODEL.safetensors and MODEL.json are what `--perception` loads, MODEL.csv and MODEL.svg show the curve, and
MODEL.training holds all that is needed to resume. What is drawn at a step depends on the seed and the step alone, so
that an interrupted training continues exactly as if it had not been.
"""

from __future__ import annotations

import io
import json
import math
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from safetensors.torch import save

from hazard_ms.perception import coco
from hazard_ms.perception.detectors.mask_rcnn import NETWORKS
from hazard_ms.perception.detectors.small import NETWORK
from hazard_ms.perception.detectors.weights import checked_recipe, read_saved
from hazard_ms.perception.score import KINDS, average_precision, table
from hazard_ms.perception.training.curve import csv_of, svg_of
from hazard_ms.perception.training.options import MOST_STEPS, SIZES, UNTRAINED, TrainOptions
from hazard_ms.perception.training.pictures import Picture, read, truth_of
from hazard_ms.perception.training.student import Student
from hazard_ms.perception.training.validation import results_of, spread
from hazard_ms.spec.checks import whole
from hazard_ms.spec.foreign.plain import made
from hazard_ms.spec.storage.files import make_folder, write_together

MAX_GRADIENT_NORM = 10.0  # to which longer gradients are cut [ours]
SCORED = 60  # validation pictures on which a network is scored on the way; at the end it is on all of them [ours]
SCORES = {"box": "bbox", "mask": "segm"}
ENDING, RESUMABLE = ".safetensors", ".training"


def train(options: TrainOptions) -> int:
    """Train a detector, or go on with an interrupted training. Returns 0.

    Raises ValueError for options and files that cannot be used, and for a loss that is not finite.
    """
    options.check()
    if options.validate:
        coco.tools()
    path = options.output / f"{options.model}{ENDING}"
    before = _before(path, options.command)
    if before is None and options.weights != UNTRAINED and not Path(options.weights).is_file():
        raise ValueError(f"weights must be a file .pth or .safetensors, got {options.weights}: there is no such file")
    pictures = read(options.data, options.split)
    validation = read(options.validate, options.validate_split) if options.validate else []
    make_folder(options.output)
    torch.manual_seed(options.seed)
    run = Run(path, options, student(options, pictures, before), validation)
    if before is not None:
        run.resume(before)
    steps = options.steps or max(1, math.ceil(options.epochs * len(pictures) / options.batch_size))
    print(f"{len(pictures)} pictures, {len(run.student.classes)} categories, {steps:,} steps", flush=True)
    run.train(steps, options.minutes)
    detector = "mask_rcnn" if options.model == "mask_rcnn" else "small"
    print(f"hazard-ms evaluate -e {options.data[0].name} --perception {detector}:{path}")
    return 0


def student(options: TrainOptions, pictures: Sequence[Picture], before: dict[str, Any] | None = None) -> Student:
    """The network that `options` ask for, with its pictures; `before`: what is kept of a training that goes on.

    Raises ValueError for pictures of things that such a training did not begin with.
    """
    recipe = before["recipe"] if before else None
    weights = None if options.weights == UNTRAINED else Path(options.weights)
    size = options.size or (SIZES.get(options.model) if weights is None or options.model == "small" else None)
    if options.model == "small":
        from hazard_ms.perception.training.small import SmallStudent

        assert size is not None
        return SmallStudent(pictures, options.batch_size, size, recipe, weights)
    if options.model == "second_stage":
        from hazard_ms.perception.training.second_stage import SecondStageStudent

        return SecondStageStudent(pictures, options.batch_size, weights, recipe, options.seed)
    from hazard_ms.perception.training.mask_rcnn import MaskRcnnStudent

    return MaskRcnnStudent(pictures, options.batch_size, size, weights, recipe)


def _before(path: Path, command: str) -> dict[str, Any] | None:
    """What is kept of an interrupted training by the same command; None if there is none.

    Raises ValueError if it is by another command, or damaged.
    """
    kept = path.with_suffix(RESUMABLE)
    if not kept.exists():
        return None
    try:
        found: dict[str, Any] = read_saved(kept)
        made_by = made(str, found["command"], "command")
        checked_recipe(found["recipe"], "the recipe", (*NETWORKS, NETWORK))
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{kept} must be the state of a training, got {error!r:.200}; delete it") from None
    if made_by != command:
        raise ValueError(
            f"{kept} must belong to the training `{command}`, got `{made_by}`: give another folder, or delete it"
        )
    return found


class Run:
    """Trains a student, scores it on the way, and keeps what it becomes."""

    def __init__(self, path: Path, options: TrainOptions, student: Student, validation: Sequence[Picture]) -> None:
        """Keep files beside `path`, NAME.safetensors; `validation`: the pictures on which it is scored."""
        self.path, self.student, self._options, self._validation = path, student, options, list(validation)
        self.rows: list[dict[str, float]] = []  # of the curve, one for each check
        self._step, self._seconds = 0, 0.0
        self._sums: dict[str, float] = {}  # of the parts of the loss since the last check
        self._count = 0

    def resume(self, before: dict[str, Any]) -> None:
        """Go on from what was kept. Raises ValueError for what does not fit."""
        try:
            self.student.resume(before["student"])
            self.rows = list(made(tuple[dict[str, float], ...], before["rows"], "rows"))
            self._step = whole(before["step"], 0, MOST_STEPS, "step")
            self._seconds = made(float, before["seconds"], "seconds")
        except Exception as error:  # torch raises errors of many kinds for what does not fit
            kept = self.path.with_suffix(RESUMABLE)
            raise ValueError(f"{kept} must be the state of this training, got {error!r:.200}; delete it") from None
        print(f"resumes at step {self._step:,}", flush=True)

    def train(self, steps: int, minutes: float) -> None:
        """Learn until there were `steps` in all, or for `minutes` in all, and print how it gets on."""
        start = time.monotonic() - self._seconds
        self.student.network.train()
        while self._step < steps and self._seconds < 60.0 * minutes:
            self._learn(max(self._step / steps, self._seconds / (60.0 * minutes)))
            self._seconds = time.monotonic() - start
            if self._step % self._options.every == 0:
                self._check(steps, minutes)
        if self._count:
            self._check(steps, minutes)
        if self._validation:
            print(self.scores(), flush=True)

    def _learn(self, share: float) -> None:
        """One step, when this `share` of the training is over. Raises ValueError for a loss that is not finite."""
        student = self.student
        chance = np.random.default_rng([self._options.seed, self._step])
        torch.manual_seed(int(chance.integers(2**31)))
        for group in student.optimiser.param_groups:
            group["lr"] = student.pace(self._step, share)
        parts = student.losses(chance)
        loss = torch.stack(list(parts.values())).sum()
        if not bool(torch.isfinite(loss)):
            raise ValueError(
                f"loss must stay finite, got {float(loss)} at step {self._step}: begin again with another --seed"
            )
        student.optimiser.zero_grad(set_to_none=True)
        loss.backward()
        norm = torch.nn.utils.clip_grad_norm_(student.network.parameters(), MAX_GRADIENT_NORM)
        if not bool(torch.isfinite(norm)):
            raise ValueError(f"gradients must stay finite, got {float(norm)} at step {self._step}: try another --seed")
        student.optimiser.step()
        student.learned()
        self._step += 1
        self._count += 1
        for name, part in {"loss": loss, **{f"loss {name}": part for name, part in parts.items()}}.items():
            self._sums[name] = self._sums.get(name, 0.0) + float(part.detach())

    def _check(self, steps: int, minutes: float) -> None:
        """Score the network, write all files, and print a line."""
        row = {"step": float(self._step), "seconds": self._seconds}
        row |= {name: total / self._count for name, total in self._sums.items()}
        self._sums, self._count = {}, 0
        if self._validation:
            row |= self._scored(spread(self._validation, SCORED))
        last = self.rows[-1] if self.rows else {"step": 0.0, "seconds": 0.0}
        rate = (row["step"] - last["step"]) / max(row["seconds"] - last["seconds"], 1e-9)
        self.rows.append(row)
        self._write()
        left = min((steps - self._step) / max(rate, 1e-9), 60.0 * minutes - self._seconds) / 60.0
        told = ", ".join(f"{name} {value:.3f}" for name, value in row.items() if name not in ("step", "seconds"))
        print(f"{self._step:,} steps, {rate:.2f}/s: {told}; {max(left, 0.0):.0f} min left", flush=True)

    def _scored(self, pictures: Sequence[Picture]) -> dict[str, float]:
        """AP and AP50 of boxes and masks on some pictures."""
        truth = truth_of(pictures, self.student.classes)
        found = results_of(self.student.detector(), pictures)
        made: dict[str, float] = {}
        for name, kind in SCORES.items():
            made[f"{name} AP"], made[f"{name} AP50"], _ = average_precision(truth, found, kind)
        return made

    def scores(self) -> str:
        """Tables of the network's average precision on all validation pictures, by hazard state, area and distance."""
        truth = truth_of(self._validation, self.student.classes)
        found = results_of(self.student.detector(), self._validation)
        return "\n".join(f"{KINDS[kind]}\n\n{table(truth, found, kind)}" for kind in KINDS)

    def _write(self) -> None:
        recipe = {**self.student.recipe(), "command": self._options.command, "step": self._step}
        packed = io.BytesIO()
        kept = {"command": self._options.command, "recipe": self.student.recipe(), "rows": self.rows}
        torch.save({**kept, "student": self.student.state(), "step": self._step, "seconds": self._seconds}, packed)
        parts: dict[str, str | bytes] = {
            ENDING: save(self.student.weights()),
            ".json": json.dumps(recipe, indent=1, allow_nan=False) + "\n",
            ".csv": csv_of(self.rows),
            ".svg": svg_of(self.rows, [f"{name} {what}" for name in SCORES for what in ("AP", "AP50")]),
            RESUMABLE: packed.getvalue(),
        }
        write_together({self.path.with_suffix(ending): content for ending, content in parts.items()})
