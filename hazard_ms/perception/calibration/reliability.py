"""Whether beliefs are so: of the tracks that are believed with about one chance, as large a share should be right."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from itertools import groupby

import numpy as np

from hazard_ms.perception.calibration.measuring import confusion_of
from hazard_ms.perception.calibration.observing import Observed
from hazard_ms.sensing.detection.beliefs import believed
from hazard_ms.sensing.detection.confusion import Confusion
from hazard_ms.sensing.detection.track import Track
from hazard_ms.sensing.detection.tracks import Tracker

BINS = 10  # of beliefs, from 0 to 1 [ours]
REPEATED = (0.3, 0.5, 0.7, 1.0)  # exponents of looks after the first that are tried [ours]
TINY = 1e-3  # no chance counts as smaller where beliefs are compared [ours]
Outcome = tuple[float, bool]  # the belief in a track, and whether it was right


def outcomes(looks: Sequence[Observed], confusion: Confusion) -> list[Outcome]:
    """The beliefs in all tracks after the last picture of each scene.

    A track is right if the thing that it was last seen as is of its category, and no surer track is of the same thing.
    """
    made: list[Outcome] = []
    for _, mine in groupby(looks, key=lambda look: look.scene):
        tracker, thing_of = Tracker(confusion), dict[Track, int]()
        scene = list(mine)
        for frame, look in enumerate(scene):
            found = {number: told.found for number, told in enumerate(look.told)}
            for number, track in tracker.update(look.view, frame, found)[0].items():
                thing_of[track] = look.told[number].thing
        sure = believed(tracker.tracks, (), Counter(scene[0].kinds.values()))
        taken = set[int]()
        for track, category, belief in sorted(sure, key=lambda each: -each[2]):
            thing = thing_of[track]
            right = thing not in taken and scene[0].kinds.get(thing) == category
            taken |= {thing} if right else set()
            made.append((belief, right))
    return made


def crossed(looks: Sequence[Observed], classes: Sequence[str], repeated: float = 1.0) -> list[Outcome]:
    """The outcomes of each half of the scenes by the errors that were counted in the other half.

    `repeated`: the exponent of what looks after the first tell.
    """
    numbers: dict[str, int] = defaultdict(lambda: len(numbers))
    half = [numbers[look.scene] % 2 for look in looks]
    made: list[Outcome] = []
    for own in (0, 1):
        mine = [look for look, each in zip(looks, half, strict=True) if each == own]
        others = [look for look, each in zip(looks, half, strict=True) if each != own]
        made += outcomes(mine, confusion_of(others, classes, "", "", repeated))
    return made


def weight_of_repeats(looks: Sequence[Observed], classes: Sequence[str]) -> float:
    """The exponent of REPEATED by which what was found right and wrong in `looks` is likeliest."""
    return max(REPEATED, key=lambda repeated: _likelihood(crossed(looks, classes, repeated)))


def _likelihood(found: Sequence[Outcome]) -> float:
    """The mean logarithm of the chance that was given to what is so."""
    chances = [belief if right else 1.0 - belief for belief, right in found]
    return float(np.log(np.maximum(chances, TINY)).mean()) if chances else 0.0


def table(found: Sequence[Outcome]) -> str:
    """The reliability diagram as a table in Markdown, and the expected calibration error (ECE)."""
    lines = ["| belief | tracks | mean belief | right |", "|---|---|---|---|"]
    for low, mine in _bins(found):
        beliefs, right = zip(*mine, strict=True)
        lines.append(
            f"| {low:.1f} to {low + 1 / BINS:.1f} | {len(mine)} | {np.mean(beliefs):.3f} | {np.mean(right):.3f} |"
        )
    return "\n".join([*lines, "", f"ECE {ece(found):.3f} of {len(found)} tracks"])


def ece(found: Sequence[Outcome]) -> float:
    """The distance between belief and the share that was right, its mean over all tracks by bins of beliefs."""
    apart = [len(mine) * abs(np.mean([b for b, _ in mine]) - np.mean([r for _, r in mine])) for _, mine in _bins(found)]
    return float(sum(apart) / max(len(found), 1))


def _bins(found: Sequence[Outcome]) -> list[tuple[float, list[Outcome]]]:
    """The outcomes by bins of beliefs, with the lower end of each; empty bins are left out."""
    made: dict[int, list[Outcome]] = defaultdict(list)
    for belief, right in found:
        made[min(int(belief * BINS), BINS - 1)].append((belief, right))
    return [(number / BINS, made[number]) for number in sorted(made)]
