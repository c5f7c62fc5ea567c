"""The eyes of the track with perception: `./run python results/eyes.py [WEIGHTS]`.

The detector `small`, the package's or that of WEIGHTS.safetensors, looks at the pictures of split `test` below
build/pictures, which `results/detector.py capture` takes: 512/120, every second pixel of it (256/120), every second of
512/60 (256/60), and the middle rows of 640/55 (640x480/55). What a thing is called and how large it is follows from the
whole picture: 256/120 misses what it does not resolve. Writes eyes.md beside this file.
"""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.perception import layout
from hazard_ms.perception.calibration.thinned import Thinned
from hazard_ms.perception.coco import LEAST_PIXELS, box_of, run_lengths
from hazard_ms.perception.detectors.small import Small
from hazard_ms.perception.score import STATES, average_precision
from hazard_ms.perception.training.pictures import Picture, read
from hazard_ms.sensing.detection.detector import box_of as corners_of
from results.tables import HERE, TASKS, machine

HOME = HERE.parent / "build"
LEAST = 256.0  # area of things that the goals are about [pixels]
EVERY: tuple[float, float] = (0.0, math.inf)
# by name: the folder of pictures, of how many pixels the first is looked at, rows that are left out above and below
EYES = {
    "256/120": ("pictures", 2, 0),
    "512/120": ("pictures", 1, 0),
    "256/60": ("narrow", 2, 0),
    "640x480/55": ("camera", 1, 80),
}
COLUMNS: dict[str, tuple[Callable[[Any], bool], tuple[float, float]]] = {
    "all": (lambda a: True, EVERY),
    "256 pixels or more": (lambda a: True, (LEAST, math.inf)),
    "these burning": (STATES["burning"], (LEAST, math.inf)),
    "these wet": (STATES["wet"], (LEAST, math.inf)),
}
HEAD = """# Eyes

Made by `./run python results/eyes.py`: AP50 of masks of the detector `small` in pictures of rooms and streets that it
was not trained in, by the camera. Areas are those in the whole picture, of 512/120 for both eyes with 120 degrees.
"Any category" counts a thing as found whatever it is called. "Sure": things that are told with a score of 0.5 or more.
Six pictures of each scene with 120 degrees, three others with the narrow eyes. Written at
{machine}.

| eyes | pictures | things a picture | {columns} | any category | sure a picture | CPU s a look |
|{line}
"""


@dataclass(frozen=True)
class Look:
    """A picture, of which every n-th pixel is looked at, but for some rows above and below."""

    picture: Picture
    every: int = 1
    without: int = 0

    @property
    def rows(self) -> slice:
        """The rows of the picture that count."""
        return slice(self.without, int(self.picture.row["height"]) - self.without)

    def found(self, detector: Small) -> list[tuple[str, float, NDArray[np.bool_]]]:
        """What a detector finds: categories, scores, and masks, [H, W], of the whole rows."""
        thin = Thinned(self.picture, self.every)
        intrinsic, rows = thin.intrinsic(), slice(self.rows.start // self.every, self.rows.stop // self.every)
        intrinsic[1, 2] -= rows.start
        detector.aim(intrinsic, thin.cam2world())
        told = detector.detect(np.ascontiguousarray(thin.rgb()[rows]), np.ascontiguousarray(thin.depth()[rows]))
        n = self.every
        return [(one.category, one.score, one.mask.repeat(n, 0).repeat(n, 1)) for one in told if one.mask.any()]

    def things(self, image: int, first: int, numbers: set[int]) -> list[dict[str, Any]]:
        """The rows in COCO's form of things with categories of these `numbers`, with ids from `first` on."""
        ids = self.picture.ids()[self.rows]
        made: list[dict[str, Any]] = []
        for thing in self.picture.things:
            mask = ids == thing["instance"] + 1
            pixels = int(mask.sum())
            if pixels >= LEAST_PIXELS and thing["category_id"] in numbers:
                row = {"image_id": image, "id": first + len(made), "area": pixels, "segmentation": run_lengths(mask)}
                row |= {"bbox": box_of(mask), "attributes": {**thing["attributes"], "pixels": pixels}}
                made.append({**thing, **row})
        return made


def scored(looks: Sequence[Look], detector: Small) -> tuple[dict[str, Any], list[dict[str, Any]], float]:
    """The truth about all `looks`, what a detector finds, and the CPU time of a look [s]."""
    names = layout.category_ids()
    known = {names[name] for name in detector.classes}
    images: list[dict[str, Any]] = []
    rows: list[dict[str, Any]] = []
    found: list[dict[str, Any]] = []
    seconds = 0.0
    for number, look in enumerate(looks, start=1):
        start = time.process_time()
        told = look.found(detector)
        seconds += time.process_time() - start
        images.append({**look.picture.row, "id": number, "height": look.rows.stop - look.rows.start})
        rows += look.things(number, len(rows) + 1, known)
        for category, score, mask in told:
            left, top, right, bottom = corners_of(mask)
            row = {"image_id": number, "category_id": names[category], "score": score}
            row |= {"bbox": [left, top, right - left, bottom - top], "segmentation": run_lengths(mask)}
            found.append(row)
    return {"images": images, "annotations": rows, "categories": layout.categories()}, found, seconds / len(looks)


def of_one_category(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """The same annotations or detections, all called one thing."""
    return [{**row, "category_id": 1} for row in rows]


def values(truth: dict[str, Any], found: list[dict[str, Any]]) -> list[tuple[float, int]]:
    """AP50 of masks and number of things by COLUMNS, and last whatever things of LEAST pixels or more are called."""
    made = []
    for rule, area in COLUMNS.values():
        count = sum(rule(row["attributes"]) and area[0] <= row["area"] < area[1] for row in truth["annotations"])
        made.append((average_precision(truth, found, "segm", rule, area)[1], count))
    same = {**truth, "annotations": of_one_category(truth["annotations"])}
    return [*made, (average_precision(same, of_one_category(found), "segm", area=(LEAST, math.inf))[1], made[1][1])]


def main(weights: str) -> None:
    """Write the table."""
    detector, text = Small(weights), ""
    for name, (folder, every, without) in EYES.items():
        homes = [HOME / folder / env_id for env_id in TASKS.values()]
        there = [home for home in homes if (home / layout.instances("test")).is_file()]
        looks = [Look(picture, every, without) for picture in read(there, "test")]
        if not looks:
            continue
        truth, found, seconds = scored(looks, detector)
        cells = [f"{value:.3f} ({count})" for value, count in values(truth, found)]
        sure = sum(row["score"] >= 0.5 for row in found) / len(looks)
        things = len(truth["annotations"]) / len(looks)
        text += f"| {name} | {len(looks)} | {things:.1f} | {' | '.join(cells)} | {sure:.1f} | {seconds:.2f} |\n"
        print(text.splitlines()[-1], flush=True)
    line = "---|" * (6 + len(COLUMNS))
    (HERE / "eyes.md").write_text(HEAD.format(machine=machine(), columns=" | ".join(COLUMNS), line=line) + text)


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(str(Path(sys.argv[1])) if len(sys.argv) > 1 else "")
