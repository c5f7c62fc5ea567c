"""Label files for YOLO's instance segmentation, in the layout of https://docs.ultralytics.com/datasets/segment/.

    data.yaml                      splits and names of classes
    images/SPLIT/000000000001.jpg
    labels/SPLIT/000000000001.txt  a row for each thing: class x1 y1 x2 y2 ..., shares of width and height

Classes are the categories in the order of their ids, from 0. Pictures without things have an empty label file. What
COCO marks as a crowd is left out. See `.polygons` for masks of several parts and with holes.
"""

from __future__ import annotations

from pathlib import Path

from hazard_ms.perception.exports import polygons
from hazard_ms.perception.exports.source import Source

VALIDATION = ("val", "valid", "validation", "test")  # splits that can serve as YOLO's `val`, best first
HEAD = """\
# Instance segmentation for YOLO, exported by hazard_ms; paths are relative to this file
"""


def write(source: Source, folder: Path) -> None:
    """Write the dataset into `folder`, which is empty. Raises ValueError for what cannot be exported."""
    classes = {number: k for k, number in enumerate(source.categories)}
    for split in source.splits():
        images, labels = folder / "images" / split.name, folder / "labels" / split.name
        images.mkdir(parents=True)
        labels.mkdir(parents=True)
        for picture in split.pictures():
            (images / picture.name).write_bytes(picture.content)
            rows = [polygons.text(classes[thing.category], thing.mask) for thing in picture.things if not thing.crowd]
            told = "".join(f"{row}\n" for row in rows)
            (labels / picture.name).with_suffix(".txt").write_text(told, encoding="utf-8")
    (folder / "data.yaml").write_text(described(source), encoding="utf-8")


def described(source: Source) -> str:
    """The text of data.yaml. YOLO needs `train` and `val`: what is missing is named by the nearest split there is."""
    named = {name: name for name in source.counts}
    named.setdefault("train", next(iter(source.counts)))
    named.setdefault("val", next((name for name in VALIDATION if name in source.counts), named["train"]))
    keys = sorted(named, key=lambda name: (("train", "val", "test") + (name,)).index(name))
    lines = [f"{key}: images/{named[key]}{'' if key == named[key] else '  # there is no such split'}" for key in keys]
    names = [f'  {k}: "{name}"' for k, name in enumerate(source.categories.values())]
    return HEAD + "\n".join([*lines, "names:", *names]) + "\n"
