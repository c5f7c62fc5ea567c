"""The crops that a step draws, of several scales: around things of all categories and hazard states, or anywhere."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from hazard_ms.perception.detectors.small_network import SCALE
from hazard_ms.perception.layout import category_ids
from hazard_ms.perception.score import STATES
from hazard_ms.perception.training.crops import Crop, cut, mirrored
from hazard_ms.perception.training.pictures import Picture

# [ours], all of them
OF_THINGS = 0.85  # share of crops that are cut around a thing; the others are cut anywhere
OFF_CENTRE = 0.375  # by which such a thing may be beside the middle of its crop, as a share of the side
AS_IT_IS = 0.4  # share of crops that are as large as in the picture; the others are from SMALLEST to LARGEST times
SMALLEST, LARGEST = 0.5, 1.5
PLAIN = 256.0  # area from which a thing is drawn as often as its category and state ask [pixels]
RARELY = 0.25  # of that, however small a thing is
ORDER = ("burning", "burnt", "more than half under water", "floating", "moving", "wet")  # the first that fits
DRY = "dry, not burnt"  # also of things whose state is not told


def state_of(thing: Mapping[str, Any]) -> str:
    """The hazard state of an annotation: the first of ORDER, as scores count them, that fits its attributes."""
    told = thing.get("attributes") or {}
    usual = {"status": "normal", "wet": False, "submerged": 0.0, "floating": False, "speed_mps": 0.0}
    given = usual | {key: value for key, value in told.items() if value is not None}
    return next((name for name in ORDER if STATES[name](given)), DRY)


class Drawing:
    """Pictures, from which crops with `sides` (width, height) [pixels] are drawn."""

    def __init__(self, pictures: Sequence[Picture], classes: Sequence[str], size: int) -> None:
        """Draw crops with sides of `size` [pixels], or of the smallest picture, around things of `classes`."""
        self._pictures = list(pictures)
        least = (min(picture.row[side] for picture in pictures) for side in ("width", "height"))
        self.sides = tuple(min(size, edge - edge % SCALE) for edge in least)
        self.numbers = {name: k for k, name in enumerate(classes, start=1)}
        names = {number: name for name, number in category_ids().items()}
        known = [(k, t, names[t["category_id"]]) for k, p in enumerate(pictures) for t in p.things]
        known = [(k, t, name) for k, t, name in known if name in self.numbers]
        self._things = [(k, t) for k, t, _ in known]
        groups = [(name, state_of(t)) for _, t, name in known]
        count = Counter(groups)
        size_of = [math.sqrt(t["bbox"][2] * t["bbox"][3] / PLAIN) for _, t, _ in known]
        pairs = zip(groups, size_of, strict=True)
        chances = np.array([min(max(large, RARELY), 1.0) / math.sqrt(count[group]) for group, large in pairs])
        self._chances = np.cumsum(chances / chances.sum())

    def crop(self, chance: np.random.Generator) -> Crop:
        """A crop around a thing of a category and state of which there are few, or anywhere; half are mirrored."""
        if chance.random() < OF_THINGS:
            number, thing = self._things[int(np.searchsorted(self._chances, chance.random()))]
            box = thing["bbox"]
            middle, off = (box[0] + box[2] / 2, box[1] + box[3] / 2), OFF_CENTRE
        else:
            number = int(chance.integers(len(self._pictures)))
            middle, off = tuple(chance.uniform(0.0, 1e4, 2)), 0.0
        picture = self._pictures[number]
        edges = picture.row["width"], picture.row["height"]
        window = self._window(edges, chance)
        shift = chance.uniform(-off, off, 2)
        left, top = (
            int(np.clip(middle[k] + shift[k] * window[k] - window[k] / 2, 0, edges[k] - window[k])) for k in range(2)
        )
        made = cut(picture, self.numbers, (left, top), window, self.sides)
        return mirrored(made) if chance.random() < 0.5 else made

    def _window(self, edges: tuple[int, int], chance: np.random.Generator) -> tuple[int, int]:
        """Width and height of the part of a picture with `edges` that becomes a crop [pixels]."""
        scale = math.exp(chance.uniform(math.log(SMALLEST), math.log(LARGEST)))
        scale = 1.0 if chance.random() < AS_IT_IS else scale
        scale = max(scale, *(side / edge for side, edge in zip(self.sides, edges, strict=True)))
        width, height = (min(round(side / scale), edge) for side, edge in zip(self.sides, edges, strict=True))
        return width, height
