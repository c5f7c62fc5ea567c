"""A dataset folder for Hugging Face's `datasets`: an ImageFolder with metadata, and a card.

    README.md                        the card, with front matter in YAML
    data/SPLIT/000000000001.jpg
    data/SPLIT/metadata.jsonl        a line for each picture: file_name, its moment, and lists of its `objects`

`datasets.load_dataset("imagefolder", data_dir=FOLDER)`, and the Hub, read it. Masks are COCO's compressed run lengths.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hazard_ms.perception.exports.licences import licence_of
from hazard_ms.perception.exports.source import Picture, Source
from hazard_ms.perception.layout import text_of

SIZES = ((1_000, "n<1K"), (10_000, "1K<n<10K"), (100_000, "10K<n<100K"), (1_000_000, "100K<n<1M"))  # [the Hub]
STATES: dict[str, Any] = {
    "target": False,
    "status": "",
    "wet": False,
    "submerged": 0.0,
    "floating": False,
    "damaged": False,
}
CARD = """\
---
pretty_name: {title}
{licence}
task_categories:
- object-detection
- image-segmentation
tags:
- instance-segmentation
- synthetic
- simulation
- robotics
- disaster
size_categories:
- {size}
configs:
- config_name: default
  drop_labels: true
  data_files:
{files}
---

# {title}

Computed pictures with a mask, a box and a category for every thing{about}.

| split | pictures |
|---|---|
{counts}

```python
from datasets import load_dataset
from pycocotools import mask

row = load_dataset("imagefolder", data_dir="FOLDER", split="{first}")[0]
for name, runs in zip(row["objects"]["category"], row["objects"]["segmentation"]):
    print(name, mask.decode(runs).sum())
```

`objects` holds a list for each of `id`, `category`, `category_id`, `bbox` (left, top, width, height in pixels), `area`,
`iscrowd`, `segmentation` (COCO's run lengths: `size` and `counts`){states}. Categories are those of the source, by id:

{categories}

Splits are those of the source. Exported by `hazard-ms perception export --to hf`.
"""


def write(source: Source, folder: Path) -> None:
    """Write the dataset into `folder`, which is empty. Raises ValueError for what cannot be exported."""
    stated = False
    for split in source.splits():
        place = folder / "data" / split.name
        place.mkdir(parents=True)
        with (place / "metadata.jsonl").open("w", encoding="utf-8") as file:
            for picture in split.pictures():
                (place / picture.name).write_bytes(picture.content)
                stated |= any(thing.state for thing in picture.things)
                file.write(text_of(row_of(picture, source.categories)))
    (folder / "README.md").write_text(card(source, stated), encoding="utf-8")


def row_of(picture: Picture, names: Mapping[int, str]) -> dict[str, Any]:
    """The line of metadata for a picture. Fractions stay fractions, so that all lines have the same types."""
    things = picture.things
    objects: dict[str, list[Any]] = {
        "id": [thing.id for thing in things],
        "category": [names[thing.category] for thing in things],
        "category_id": [thing.category for thing in things],
        "bbox": [[float(n) for n in thing.box] for thing in things],
        "area": [float(thing.area) for thing in things],
        "iscrowd": [int(thing.crowd) for thing in things],
        "segmentation": [thing.runs for thing in things],
    }
    if any(thing.state for thing in things):
        for key, usual in STATES.items():
            objects[key] = [type(usual)(thing.state.get(key, usual)) for thing in things]
    size = {"width": picture.width, "height": picture.height}
    return {"file_name": picture.name, "image_id": picture.id, **size, **picture.moment, "objects": objects}


def card(source: Source, stated: bool) -> str:
    """The text of README.md; `stated`: things have states that a hazard has changed."""
    total = sum(source.counts.values())
    title = source.dataset.resolve().name
    return CARD.format(
        title=json.dumps(title),
        licence=licence_of(source.dataset),
        size=next((name for most, name in SIZES if total < most), "1M<n<10M"),
        files="\n".join(f"  - split: {name}\n    path: data/{name}/**" for name in source.counts),
        about=", and what fire, water or wind has done to it" if stated else "",
        counts="\n".join(f"| {name} | {count} |" for name, count in source.counts.items()),
        first=next(iter(source.counts)),
        states=f", and of the states {', '.join(f'`{key}`' for key in STATES)}" if stated else "",
        categories=", ".join(f"{number} {name}" for number, name in source.categories.items()),
    )
