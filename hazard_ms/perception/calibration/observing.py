"""Captured pictures as a detector sees them, one by one, beside what is there."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hazard_ms.perception.calibration.thinned import Thinned
from hazard_ms.sensing.camera import STRUCTURE
from hazard_ms.sensing.detection.detector import Detection, Detector
from hazard_ms.sensing.detection.labeller import THRESHOLD
from hazard_ms.sensing.detection.numbered import found_in
from hazard_ms.sensing.detection.odds import in_front
from hazard_ms.sensing.detection.track import Found
from hazard_ms.sensing.sighting import SEEN_PIXELS, Sighting, sightings
from hazard_ms.sensing.view import View
from hazard_ms.spec.catalogue import CATEGORIES


@dataclass(frozen=True)
class Told:
    """One detection: its category, where it is, and the number of the thing that it is of, 0 where it is of none."""

    category: str
    sighting: Sighting
    thing: int
    chances: tuple[float, ...] | None = None  # as the detector told them
    shown: tuple[float, ...] | None = None  # see hazard_ms.sensing.detection.odds

    @property
    def found(self) -> Found:
        """The detection as tracks take it."""
        return Found(self.category, self.sighting, self.chances, self.shown)


@dataclass(frozen=True)
class Observed:
    """One picture: what was told, the surest last, and the things that are visible in it."""

    scene: str  # with its dataset
    view: View  # its labels are numbers of `told`, or below 0
    told: tuple[Told, ...]
    visible: dict[int, int]  # pixels by number
    kinds: dict[int, str]  # categories of all things of the scene by number


def observed(detector: Detector, pictures: Sequence[Thinned], classes: Sequence[str]) -> list[Observed]:
    """The `pictures` as a detector sees them, with things of `classes`; things of other categories count as none.

    A detection is of the thing that has more than half of its pixels.
    """
    made = []
    taken = Counter[str]()  # pictures by scene
    for picture in pictures:
        scene = f"{picture.picture.dataset.name}/{picture.scene}"
        frame, taken[scene] = taken[scene], taken[scene] + 1
        ids, categories = picture.ids(), picture.picture.categories()
        kinds = {number: kind for number, kind in categories.items() if kind in classes}
        view = View(picture.depth(), picture.intrinsic(), picture.cam2world())
        detector.aim(view.intrinsic, view.cam2world)
        found = [
            d for d in detector.detect(picture.rgb(), view.depth) if d.score >= THRESHOLD and d.category in classes
        ]
        found.sort(key=lambda d: d.score)
        labels = np.full(ids.shape, STRUCTURE, np.int64)
        for number, one in enumerate(found):
            labels[in_front(one.mask, view.depth) if _fixed(one) else one.mask] = number
        labelled = replace(view, labels=labels)
        seen = sightings(labelled, frame, len(found), frozenset(), None)
        told: list[Told] = []
        of_told = np.full(ids.shape, STRUCTURE, np.int64)
        for number, sighting in seen.items():
            of_told[labels == number] = len(told)
            under = ids[labels == number]
            thing, pixels = Counter(under.tolist()).most_common(1)[0]
            real = 2 * pixels > len(under) and thing in kinds
            mine = found_in(labelled, number, found[number], sighting, _fixed(found[number]))
            told.append(Told(mine.category, sighting, thing if real else 0, mine.chances, mine.shown))
        numbers, counts = np.unique(ids, return_counts=True)
        known = zip(numbers.tolist(), counts.tolist(), strict=True)
        visible = {number: pixels for number, pixels in known if number in kinds and pixels >= SEEN_PIXELS}
        view = replace(view, labels=of_told)
        made.append(Observed(scene, view, tuple(told), visible, kinds))
    return made


def _fixed(one: Detection) -> bool:
    """Whether a detection is of furniture, of which detectors of what is sought know carts alone."""
    return CATEGORIES[one.category].kind != "object"
