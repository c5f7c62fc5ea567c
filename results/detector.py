"""Our small detector: `./run python results/detector.py [capture|name|calibrate|tables...]`.

`capture` takes pictures with 768 pixels and 120 degrees of whole episodes, a few of each scene of `train`; smaller and
narrower ones of the test rooms, also for results/eyes.py; and those in which errors are counted. `name` goes on with
the second stage of the package's weights, on what the first finds; `calibrate` counts the errors, `tables` scores the
detector in the test rooms and writes detector.md beside this file. Without words it does all of it. Each step resumes
where it stopped; takes hours on one core. What is shipped is build/second_stage/second_stage, called small, with its
table of errors; without that file `calibrate` counts the errors of the package's weights, and writes their table.

The first stage is that of commit e4b0c5f, whose file of this name trains it. It was tried to train it on: 3496 steps on
the pictures of 768 pixels left its AP50 at 0.37.
"""

from __future__ import annotations

import csv
import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

from hazard_ms.perception.detectors.small import CONFUSION, SHIPPED, Small
from hazard_ms.perception.score import KINDS, table
from hazard_ms.perception.training.pictures import read
from hazard_ms.spec.checks import one_of
from results.eyes import COLUMNS, HOME, Look, scored, values
from results.tables import COMMAND, HERE, TASKS, machine

WIDE, PICTURES, NARROW, CAMERA, UNSEEN = (HOME / name for name in ("wide", "pictures", "narrow", "camera", "unseen"))
FIRST, DETECTOR = HOME / "first" / "small.safetensors", HOME / "second_stage" / "second_stage.safetensors"
LEARNT = ("--size", "768", "--fov", "120", "-o", WIDE)
PER_SCENE = {"fire": "8", "flood": "8", "wind": "6"}  # pictures of a scene to learn from, by task
SEEN = ("--per-scene", "6", "--size", "512", "--fov", "120", "-o", PICTURES)
CLOSE = ("--per-scene", "8", "--size", "512", "--fov", "60", "-o", NARROW)
ERRORS = {"fire": "large", "flood": "large", "wind": "hard"}  # splits in which errors are counted, by task
FEW = {"fire": 20, "flood": 20, "wind": 20}  # scenes of each of these
STEPS = "11030"
Row = dict[str, Any]
HEAD = """# The small detector

Made by `./run python results/detector.py`: {pictures} pictures of 768 x 768 with 120 degrees of {scenes} scenes of the
three tasks; {steps} steps of 64 things for the second stage, after those of the weights that the training went on
from; the first stage is as it was. Scored in {tests} pictures, 512/120, of rooms and streets that it was not trained
in, on things that can be moved and carts. One training. Written at
{machine}.

AP50 of masks by task, with the number of things; goals are 0.60 for all of 256 pixels or more, and 0.45 for those of
them that burn and that are or were wet. "Any category" counts a thing as found whatever it is called.

| task | {columns} | any category |
|{line}
"""
CURVE = """
## Curve

AP50 of masks of all things in 60 of the pictures of fire, on the way. The rate of learning falls to the end.

| step | AP50 |
|---|---|
"""


def run(*words: str | Path) -> None:
    """Run a command of hazard-ms. Raises CalledProcessError where it fails."""
    told = [os.path.relpath(word, HERE.parent) if isinstance(word, Path) else word for word in words]
    subprocess.run([*COMMAND, *told], cwd=HERE.parent, check=True)


def capture() -> None:
    """Take the pictures that are missing."""
    for task, env_id in TASKS.items():
        words = ("perception", "capture", "-e", env_id, "--split")
        run(*words, "train", "--per-scene", PER_SCENE[task], *LEARNT)
        run(*words, "test", *SEEN)
        run(*words, "test", "--per-scene", "4", "--size", "640", "--fov", "55", "-o", CAMERA)
        run(*words, "test", *CLOSE)
    for task, split in ERRORS.items():
        place = {"large": "flat_a", "hard": "parking_hard"}[split]
        scenes = [f"{place}/{k:02d}" for k in range(FEW[task])]
        words = ("perception", "capture", "-e", TASKS[task], "--split", split, "--scenes", *scenes, "--per-scene", "10")
        run(*words, "--size", "768", "--fov", "120", "-o", UNSEEN)


