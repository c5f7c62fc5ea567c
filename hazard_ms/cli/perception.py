"""The commands `hazard-ms perception ...`; each imports what it needs when it is called, so that help is quick."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import tyro

from hazard_ms.evaluation.choices import flag
from hazard_ms.perception.options import CaptureOptions
from hazard_ms.perception.training.options import TrainOptions

Folder = tyro.conf.Positional[Path]


def capture(options: Annotated[tyro.conf.OmitArgPrefixes[CaptureOptions], tyro.conf.arg(name="")]) -> int:
    """Take labelled pictures of burning, flooded or wind-blown scenes, as COCO data with the state of every thing.

    Resumes an interrupted run. Pictures depend on task, split, scene and seed alone. Exits with 1 if a scene failed.
    """
    from hazard_ms.perception.capture import capture as run

    return run(options)


def check(folder: Folder) -> int:
    """Verify every promise of the format: files, checksums, masks, boxes, splits. Exits with 1 if any is broken.

    Args:
        folder: A dataset, OUTPUT/TASK.
    """
    from hazard_ms.perception.check import check as run

    return run(folder)


def show(
    folder: Folder, output: Annotated[Path, flag("-o")] = Path("perception.html"), pictures: int = 24, things: int = 0
) -> int:
    """Write a page about a dataset: pictures with masks and states, and statistics.

    Args:
        folder: A dataset, OUTPUT/TASK.
        output: Page to write, NAME.html; NAME.png or NAME.jpg gets the pictures alone.
        pictures: Number of pictures shown of each split.
        things: Number of things shown one by one of each split, drawn at random; on a sheet, instead of pictures.
    """
    from hazard_ms.perception.show import show as run

    print(f"page: {run(folder, output, pictures, things).resolve()}")
    return 0


def score(folder: Folder, results: tyro.conf.Positional[Path], split: str = "test") -> int:
    """Print the average precision of a detector, overall and by hazard state, pixel area and distance.

    Args:
        folder: A dataset, OUTPUT/TASK.
        results: What the detector found, in COCO's results format: a list of image_id, category_id, score, and bbox or
            segmentation or both.
        split: Split to score on.
    """
    from hazard_ms.perception.score import score as run

    print(run(folder, results, split))
    return 0


def export(folder: Folder, to: Literal["yolo", "hf", "coco"], output: Annotated[Path, flag("-o")]) -> int:
    """Write a dataset in the layout that other trainers read: YOLO's label files, a Hugging Face folder, or plain COCO.

    The new folder appears whole or not at all.

    Args:
        folder: A dataset, OUTPUT/TASK, or any folder with COCO files instances_SPLIT.json.
        to: Layout: yolo (polygons and data.yaml), hf (ImageFolder with metadata and a card), or coco.
        output: Folder to make; it must not exist yet.
    """
    from hazard_ms.perception.exports.export import export as run

    print(f"{output}: {run(folder, to, output)} pictures")
    return 0


def train(options: Annotated[tyro.conf.OmitArgPrefixes[TrainOptions], tyro.conf.arg(name="")]) -> int:
    """Train a detector on captured pictures, and score it on others: Mask R-CNN, or our small one.

    The same command resumes an interrupted training; with more --steps, --epochs or --minutes it continues a finished
    one. With `--perception MODEL:FILE`, agents see through the detector.
    """
    from hazard_ms.perception.training.run import train as run

    return run(options)


def calibrate(
    folders: tyro.conf.Positional[tuple[Path, ...]],
    perception: str = "small",
    split: tuple[str, ...] = ("test",),
    every: int = 1,
    output: Annotated[Path | None, flag("-o")] = None,
) -> int:
    """Count the errors of a detector in pictures that it was not trained on; print how reliable beliefs from it are.

    Agents that see through the detector weigh its detections by the table, if it lies beside the weights.

    Args:
        folders: Datasets, OUTPUT/TASK.
        perception: The detector, as `hazard-ms play --perception` takes it.
        split: Splits whose pictures are used; each dataset must have at least one of them.
        every: Use every n-th pixel, both ways: with 4, a width of 1024 pixels becomes 256.
        output: File for the table, NAME_confusion.json beside the weights NAME.safetensors.
    """
    from hazard_ms.perception.calibration.command import calibrate as run

    print(run(folders, perception, split, every, output))
    return 0


PerceptionCommand = (
    Annotated[int, tyro.conf.subcommand(name="capture", constructor=capture)]
    | Annotated[int, tyro.conf.subcommand(name="check", constructor=check)]
    | Annotated[int, tyro.conf.subcommand(name="show", constructor=show)]
    | Annotated[int, tyro.conf.subcommand(name="score", constructor=score)]
    | Annotated[int, tyro.conf.subcommand(name="export", constructor=export)]
    | Annotated[int, tyro.conf.subcommand(name="train", constructor=train)]
    | Annotated[int, tyro.conf.subcommand(name="calibrate", constructor=calibrate)]
)
