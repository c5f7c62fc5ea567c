"""The card of a dataset, README.md, and the licences of the models in its pictures."""

from __future__ import annotations

import csv
import io
import json
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from hazard_ms.perception import layout
from hazard_ms.perception.rows import COUNTED
from hazard_ms.perception.states import MOVING
from hazard_ms.scenes.assets.index import asset

TEXT = """\
# {env_id}: labelled pictures of hazards

Made with hazard_ms, format {format}. Every file and field is described in docs/perception.md of hazard_ms.

{tables}
Made by:

```json
{recipe}
```

Read it without hazard_ms:

```python
from pycocotools.coco import COCO

data = COCO("{first}")
image = data.loadImgs(data.getImgIds()[:1])[0]
for annotation in data.loadAnns(data.getAnnIds(image["id"])):
    print(annotation["name"], data.annToMask(annotation).sum(), annotation["attributes"])
```

All pictures are computed. `{licences}` names the licence and the author of every model in them, `{sums}` has the
checksum of every file: `sha256sum -c {sums}`.
"""
COLUMNS = ("id", "category", "licence", "author", "source")


def card(dataset: Path) -> str:
    """The text of the card of a dataset. Raises ValueError for a dataset that cannot be read."""
    splits = layout.splits_of(dataset)
    read = {path: layout.read_instances(path, COUNTED) for path in splits}
    tables = [f"## {path.stem.removeprefix('instances_')}\n\n{table(numbers(rows))}\n" for path, rows in read.items()]
    recipe = (read[splits[0]].get("info") or {}).get("recipe")
    if not isinstance(recipe, dict) or not isinstance(recipe.get("env_id"), str):
        raise ValueError(f"info of {splits[0]} must hold the recipe of `perception capture`, got none")
    return TEXT.format(
        env_id=recipe["env_id"],
        format=layout.FORMAT,
        tables="\n".join(tables),
        recipe=json.dumps(recipe, indent=1),
        first=splits[0].name,
        licences=layout.LICENCES,
        sums=layout.SUMS,
    )


def numbers(rows: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The contents of a COCO file in numbers: the name of each, and its value."""
    images, things = rows["images"], rows["annotations"]
    states = [thing["attributes"] for thing in things]
    with_target = len({t["image_id"] for t in things if t["attributes"]["target"]})

    def share(name: str, holds: Iterable[bool]) -> tuple[str, str]:
        return name, _share(sum(holds), len(states))

    return [
        ("pictures", str(len(images))),
        ("scenes", str(len({image["scene"] for image in images}))),
        ("pictures with a target", _share(with_target, len(images))),
        ("pictures with a hazard at work", _share(sum(i["hazard_visible"] for i in images), len(images))),
        ("light", _counts(image["lighting"] for image in images)),
        ("effects", _counts(image["effects"] for image in images)),
        ("annotations", str(len(things))),
        ("categories", str(len({thing["category_id"] for thing in things}))),
        share("of targets", (s["target"] for s in states)),
        share("burning", (s["status"] == "burning" for s in states)),
        share("burnt", (s["status"] == "burnt" for s in states)),
        share("partly or wholly under water", (s["submerged"] > 0.0 for s in states)),
        share("floating", (s["floating"] for s in states)),
        share("moving", (s["speed_mps"] > MOVING for s in states)),
        share("damaged", (s["damaged"] for s in states)),
        share("over 1,000 pixels", (s["pixels"] > 1000 for s in states)),
    ]


def table(rows: Iterable[tuple[str, str]]) -> str:
    """Numbers as a table in Markdown."""
    return "\n".join(f"| {name} | {text} |" for name, text in (("number", "value"), ("---", "---"), *rows)) + "\n"


def _share(part: int, whole: int) -> str:
    return f"{part} ({100 * part / max(whole, 1):.1f} %)"


def _counts(words: Iterable[str]) -> str:
    return ", ".join(f"{word} {count}" for word, count in sorted(Counter(words).items()))


def licences(dataset: Path) -> str:
    """The models in the pictures of a dataset with their licences and authors, as CSV."""
    scenes = map(layout.read_scene, layout.scene_folders(dataset))
    names = sorted({thing["asset"] for scene in scenes for thing in scene["things"]})
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(COLUMNS)
    rows.writerows([getattr(asset(name), column) for column in COLUMNS] for name in names)
    return text.getvalue()
