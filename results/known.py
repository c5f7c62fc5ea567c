"""What agents know after ten looks, by the parts of the track with perception: `./run python results/known.py`.

The detector looks at the pictures of rooms and streets that belong to neither `train` nor `test`, which
`results/detector.py capture` takes to build/unseen, ten of each scene in turn, and the tracks of agents follow what it
finds. Eyes (768/120 in place of 256/120), the second stage of the detector, fusion of all looks, and belief come alone
and together. Writes known.md beside this file and docs/known.svg.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence
from itertools import groupby
from typing import Any

from hazard_ms.perception.calibration.measuring import confusion_of
from hazard_ms.perception.calibration.observing import Observed, observed
from hazard_ms.perception.calibration.reliability import ece, weight_of_repeats
from hazard_ms.perception.calibration.thinned import Thinned
from hazard_ms.perception.detectors.small import Small
from hazard_ms.perception.training.pictures import read
from hazard_ms.scenes.splits import scene as scene_of
from hazard_ms.sensing.detection.beliefs import believed
from hazard_ms.sensing.detection.confusion import Confusion
from hazard_ms.sensing.detection.track import Track
from hazard_ms.sensing.detection.tracks import Tracker
from results.detector import ERRORS, UNSEEN
from results.tables import HERE, TASKS, machine

CHART = HERE.parent / "docs" / "known.svg"
# by name: the first of every n pixels, the second stage, fusion, belief
PARTS = {
    "none": (3, False, False, False),
    "eyes": (1, False, False, False),
    "detector": (3, True, False, False),
    "fusion": (3, False, True, False),
    "fusion and belief": (3, False, True, True),
    "eyes and detector": (1, True, False, False),
    "all but the detector": (1, False, True, True),
    "all": (1, True, True, True),
}
HEAD = """# What agents know

Made by `./run python results/known.py`: tracks of the things that are to be rescued, and carts, after the ten pictures
of each of {scenes} rooms and streets that the detector was not trained in; {things} such things were in sight of
768/120. A track is right if it is of a thing of its category, and no surer track is of the same. Average precision
ranks the tracks by belief; without belief all count as sure. The errors that fusion goes by are counted in the other
half of the scenes. `eyes`: 768/120 in place of 256/120; `detector`: its second stage. Written at
{machine}.

| parts | right | wrong | share of the things that are known | average precision | ECE |
|---|---|---|---|---|---|
"""
Outcome = tuple[float, bool]
SURE = 0.5  # belief from which a track counts as right or wrong in the table; average precision counts all [ours]


def looks_of(every: int, second: bool) -> tuple[list[Observed], list[str]]:
    """All pictures as a detector sees them, and the categories that it tells."""
    detector = Small()
    if not second:
        detector.second = None
    pictures = [
        Thinned(picture, every) for task, split in ERRORS.items() for picture in read([UNSEEN / TASKS[task]], split)
    ]
    return observed(detector, pictures, detector.classes), list(detector.classes)


def wanted(look: Observed) -> Counter[str]:
    """How many things of each category an episode of the scene would tell."""
    spec: Any = scene_of(look.scene.split("/", 1)[1])
    return Counter(body.category for body in (*spec.targets, *spec.containers))


def outcomes(looks: Sequence[Observed], confusion: Confusion | None, weighs: bool) -> tuple[list[Outcome], int]:
    """The beliefs in the tracks of one scene and whether they are right, and the number of things in sight."""
    tracker, thing_of = Tracker(confusion), dict[Track, int]()
    for frame, look in enumerate(looks):
        found = {number: told.found for number, told in enumerate(look.told)}
        for number, track in tracker.update(look.view, frame, found)[0].items():
            thing_of[track] = look.told[number].thing
    expected, kinds = wanted(looks[0]), looks[0].kinds
    if confusion is None:
        beliefs = [(track, track.category, 1.0) for track in tracker.tracks]
    else:
        beliefs = [(t, c, b if weighs else 1.0) for t, c, b in believed(tracker.tracks, (), expected)]
    made, taken = [], set[int]()
    for track, category, belief in sorted(beliefs, key=lambda each: -each[2]):
        if category in expected:
            thing = thing_of[track]
            right = kinds.get(thing) == category and thing not in taken
            taken |= {thing} if right else set()
            made.append((belief, right))
    seen = {thing for look in looks for thing in look.visible if kinds[thing] in expected}
    return made, len(seen)


def crossed(looks: Sequence[Observed], classes: list[str], fuses: bool, weighs: bool) -> tuple[list[Outcome], int]:
    """The outcomes of all scenes, fused by the errors in the other half of them."""
    scenes = [list(mine) for _, mine in groupby(looks, key=lambda look: look.scene)]
    made, things = [], 0
    for half in (0, 1):
        others = [look for number, mine in enumerate(scenes) for look in mine if number % 2 != half]
        errors = confusion_of(others, classes, "", "", weight_of_repeats(others, classes)) if fuses else None
        for mine in scenes[half::2]:
            told, seen = outcomes(mine, errors, weighs)
            made, things = made + told, things + seen
    return made, things


def precision(found: Sequence[Outcome], things: int) -> float:
    """The average precision; tracks that are believed alike count at once."""
    total = right = count = 0.0
    for _, group in groupby(sorted(found, key=lambda each: -each[0]), key=lambda each: each[0]):
        alike = [good for _, good in group]
        count, right = count + len(alike), right + sum(alike)
        total += sum(alike) * right / count
    return total / things


def chart(values: dict[str, float]) -> None:
    """Draw the average precision of each of the parts."""
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "known", "font.size": 11})
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(7.0, 3.2), layout="constrained")
    names = [*reversed(values)]
    bars = axes.barh(names, [values[name] for name in names], color="#1f6fb4")
    axes.bar_label(bars, fmt="%.2f", padding=3)
    axes.set_xlabel("average precision of what agents know after ten looks")
    axes.set_xlim(0.0, 1.0)
    axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(CHART, metadata={"Date": None})


def main() -> None:
    """Look, and write the table and the figure."""
    seen = {(every, second): looks_of(every, second) for every in (3, 1) for second in (False, True)}
    text, values, things, scenes = "", {}, 0, 0
    for name, (every, second, fuses, weighs) in PARTS.items():
        looks, classes = seen[every, second]
        found, things = crossed(looks, classes, fuses, weighs)
        scenes, values[name] = len({look.scene for look in looks}), precision(found, things)
        right, wrong = (sum(good is kind for belief, good in found if belief >= SURE) for kind in (True, False))
        told = f"{right} | {wrong} | {100 * right / things:.0f} % | {values[name]:.3f}"
        text += f"| {name} | {told} | {f'{ece(found):.3f}' if weighs else '-'} |\n"
        print(text.splitlines()[-1], flush=True)
    chart(values)
    head = HEAD.format(scenes=scenes, things=things, machine=machine())
    (HERE / "known.md").write_text(head + text, encoding="utf-8")


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main()
