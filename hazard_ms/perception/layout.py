"""Names and forms of the files of a dataset; docs/perception.md describes every file and field.

OUT/HazardFire-v1/              a dataset
  instances_train.json          COCO instances of a split
  train/kitchen_a-07/           the pictures of one scene
    rgb/0000.jpg  depth/0000.png  ids/0000.png  hazard/0000.npz
    pictures.json               its part of the COCO file
    SHA256SUMS                  of its files
  README.md  LICENSES.csv  labels_table.json  SHA256SUMS
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from hazard_ms.spec.catalogue import CATEGORIES

FORMAT = 1  # goes up when a file or a field changes its meaning

RGB, DEPTH, IDS, HAZARD = "rgb", "depth", "ids", "hazard"  # folders of a scene
ENDINGS = {RGB: ".jpg", DEPTH: ".png", IDS: ".png", HAZARD: ".npz"}
PICTURES, SUMS = "pictures.json", "SHA256SUMS"
CARD, LICENCES, TABLE = "README.md", "LICENSES.csv", "labels_table.json"
HASHED_AT_ONCE = 2**20  # [bytes] [ours]
FIRST_FIXTURE = 1001  # id of the first category of furniture; things that move begin at 1


def instances(split: str) -> str:
    """The name of the COCO file of a split."""
    return f"instances_{split}.json"


def folder_of(scene: str) -> str:
    """The name of the folder of a scene, "kitchen_a-07" of "kitchen_a/07"."""
    return scene.replace("/", "-")


def room_of(scene: str) -> str:
    """The room that a scene is a furnishing of: "kitchen_a" of "kitchen_a/07"."""
    return scene.split("/")[0]


def category_ids() -> dict[str, int]:
    """The id of each category: things that move from 1 on, furniture from FIRST_FIXTURE on, as in the catalogue."""
    kinds = {kind: [c.name for c in CATEGORIES.values() if c.kind == kind] for kind in ("object", "fixture")}
    moving = {name: 1 + k for k, name in enumerate(kinds["object"])}
    return moving | {name: FIRST_FIXTURE + k for k, name in enumerate(kinds["fixture"])}


def categories() -> list[dict[str, Any]]:
    """The categories of every COCO file, with what decides whether a hazard damages one."""
    kept = ("kind", "value", "flammable", "waterproof", "ignition_temperature", "density")
    rows = []
    for name, number in category_ids().items():
        row = CATEGORIES[name]
        rows.append({"id": number, "name": name, "supercategory": row.kind, **{k: getattr(row, k) for k in kept}})
    return rows


def text_of(row: Any, indent: int | None = None) -> str:
    """A file's text of JSON; its bytes depend on `row` alone. Raises ValueError for numbers that are not finite."""
    return json.dumps(row, indent=indent, allow_nan=False, separators=None if indent else (",", ":")) + "\n"


def sha256(path: Path) -> str:
    """The SHA-256 of a file."""
    found = hashlib.sha256()
    with path.open("rb") as file:
        while part := file.read(HASHED_AT_ONCE):
            found.update(part)
    return found.hexdigest()


def sums_of(folder: Path, names: Iterable[str]) -> str:
    """The checksums of files by their paths in `folder`, as `sha256sum -c` reads them."""
    return "".join(f"{sha256(folder / name)}  {name}\n" for name in sorted(names))


def read_sums(text: str) -> dict[str, str]:
    """Checksums by path. Raises ValueError for a line that holds none."""
    found = {}
    for line in filter(None, text.splitlines()):
        digest, _, name = line.partition("  ")
        if len(digest) != 64 or not name:
            raise ValueError(f"a line of {SUMS} must hold a checksum and a path, got {line!r:.100}")
        found[name] = digest
    return found


def scene_folders(dataset: Path) -> list[Path]:
    """The folders of all scenes of a dataset, split by split."""
    return sorted(path.parent for path in dataset.glob(f"*/*/{PICTURES}") if not path.parent.name.startswith("."))


def read_scene(place: Path) -> dict[str, Any]:
    """The part of the COCO file that one scene's folder holds. Raises ValueError for one that cannot be read."""
    path = place / PICTURES
    try:
        found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        number = found["format"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{path} must be a file of `perception capture`, got {error!r}; delete its folder") from None
    if number != FORMAT:
        raise ValueError(f"the format of {path} must be {FORMAT}, got {number!r:.100}; capture it again")
    return found


def read_instances(path: Path) -> dict[str, Any]:
    """The COCO file at `path`. Raises ValueError for one that cannot be read, and for one without pictures."""
    try:
        found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        whole = all(isinstance(found[key], list) for key in ("images", "annotations", "categories"))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{path} must be a COCO file of `perception capture`, got {error!r:.200}") from None
    if not whole or not found["images"]:
        raise ValueError(f"{path} must hold images, annotations and categories, got none of some")
    return found


def splits_of(dataset: Path) -> list[Path]:
    """The COCO files of a dataset. Raises ValueError for a folder that is none."""
    found = sorted(dataset.glob(instances("*")))
    if not found:
        raise ValueError(f"folder must be a dataset of `hazard-ms perception capture`, got {dataset}")
    return found