def first() -> Path:
    """The weights that the package had when the training began."""
    if not FIRST.is_file():
        FIRST.parent.mkdir(parents=True, exist_ok=True)
        for ending in (".json", ".safetensors"):
            shutil.copyfile(SHIPPED.with_suffix(ending), FIRST.with_suffix(ending))
    return FIRST


def name() -> None:
    """Train the second stage, from that of the package's weights on, on the things in all pictures.

    They are masked as they are, and as the first stage finds them.
    """
    wide = [WIDE / env_id for env_id in TASKS.values()]
    words = ("-o", DETECTOR.parent, "--model", "second_stage", "--weights", first(), "--steps", STEPS)
    run("perception", "train", *wide, *words, "--every", "4000", "--validate", PICTURES / TASKS["fire"])


def calibrate() -> None:
    """Count the errors in rooms and streets that belong to neither `train` nor `test`."""
    weights = DETECTOR if DETECTOR.is_file() else SHIPPED
    data = [UNSEEN / TASKS[task] for task in ERRORS]
    told = "small" if weights == SHIPPED else f"small:{os.path.relpath(weights, HERE.parent)}"
    table_of = weights.with_name(f"{weights.stem}{CONFUSION}")
    run("perception", "calibrate", *data, "--perception", told, "--split", "large", "hard", "-o", table_of)


def of_images(truth: Row, found: list[Row], numbers: range) -> tuple[Row, list[Row]]:
    """The part of the truth and of what was found that is of the images with these numbers."""
    images = [image for image in truth["images"] if image["id"] in numbers]
    things = [thing for thing in truth["annotations"] if thing["image_id"] in numbers]
    return {**truth, "images": images, "annotations": things}, [one for one in found if one["image_id"] in numbers]


def row_of(task: str, truth: Row, found: list[Row]) -> str:
    """A row of the first table."""
    cells = [f"{value:.3f} ({count})" if count else "-" for value, count in values(truth, found)]
    return f"| {task} | {' | '.join(cells)} |\n"


def tables() -> None:
    """Score the detector and write detector.md."""
    detector = Small(str(DETECTOR))
    looks = {task: [Look(picture) for picture in read([PICTURES / env_id], "test")] for task, env_id in TASKS.items()}
    truth, found, _ = scored([look for mine in looks.values() for look in mine], detector)
    rows, number = "", 1
    for task, mine in looks.items():
        rows += row_of(task, *of_images(truth, found, range(number, number + len(mine))))
        number += len(mine)
    rows += row_of("all", truth, found)
    learned = read([WIDE / env_id for env_id in TASKS.values()], "train")
    steps = json.loads(DETECTOR.with_suffix(".json").read_text(encoding="utf-8"))["step"]
    told: Row = {"pictures": len(learned), "scenes": len({(p.dataset.name, p.row["scene"]) for p in learned})}
    told |= {"steps": steps, "tests": len(truth["images"]), "columns": " | ".join(COLUMNS)}
    text = HEAD.format(**told, line="---|" * (2 + len(COLUMNS)), machine=machine()) + rows
    for kind, name in KINDS.items():
        text += f"\n## {name.capitalize()}\n\n{table(truth, found, kind)}"
    with DETECTOR.with_suffix(".csv").open(newline="", encoding="utf-8") as file:
        curve = [(float(row["step"]), float(row["mask AP50"])) for row in csv.DictReader(file)]
    text += CURVE + "".join(f"| {step:,.0f} | {value:.3f} |\n" for step, value in curve if math.isfinite(value))
    (HERE / "detector.md").write_text(text, encoding="utf-8")
    print(text)


def main(wanted: list[str]) -> None:
    """Take the steps called `wanted`, or all. Raises ValueError for unknown names."""
    steps = {"capture": capture, "name": name, "calibrate": calibrate, "tables": tables}
    todo = [one_of(each, steps, "a step") for each in wanted] or list(steps)
    for step, take in steps.items():
        if step in todo:
            take()


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(sys.argv[1:])
