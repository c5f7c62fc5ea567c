"""`hazard-ms perception score`: average precision of any detector, overall and by hazard state, area and distance."""

from __future__ import annotations

import contextlib
import copy
import io
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from hazard_ms.perception import coco, layout
from hazard_ms.perception.reading import check_runs, check_shape
from hazard_ms.perception.rows import SCORED, Detection, by_image, check_unique, read_json, typed
from hazard_ms.perception.states import MOVING
from hazard_ms.spec.foreign.files import printable

Row = Mapping[str, Any]
STATES: dict[str, Callable[[Row], bool]] = {  # of an annotation's attributes
    "dry, not burnt": lambda a: a["status"] == "normal" and not a["wet"],
    "burning": lambda a: a["status"] == "burning",
    "burnt": lambda a: a["status"] == "burnt",
    "wet": lambda a: a["wet"],
    "more than half under water": lambda a: a["submerged"] > 0.5,
    "floating": lambda a: a["floating"],
    "moving": lambda a: a["speed_mps"] > MOVING,
    "damaged": lambda a: a["damaged"],
}
AREAS = (0, 256, 1024, 4096, math.inf)  # ends of the groups by visible area [pixels] [ours]
DISTANCES = (0, 1, 2, 4, math.inf)  # ends of the groups by distance from the camera [m] [ours]
EVERY = (0.0, math.inf)  # of areas
KEPT = ("image_id", "category_id", "score", "bbox", "segmentation")  # of a detection
MOST_FOUND = 100  # detections of a picture that count, as in COCO
KINDS = {"bbox": "boxes", "segm": "masks"}


def score(dataset: Path, results: Path, split: str) -> str:
    """Tables of the average precision of what a detector found in a split, as text.

    `results`: a file in COCO's results format. Raises ValueError for a dataset or results that cannot be read, and for
    detections of unknown pictures or categories.
    """
    coco.tools()
    path = dataset / layout.instances(split)
    if not path.is_file():
        known = ", ".join(p.stem.removeprefix("instances_") for p in layout.splits_of(dataset))
        raise ValueError(f"split must be one of {known} in {dataset}, got {split!r}")
    truth = layout.read_instances(path, SCORED)
    _check_truth(truth, path.name)
    found = read_results(results, truth)
    kinds = [kind for kind, key in (("bbox", "bbox"), ("segm", "segmentation")) if all(key in row for row in found)]
    return "\n".join(f"{KINDS[kind]}\n\n{table(truth, found, kind)}" for kind in kinds)


def read_results(path: Path, truth: Row) -> list[dict[str, Any]]:
    """The detections in a file, checked against the COCO data `truth`.

    Raises ValueError that names the entry and what is wrong with it.
    """
    found = read_json(path)
    if not isinstance(found, list):
        raise ValueError(f"results must be a list of detections, got {type(found).__name__} in {path}")
    sizes = {image["id"]: (image["height"], image["width"]) for image in truth["images"]}
    categories = {row["id"] for row in truth["categories"]}
    for number, row in enumerate(found):
        _check(row, sizes, categories, f"entry {number} of {printable(str(path))}")
    for key in ("bbox", "segmentation"):
        if any(key in row for row in found) and not all(key in row for row in found):
            raise ValueError(f"{key} must be in all entries or in none, got only some in {path}")
    return [{key: row[key] for key in KEPT if key in row} for row in found]


def _check(row: Any, sizes: Mapping[int, tuple[int, int]], categories: set[int], where: str) -> None:
    """Check a detection. Raises ValueError that says what is wrong, and `where`."""
    found = typed(Detection, row, where)
    if found.image_id not in sizes:
        raise ValueError(f"image_id must be the id of a picture in the split, got {found.image_id} in {where}")
    if found.category_id not in categories:
        raise ValueError(f"category_id must be one of the dataset's categories, got {found.category_id} in {where}")
    if "bbox" not in row and "segmentation" not in row:
        raise ValueError(f"bbox or segmentation must be given, got neither in {where}")
    if "bbox" in row and (found.bbox is None or min(found.bbox[2:]) < 0):
        raise ValueError(f"bbox must be left, top, width and height, got {row['bbox']!r:.100} in {where}")
    if "segmentation" in row:
        check_runs(row["segmentation"], sizes[found.image_id], where)


