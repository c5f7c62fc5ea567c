"""Labelled pictures of hazards, read by pycocotools and by torchvision, without any code of ours.

    hazard-ms perception capture -e HazardFire-v1 --scenes kitchen_a/00 --per-scene 16 --size 256 -o data
    python examples/export_coco.py data/HazardFire-v1/instances_train.json

It counts the things of each state, and hands the pictures to a training loop of torchvision as tensors.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import torch
from pycocotools.coco import COCO
from torchvision.datasets import CocoDetection, wrap_dataset_for_transforms_v2
from torchvision.transforms import v2


def counts(path: Path) -> Counter[str]:
    """Annotations by what the hazard has done to the thing, read with pycocotools."""
    data = COCO(path)
    rows = [row["attributes"] for row in data.loadAnns(data.getAnnIds())]
    return Counter("under water" if row["submerged"] > 0.0 else row["status"] for row in rows)


def training_set(path: Path) -> CocoDetection:
    """The pictures with boxes, labels and masks, as torchvision's detectors train on them."""
    to_tensors = v2.Compose([v2.ToImage(), v2.RandomHorizontalFlip(0.5), v2.ToDtype(torch.float32, scale=True)])
    read = CocoDetection(str(path.parent), str(path), transforms=to_tensors)
    return wrap_dataset_for_transforms_v2(read, target_keys=("boxes", "labels", "masks"))


def main(words: Sequence[str] | None = None) -> None:
    """Print what a COCO file holds, and the first picture as a detector gets it."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("instances", type=Path, help="OUTPUT/TASK/instances_SPLIT.json")
    path = parser.parse_args(words).instances
    for state, count in counts(path).most_common():
        print(f"{state}: {count}")
    picture, target = training_set(path)[0]
    print(f"picture {tuple(picture.shape)}, boxes {tuple(target['boxes'].shape)}, masks {tuple(target['masks'].shape)}")


if __name__ == "__main__":
    main()
