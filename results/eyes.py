"""The eyes of the track with perception: `./run python results/eyes.py FOLDER SPLIT... [--every N...]`.

FOLDER holds datasets of pictures with 1024 pixels and 120 degrees, as `perception capture --size 1024 --fov 120` makes
them. The detector `small` looks at every N-th pixel of them (4: eyes 256/120, 2: 512/120). Prints AP50 of masks by
distance and area, what is found, what is not there, and the seconds that a look takes.
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path

from hazard_ms.perception import layout
from hazard_ms.perception.calibration.thinned import Thinned
from hazard_ms.perception.detectors.small import SHIPPED, Small
from hazard_ms.perception.score import AREAS, DISTANCES, average_precision
from hazard_ms.perception.training.pictures import read
from hazard_ms.perception.training.validation import results_of


def row(eyes: str, pictures: list[Thinned], classes: list[str]) -> str:
    """A row of the table: AP50 of all, by distance, by area, and what a look costs."""
    numbers = layout.category_ids()
    wanted = {numbers[name] for name in classes}
    images = [{**p.picture.row, "id": k, "width": 1024, "height": 1024} for k, p in enumerate(pictures, start=1)]
    rows: list[dict] = []
    for k, picture in enumerate(pictures, start=1):
        rows += [r for r in picture.annotations(k, len(rows) + 1) if r["category_id"] in wanted]
    truth = {"images": images, "annotations": rows, "categories": layout.categories()}
    start = time.process_time()
    found = results_of(Small(), pictures)  # type: ignore[arg-type]
    seconds = (time.process_time() - start) / len(pictures)
    cells = [f"{average_precision(truth, found, 'segm')[1]:.3f}"]
    for low, high in zip(DISTANCES, DISTANCES[1:], strict=False):
        near = lambda a, low=low, high=high: low <= a["distance_m"] < high  # noqa: E731
        cells.append(f"{average_precision(truth, found, 'segm', near)[1]:.3f}")
    for low, high in zip(AREAS, AREAS[1:], strict=False):
        count = sum(low <= r["area"] < high for r in rows)
        cells.append(f"{average_precision(truth, found, 'segm', area=(low, high))[1]:.3f} ({count})")
    sure = sum(d["score"] >= 0.5 for d in found) / len(pictures)
    return f"| {eyes} | {' | '.join(cells)} | {sure:.1f} | {seconds:.2f} |"


def main(folder: str, splits: list[str], every: list[int]) -> None:
    """Print the table."""
    classes = json.loads(SHIPPED.with_suffix(".json").read_text(encoding="utf-8"))["classes"]
    near = [f"{low} m" for low in DISTANCES[:-1]]
    areas = [f"{low} px" for low in AREAS[:-1]]
    print(f"| eyes | all | {' | '.join(near)} | {' | '.join(areas)} | found a picture | CPU s a look |")
    print("|---" * (4 + len(near) + len(areas)) + "|")
    homes = sorted(Path(folder).glob("Hazard*"))
    for n in every:
        pictures = [
            Thinned(p, n)
            for home in homes
            for split in splits
            if (home / layout.instances(split)).is_file()
            for p in read([home], split)
        ]
        print(row(f"{1024 // n}/120", pictures, classes), flush=True)


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    words = sys.argv[1:]
    cut = words.index("--every") if "--every" in words else len(words)
    main(words[0], words[1:cut], [int(n) for n in words[cut + 1 :]] or [4, 2])