def _check_truth(truth: Row, name: str) -> None:
    """Check what pycocotools takes for granted: ids, and masks of their pictures' sizes. Raises ValueError."""
    check_unique(truth["annotations"], f"annotations of {name}")
    by_image(truth, name)
    sizes = {image["id"]: (image["height"], image["width"]) for image in truth["images"]}
    for row in truth["annotations"]:
        if "segmentation" in row:
            check_shape(row["segmentation"], sizes[row["image_id"]], f"annotation {row['id']} of {name}")


def table(truth: Row, found: list[dict[str, Any]], kind: str) -> str:
    """Scores of `found` (bbox or segm, `kind`) in Markdown: a line for all things, and one for each group in it."""
    states: dict[str, Callable[[Row], bool]] = {"all": lambda a: True, **STATES}
    every = {name: (rule, EVERY) for name, rule in states.items()}
    for name, low, high in _between(AREAS):
        every[f"{name} pixels"] = (lambda a: True), (low, high)
    for name, low, high in _between(DISTANCES):
        every[f"{name} m away"] = _within("distance_m", low, high), EVERY
    lines = ["| things | number | AP | AP50 | AR |", "| --- | --- | --- | --- | --- |"]
    for name, (rule, area) in every.items():
        in_area = _within("pixels", *area)
        count = sum(rule(row["attributes"]) and in_area(row["attributes"]) for row in truth["annotations"])
        if count:
            numbers = average_precision(truth, found, kind, rule, area)
            lines.append(f"| {name} | {count} | " + " | ".join(f"{number:.3f}" for number in numbers) + " |")
    return "\n".join(lines) + "\n"


def _between(ends: tuple[float, ...]) -> list[tuple[str, float, float]]:
    """The groups between neighbouring `ends`, the lower one included: name and ends."""
    pairs = zip(ends[:-1], ends[1:], strict=True)
    return [(f"{low} or more" if high == math.inf else f"{low} to {high}", low, high) for low, high in pairs]


def _within(key: str, low: float, high: float) -> Callable[[Row], bool]:
    """Whether an attribute is from `low` to below `high`."""
    return lambda a: low <= a[key] < high


def average_precision(
    truth: Row,
    found: list[dict[str, Any]],
    kind: str,
    counts: Callable[[Row], bool] = lambda a: True,
    area: tuple[float, float] = EVERY,
) -> tuple[float, float, float]:
    """AP, AP50 and AR of `found` (bbox or segm, `kind`) for the things whose attributes `counts` accepts.

    Other things are neither missed nor found: detections of them are left out. `area`: only things from its first end
    to below its second [pixels] count, and only detections of nothing that are as large, as in COCO.
    """
    if not found:
        return 0.0, 0.0, 0.0
    from pycocotools.coco import COCO
    from pycocotools.cocoeval import COCOeval

    class Grouped(COCOeval):
        """COCO's evaluation, in which the things of other groups are ignored."""

        def _prepare(self) -> None:
            super()._prepare()
            for things in self._gts.values():
                for thing in things:
                    thing["ignore"] = not counts(thing["attributes"])

    with contextlib.redirect_stdout(io.StringIO()):
        real = COCO()
        real.dataset = copy.deepcopy({"info": {}, **truth})
        real.createIndex()
        key = {"bbox": "segmentation", "segm": "bbox"}[kind]  # pycocotools looks at the first key that it finds
        run = Grouped(real, real.loadRes([{k: v for k, v in row.items() if k != key} for row in found]), kind)
        run.params.areaRng, run.params.areaRngLbl = [[area[0], min(area[1] - 1, 1e10)]], ["all"]  # with both ends
        run.params.maxDets = [MOST_FOUND]
        run.evaluate()
        run.accumulate()
    precision, recall = run.eval["precision"][:, :, :, 0, 0], run.eval["recall"][:, :, 0, 0]
    return _mean(precision), _mean(precision[:1]), _mean(recall)


def _mean(numbers: Any) -> float:
    """The mean of those that are known; pycocotools writes -1 for categories without things."""
    known = numbers[numbers > -1]
    return float(known.mean()) if known.size else 0.0
