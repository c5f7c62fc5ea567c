"""`hazard-ms perception check`: whether a dataset keeps every promise of its format."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.perception import coco, layout
from hazard_ms.perception.reading import mask_of, pixels_of
from hazard_ms.perception.rows import CHECKED, LARGEST
from hazard_ms.spec.foreign.files import inside, printable, sha256_of

FILES = ("file_name", "depth_file", "ids_file", "hazard_file")
MOST_TOLD = 50  # faults that are printed; the others are counted [ours]


def check(dataset: Path) -> int:
    """Print what is wrong with a dataset. Returns 1 if anything is, else 0. Raises ValueError for a folder of none."""
    splits = layout.splits_of(dataset)
    coco.tools()
    count = 0
    for count, fault in enumerate(faults(dataset), 1):
        if count <= MOST_TOLD:
            print(printable(fault), flush=True)
    pictures = sum(len(layout.read_instances(path, CHECKED)["images"]) for path in splits)
    print(f"{pictures} pictures, {f'{count} faults' if count else 'no faults'}")
    return int(count > 0)


def faults(dataset: Path) -> Iterator[str]:
    """All faults of a dataset, one line each. Raises ValueError for COCO files that cannot be read."""
    yield from _of_sums(dataset)
    rooms: dict[str, str] = {}
    moments: set[str] = set()
    for path in layout.splits_of(dataset):
        rows = layout.read_instances(path, CHECKED)
        of_image: dict[int, list[dict[str, Any]]] = {image["id"]: [] for image in rows["images"]}
        yield from _of_ids(path.name, rows)
        for annotation in rows["annotations"]:
            of_image.setdefault(annotation["image_id"], []).append(annotation)
        known = {row["id"] for row in rows["categories"]}
        for image in rows["images"]:
            moment = json.dumps([image["scene"], image["seed"], image["frame"], image["camera"]["cam2world"]])
            if moment in moments:
                yield f"{image['file_name']}: another picture shows the same frame from the same place"
            moments.add(moment)
            if rooms.setdefault(image["room"], path.name) != path.name:
                yield f"{image['file_name']}: its room {image['room']} is in {rooms[image['room']]}, too"
            try:
                for fault in _of_picture(dataset, image, of_image[image["id"]], known):
                    yield f"{image['file_name']}: {fault}"
            except ValueError as error:
                yield f"{image['file_name']}: {error}"


def _of_ids(name: str, rows: Mapping[str, Any]) -> Iterator[str]:
    """Ids of a COCO file that are not unique, or stand for nothing."""
    images = {image["id"] for image in rows["images"]}
    if len(images) != len(rows["images"]):
        yield f"{name}: two images have one id"
    if len({row["id"] for row in rows["annotations"]}) != len(rows["annotations"]):
        yield f"{name}: two annotations have one id"
    for row in rows["annotations"]:
        if row["image_id"] not in images:
            yield f"{name}: annotation {row['id']} is of no image"


def _of_sums(dataset: Path) -> Iterator[str]:
    """Files that are missing, changed, or not listed."""
    path = dataset / layout.SUMS
    try:
        listed = layout.read_sums(path)
    except ValueError as error:
        yield f"{layout.SUMS}: {error}"
        return
    for name, digest in listed.items():
        try:
            file = inside(dataset, name, f"a path in {layout.SUMS}")
            if not file.is_file():
                yield f"{name}: it is missing"
            elif sha256_of(file, LARGEST) != digest:
                yield f"{name}: its checksum is not that in {layout.SUMS}"
        except ValueError as error:
            yield str(error)
    for folder in layout.scene_folders(dataset):
        for file in sorted(folder.rglob("*")):
            name = file.relative_to(dataset).as_posix()
            if file.is_file() and name not in listed and file.name != layout.SUMS:
                yield f"{name}: it is not in {layout.SUMS}"


def _of_picture(
    dataset: Path, image: Mapping[str, Any], annotations: list[dict[str, Any]], known: set[int]
) -> Iterator[str]:
    """Faults of one picture and of its annotations."""
    paths = [inside(dataset, image[key], f"{key} of picture {image['id']}") for key in FILES]
    if lost := [image[key] for key, path in zip(FILES, paths, strict=True) if not path.is_file()]:
        yield f"missing: {', '.join(lost)}"
        return
    size = image["height"], image["width"]
    rgb, depth, ids = (pixels_of(dataset, image, key) for key in FILES[:3])
    for name, array, kind, shape in (
        ("colours", rgb, np.uint8, (*size, 3)),
        ("depth", depth, np.uint16, size),
        ("ids", ids, np.uint16, size),
    ):
        if array.dtype != kind or array.shape != shape:
            yield f"its {name} must be {np.dtype(kind).name} {shape}"
            return
    counts = np.bincount(ids.ravel())
    wanted = {b - 1 for b in np.flatnonzero(counts >= coco.LEAST_PIXELS).tolist() if b}
    told = [annotation["instance"] for annotation in annotations]
    if set(told) != wanted or len(told) != len(wanted):
        yield f"its annotations are of the things {sorted(told)}, its ids of {sorted(wanted)}"
    if (depth[ids > 0] == 0).any() and not image.get("degraded"):
        yield "a thing has no depth"
    for annotation in annotations:
        for fault in _of_annotation(annotation, ids, known):
            yield f"annotation {annotation['id']}: {fault}"


def _of_annotation(annotation: Mapping[str, Any], ids: NDArray[Any], known: set[int]) -> Iterator[str]:
    """Faults of one annotation, given its picture's `ids`, [H, W]."""
    if annotation["category_id"] not in known:
        yield f"there is no category {annotation['category_id']}"
    mask = ids == annotation["instance"] + 1
    size, where = (ids.shape[0], ids.shape[1]), f"annotation {annotation['id']}"
    if not np.array_equal(mask_of(annotation["segmentation"], size, where).astype(bool), mask):
        yield "its segmentation is not what the ids show"
    if mask.any() and annotation["bbox"] != coco.box_of(mask):
        yield f"its box {annotation['bbox']} is not the tight one, {coco.box_of(mask)}"
    if not annotation["area"] == annotation["attributes"]["pixels"] == int(mask.sum()):
        yield f"its area {annotation['area']} is not that of its {int(mask.sum())} pixels"
    if not 0.0 <= annotation["attributes"]["submerged"] <= 1.0:
        yield "its submerged share is not from 0 to 1"
    if "amodal_segmentation" in annotation:
        whole = mask_of(annotation["amodal_segmentation"], size, where).astype(bool)
        if (mask & ~whole).any():
            yield "its amodal mask does not hold its visible one"
