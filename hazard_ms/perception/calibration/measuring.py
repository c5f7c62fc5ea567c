"""The errors of a detector, counted in what it told of captured pictures.

Detections of one scene that are of none of the known categories are one place of clutter where they lie within SAME.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hazard_ms.perception.calibration.observing import Observed
from hazard_ms.perception.calibration.regression import odds_of
from hazard_ms.perception.calibration.telling import near, worth
from hazard_ms.sensing.detection.confusion import Confusion
from hazard_ms.sensing.detection.tracks import BEHIND
from hazard_ms.sensing.view import View

BUCKETS = (0, 16, 32, 64, 128, 256)  # least pixels of each [ours]
SAME = 0.3  # distance of detections that are of one place, as the gate of tracks [m] [ours]
NONE = ""  # told of a look that missed
DIGITS = 4  # of a share


@dataclass
class Clutter:
    """A place that shows none of the known categories: what it was told as, first and by later looks."""

    place: NDArray[np.float32]  # [3] [m]
    told: list[str] = field(default_factory=list)  # NONE for a look that missed it


def confusion_of(
    looks: Sequence[Observed], classes: Sequence[str], eyes: str, command: str, repeated: float = 1.0
) -> Confusion:
    """The table of what was told; each share is as after two more looks, of which one went well.

    `repeated`: the exponent of what looks after the first tell.
    """
    found, right, ever = np.ones((len(BUCKETS), 2)), np.ones((len(BUCKETS), 2)), np.ones(2)  # well, not well
    taken: dict[str, Counter[str]] = defaultdict(Counter)
    for seen in _things(looks).values():
        hits = sum(told != NONE for _, told, _ in seen)
        ever[int(not hits)] += 1
        for category, told, pixels in seen:
            bucket = int(np.searchsorted(BUCKETS, pixels, "right")) - 1
            if hits - (told != NONE) > 0:  # another look found it, as with every track
                found[bucket, int(told == NONE)] += 1
            if told != NONE:
                right[bucket, int(told != category)] += 1
            if told not in (NONE, category):
                taken[category][told] += 1
    places = _clutter(looks)
    clutter = Counter(place.told[0] for place in places)
    again, steady = _repeats(places)
    by_first = {name: _repeats([place for place in places if place.told[0] == name]) for name in sorted(clutter)}
    scenes = len({look.scene for look in looks})
    return Confusion(
        classes=tuple(classes),
        pixels=BUCKETS,
        found=tuple(map(_share, found)),
        right=tuple(map(_share, right)),
        taken={k: {j: float(n) for j, n in sorted(row.items())} for k, row in sorted(taken.items())},
        clutter={k: round(n / scenes, DIGITS) for k, n in sorted(clutter.items())},
        again=_share(again),
        steady=_share(steady),
        again_of={name: _share(near(own, again)) for name, (own, _) in by_first.items()},
        steady_of={name: _share(near(own, steady)) for name, (_, own) in by_first.items()},
        seen=_share(ever),
        repeated=repeated,
        eyes=eyes,
        command=command,
        odds_of=odds_of(looks),
        **worth(looks, classes),
    )


def _repeats(places: Sequence[Clutter]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """How many later looks at `places` tell something, and not; and how many of the first tell the same, and not."""
    again, steady = np.ones(2), np.ones(2)
    for place in places:
        for told in place.told[1:]:
            again[int(told == NONE)] += 1
            if told != NONE:
                steady[int(told != place.told[0])] += 1
    return again, steady


def _share(counts: NDArray[np.float64]) -> float:
    """The first of two counts as a share of both."""
    return round(float(counts[0] / counts.sum()), DIGITS)


def _things(looks: Sequence[Observed]) -> dict[tuple[str, int], list[tuple[str, str, int]]]:
    """Of each thing, by scene and number, every look: its category, what was told, NONE for nothing, and its pixels."""
    made: dict[tuple[str, int], list[tuple[str, str, int]]] = defaultdict(list)
    for look in looks:
        told = {each.thing: each.category for each in look.told}  # the surest stays
        for number, pixels in look.visible.items():
            made[look.scene, number].append((look.kinds[number], told.get(number, NONE), pixels))
    return made


def _clutter(looks: Sequence[Observed]) -> list[Clutter]:
    """All places of clutter, with the looks at each from the first that told it on, and those that missed it."""
    known: dict[str, list[Clutter]] = defaultdict(list)
    for look in looks:
        for each in look.told:
            if not each.thing:
                place = each.sighting.position
                near = next((c for c in known[look.scene] if np.linalg.norm(c.place - place) < SAME), None)
                if near is None:
                    known[look.scene].append(near := Clutter(place))
                near.told.append(each.category)
    for look in looks:
        places = [each.sighting.position for each in look.told if not each.thing]
        for clutter in known[look.scene]:
            missed = all(np.linalg.norm(place - clutter.place) >= SAME for place in places)
            if missed and _shows(look.view, clutter.place):
                clutter.told.append(NONE)
    return [clutter for places in known.values() for clutter in places]


def _shows(view: View, place: NDArray[np.float32]) -> bool:
    """Whether a picture shows what is at a place [m], [3]."""
    pixel = view.pixel_of(place)
    return pixel is not None and abs(float(view.depth[pixel[0], pixel[1]]) - pixel[2]) < BEHIND
