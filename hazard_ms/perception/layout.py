"""Names and forms of the files of a dataset; docs/perception.md describes every file and field.

OUT/HazardFire-v1/              a dataset
  instances_train.json          COCO instances of a split
  train/kitchen_a-07/           the pictures of one scene
    rgb/0000.jpg  depth/0000.png  ids/0000.png  hazard/0000.npz  (thermal/0000.npz)
    pictures.json               its part of the COCO file
    SHA256SUMS                  of its files
  README.md  LICENSES.csv  labels_table.json  SHA256SUMS
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from hazard_ms.perception import rows
from hazard_ms.spec.catalogue import CATEGORIES
from hazard_ms.spec.foreign.files import printable, read_text, sha256_of

FORMAT = 1  # goes up when a file or a field changes its meaning

RGB, DEPTH, IDS, HAZARD = "rgb", "depth", "ids", "hazard"  # folders of a scene
THERMAL, THERMAL_ENDING = "thermal", ".npz"  # one more, where it was asked for
ENDINGS = {RGB: ".jpg", DEPTH: ".png", IDS: ".png", HAZARD: ".npz"}
PICTURES, SUMS = "pictures.json", "SHA256SUMS"
CARD, LICENCES, TABLE = "README.md", "LICENSES.csv", "labels_table.json"
LARGEST_SUMS = 100_000_000  # [bytes] [ours]
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


def sums_of(folder: Path, names: Iterable[str]) -> str:
    """The checksums of files by their paths in `folder`, as `sha256sum -c` reads them."""
    return "".join(f"{sha256_of(folder / name)}  {name}\n" for name in sorted(names))


def read_sums(path: Path) -> dict[str, str]:
    """The checksums in a file by path. Raises ValueError for a file that cannot be read, and a line that holds none."""
    found = {}
    for line in filter(None, read_text(path, LARGEST_SUMS).split("\n")):
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
    shown = printable(str(path))
    found: dict[str, Any] = rows.read_json(path)
    if not isinstance(found, dict) or "format" not in found:
        raise ValueError(f"{shown} must be a file of `perception capture`, got another file; delete its folder")
    if found["format"] != FORMAT:
        raise ValueError(f"the format of {shown} must be {FORMAT}, got {found['format']!r:.100}; capture it again")
    if not isinstance(found.get("scene"), str) or not isinstance(found.get("recipe"), dict):
        raise ValueError(f"{shown} must name its scene and its recipe, got none; delete its folder")
    rows.check_rows({"categories": [], **found}, shown, rows.COUNTED)
    if not isinstance(found.get("things"), list):
        raise ValueError(f"{shown} must hold a list of things, got none; delete its folder")
    for k, thing in enumerate(found["things"]):
        rows.typed(rows.Thing, thing, f"things[{k}] of {shown}")
    return found


def read_instances(path: Path, needs: rows.Needs) -> dict[str, Any]:
    """The COCO file at `path`, whose rows have what a reader `needs`.

    Raises ValueError for one that cannot be read, for one without pictures, and for rows of other types.
    """
    found: dict[str, Any] = rows.read_json(path)
    rows.check_rows(found, printable(str(path)), needs)
    if not found["images"]:
        raise ValueError(f"{printable(str(path))} must hold images, annotations and categories, got no images")
    return found


def splits_of(dataset: Path) -> list[Path]:
    """The COCO files of a dataset. Raises ValueError for a folder that is none."""
    found = sorted(dataset.glob(instances("*")))
    if not found:
        raise ValueError(f"folder must be a dataset of `hazard-ms perception capture`, got {dataset}")
    return found
