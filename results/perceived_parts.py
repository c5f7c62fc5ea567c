"""The parts of the track with perception by what they rescue: `./run python results/perceived_parts.py [SCENES]`.

Greedy plays the first scenes, 5 by default, of each task's split `test` with each part of the track alone, with all and
with none. Writes perceived_parts.md beside this file and docs/perceived_parts.svg; resumes where it stopped. The errors
of the detector's first stage are counted as `results/detector.py` counts those of both stages, in the pictures that its
step `capture` takes to build/unseen.
"""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Mapping
from dataclasses import asdict, replace

from safetensors.torch import save_file

from hazard_ms.evaluation.comparison.pairing import Episode, difference
from hazard_ms.evaluation.metrics import Score
from hazard_ms.perception.detectors.second_stage import PREFIX
from hazard_ms.perception.detectors.small import CONFUSION, SHIPPED, Small
from hazard_ms.perception.detectors.weights import read_weights
from hazard_ms.sensing.detection.confusion import Confusion
from hazard_ms.sensing.detection.perception import eyes_of
from results.detector import ERRORS, UNSEEN, run
from results.tables import HERE, TASKS, evaluate, machine, results_in, value_of, words

RAW, CHART = HERE.parent / "build" / "perceived_parts", HERE.parent / "docs" / "perceived_parts.svg"
FIRST = HERE.parent / "build" / "first_stage" / SHIPPED.name
SCENES = 5
SMALL, EYES = "256/120", eyes_of("small")  # the robots' own eyes, and the detector's
# by name: the second stage of the detector, eyes, fusion, and whether the agent counts beliefs
PARTS = {
    "none": (False, SMALL, False, False),
    "eyes": (False, EYES, False, False),
    "detector": (True, SMALL, False, False),
    "fusion": (False, SMALL, True, False),
    "fusion and belief": (False, SMALL, True, True),
    "all": (True, EYES, True, True),
}
HEAD = """# The parts of the track with perception

Made by `./run python results/perceived_parts.py`. Greedy in the first {scenes} scenes of `test`, Fetch, presets
`paper`. Value in percent, with 95 % bootstrap intervals over scenes, and the difference from none of the parts, paired
by episode. `eyes`: {eyes} in place of 256/120; `detector`: its second stage; `fusion`: tracks keep what all looks
tell; `belief`: values count by the belief that the thing is what it seems to be, which without fusion is 1, and so it
has no row alone. What tells carts from fences was learned with both stages.
Written at
{machine}.

| task | parts | Value | more than none |
|---|---|---|---|
"""


def first_stage() -> None:
    """Write the detector without its second stage, and its own table of errors, to FIRST."""
    table = FIRST.with_name(f"{FIRST.stem}{CONFUSION}")
    if table.exists():
        return
    FIRST.parent.mkdir(parents=True, exist_ok=True)
    save_file({name: each for name, each in read_weights(SHIPPED).items() if not name.startswith(PREFIX)}, FIRST)
    shutil.copy(SHIPPED.with_suffix(".json"), FIRST.with_suffix(".json"))
    data, told = [UNSEEN / TASKS[task] for task in ERRORS], f"small:{os.path.relpath(FIRST, HERE.parent)}"
    counted = FIRST.with_name("counted.json")
    run("perception", "calibrate", *data, "--perception", told, "--split", "large", "hard", "-o", counted)
    odds = (Small().confusion or Confusion.read(counted)).odds_of
    made = replace(Confusion.read(counted), odds_of=odds)
    table.write_text(json.dumps(asdict(made), indent=1) + "\n", encoding="utf-8")


def played(task: str, number: int, scenes: int) -> tuple[Score, dict[Episode, float]]:
    """The Value of greedy in a task with the parts of a number, and that of each of its episodes."""
    both, eyes, fuses, doubts = list(PARTS.values())[number]
    weights = "" if both else f":{os.path.relpath(FIRST, HERE.parent)}"
    told = f"small{weights}{',' if weights else ':'}eyes={eyes},fusion={str(fuses).lower()}"
    agent, folder = "greedy" if doubts else "greedy:belief=false", RAW / str(number) / task
    evaluate(task, folder, *("--split", "test", "--episodes", str(scenes), "--perception", told, "--agents", agent))
    results = results_in(folder)
    return value_of(results), {(result.seed, result.scene): result.tally.value for result in results}


def chart(values: Mapping[str, Mapping[str, float]]) -> None:
    """Draw the Value, 0 to 1, of each of the parts in each task."""
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "parts", "font.size": 11})
    import matplotlib.pyplot as plt

    figure, every = plt.subplots(1, len(values), figsize=(9.0, 3.0), sharey=True, layout="constrained")
    for axes, (task, mine) in zip(every, values.items(), strict=True):
        names = [*reversed(mine)]
        bars = axes.barh(names, [100.0 * mine[name] for name in names], color="#1f6fb4")
        axes.bar_label(bars, fmt="%.0f", padding=3)
        axes.set_title(task)
        axes.set_xlim(0.0, 100.0)
        axes.spines[["top", "right"]].set_visible(False)
    every[len(values) // 2].set_xlabel("Value of greedy [%]")
    figure.savefig(CHART, metadata={"Date": None})


def main(scenes: int) -> None:
    """Play what is missing, and write the table and the figure."""
    first_stage()
    text, values = "", dict[str, dict[str, float]]()
    for task in TASKS:
        none: dict[Episode, float] = {}
        for number, name in enumerate(PARTS):
            score, own = played(task, number, scenes)
            none = none or own
            assert score.mean is not None
            values.setdefault(task, {})[name] = score.mean
            more = words(difference(own, none)) if number else "-"
            text += f"| {task} | {name} | {words(score)} | {more} |\n"
            print(text.splitlines()[-1], flush=True)
    chart(values)
    head = HEAD.format(scenes=scenes, eyes=EYES, machine=machine())
    (HERE / "perceived_parts.md").write_text(head + text, encoding="utf-8")


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(int(sys.argv[1]) if len(sys.argv) > 1 else SCENES)
