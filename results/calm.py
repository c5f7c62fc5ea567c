"""What pictures with hazards are worth: `./run python results/calm.py [capture|compare|tables...]`.

`capture` takes pictures as the robots' head cameras see: of all training scenes of fire and flood, of the same scenes
before a hazard has changed anything, and of the test rooms. `compare` trains the detector `small` on the former and on
the latter for as many steps. `tables` scores both in the test rooms and writes calm.md beside this file and
docs/detector.svg. Without words it does all of it. Each step resumes where it stopped; takes hours on one core.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from hazard_ms.perception.detectors.small import Small
from hazard_ms.perception.score import STATES, average_precision
from hazard_ms.perception.training.pictures import read, truth_of
from hazard_ms.perception.training.validation import results_of
from hazard_ms.spec.checks import one_of
from results.tables import COMMAND, HERE, TASKS, machine

RAW = HERE.parent / "build"
CHART = HERE.parent / "docs" / "detector.svg"
PICTURES, CALM = RAW / "seen_pictures", RAW / "calm_pictures"  # with hazards, and before a hazard has changed anything
EYES = ["--size", "256", "--fov", "120"]  # of the head cameras
TRAINING, TEST = "24", "16"  # pictures of each scene
COMPARED = "4000"  # steps of the trainings
ROOMS = ("fire", "flood")  # tasks whose pictures are compared
STEPS = ("capture", "compare", "tables")
SETS = {"with hazards": PICTURES, "without": CALM}
GROUPS: dict[str, Callable[[Any], bool]] = {  # of the chart
    "dry, not burnt": STATES["dry, not burnt"],
    "burning or burnt": lambda a: a["status"] != "normal",
    "wet": STATES["wet"],
}
HEAD = """# Trained with hazards and without

Made by `./run python results/calm.py`: two detectors, {steps} steps each, on as many pictures of 256 x 256 with 120
degrees of the same scenes of fire and flood; one set shows whole episodes, the other only what no hazard has changed
yet; the original takes its pictures right after a scene is set up. AP50 of masks in pictures of the test rooms, things
of {least:.0f} pixels or more. Written at
{machine}.

| things | number | trained with hazards | without |
|---|---|---|---|
"""
LEAST = 256.0  # area of things that are compared: smaller ones are hardly found by either [pixels]


def run(*words: str | Path) -> None:
    """Run a command of hazard-ms. Raises CalledProcessError where it fails."""
    told = [os.path.relpath(word, HERE.parent) if isinstance(word, Path) else word for word in words]
    subprocess.run([*COMMAND, *told], cwd=HERE.parent, check=True)


def datasets(home: Path, tasks: Sequence[str]) -> list[Path]:
    """The datasets of `tasks` below a folder."""
    return [home / TASKS[task] for task in tasks]


def capture() -> None:
    """Take the pictures that are missing."""
    for task in ROOMS:
        for split, count in (("train", TRAINING), ("test", TEST)):
            words = ("perception", "capture", "-e", TASKS[task], "--split", split, "--per-scene", count, *EYES)
            run(*words, "-o", PICTURES)
            if split == "train":
                run(*words, "--last-frame", "0", "-o", CALM)


def compare() -> None:
    """Train the two detectors that are compared."""
    for name, home in SETS.items():
        options = ("--model", "small", "--steps", COMPARED, "--every", "1000")
        data, test = datasets(home, ROOMS), datasets(PICTURES, ROOMS)
        run("perception", "train", *data, "-o", compared(name), *options, "--validate", *test)


def compared(name: str) -> Path:
    """The folder of a detector that is compared."""
    return RAW / f"detector_{name.replace(' ', '_')}"


def classes_of(folder: Path) -> list[str]:
    """The categories that a detector tells."""
    classes: list[str] = json.loads((folder / "small.json").read_text(encoding="utf-8"))["classes"]
    return classes


def found_by(folder: Path, tasks: Sequence[str], classes: list[str]) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """The truth about things of `classes` in the test pictures of `tasks`, and what a detector finds in them."""
    pictures = read(datasets(PICTURES, tasks), "test")
    return truth_of(pictures, classes), results_of(Small(str(folder / "small.safetensors")), pictures)


def tables() -> None:
    """Score the detectors, write calm.md, and draw the chart."""
    rows = beside()
    text = HEAD.format(steps=COMPARED, least=LEAST, machine=machine())
    for name, (count, values) in rows.items():
        text += f"| {name} | {count} | " + " | ".join(f"{value:.3f}" for value in values) + " |\n"
    (HERE / "calm.md").write_text(text, encoding="utf-8")
    chart(rows)
    print(text)


def beside() -> dict[str, tuple[int, list[float]]]:
    """For each of GROUPS the number of things, and the AP50 of masks of the detectors of SETS."""
    made: dict[str, tuple[int, list[float]]] = {name: (0, []) for name in GROUPS}
    both = sorted(set.intersection(*(set(classes_of(compared(name))) for name in SETS)))
    for name in SETS:
        truth, found = found_by(compared(name), ROOMS, both)
        for group, rule in GROUPS.items():
            number = sum(rule(row["attributes"]) and row["area"] >= LEAST for row in truth["annotations"])
            found_again = average_precision(truth, found, "segm", rule, (LEAST, math.inf))[1]
            made[group] = number, [*made[group][1], found_again]
    return made


def chart(rows: dict[str, tuple[int, list[float]]]) -> None:
    """Draw the comparison."""
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "detector", "font.size": 11})
    from matplotlib import pyplot

    figure, ax = pyplot.subplots(figsize=(6.4, 3.4))
    for k, name in enumerate(SETS):
        bars = ax.bar([n + 0.38 * (k - 0.5) for n in range(len(rows))], [v[k] for _, v in rows.values()], 0.36)
        bars.set_label(f"trained {name}" if k == 0 else "trained without")
        ax.bar_label(bars, fmt="%.2f", fontsize=9)
    ax.set_xticks(range(len(rows)), [f"{name}\n({count} things)" for name, (count, _) in rows.items()])
    top = 1.15 * max(max(values) for _, values in rows.values())
    ax.set(ylabel="AP50 of masks", title="Small detector in rooms that it has not seen", ylim=(0.0, top))
    ax.legend(frameon=False)
    ax.grid(alpha=0.3, axis="y")
    figure.tight_layout()
    figure.savefig(CHART, metadata={"Date": None})


def main(wanted: list[str]) -> None:
    """Take the steps called `wanted`, or all. Raises ValueError for unknown names."""
    todo = [one_of(name, STEPS, "a step") for name in wanted] or [*STEPS]
    for name in STEPS:
        if name in todo:
            {"capture": capture, "compare": compare, "tables": tables}[name]()


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(sys.argv[1:])
