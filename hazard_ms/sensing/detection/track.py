"""One thing that was detected, perhaps more than once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.detection.fusion import APART, Evidence
from hazard_ms.sensing.sighting import Sighting, merged
from hazard_ms.spec.catalogue import CATEGORIES

GATE = 0.3  # distance within which a thing of the same category is the same one [m] [ours]
DRIFT = 0.016  # by which that grows for a thing that has moved: what a robot walks in a frame [m/frame] [ours]
UNSEEN_DRIFT, UNSEEN_MOST = 0.004, 1.0  # the same for one out of sight [m/frame], and at most [m] [ours]
WIDEST = 0.3  # half the width of what can be carried: a mask that is wider shows more than the thing [m] [ours]
CART, CART_WIDEST = "cart", 0.55  # the same for carts, which are 0.56 m by 0.94 m [m] [ours]


class Found(NamedTuple):
    """A detection as tracks take it: its category, where it is, and the chances that the detector told, if it did."""

    category: str
    sighting: Sighting
    chances: tuple[float, ...] | None = None
    shown: tuple[float, ...] | None = None  # see hazard_ms.sensing.detection.odds


@dataclass(eq=False)
class Track:
    """One thing that was detected, perhaps more than once."""

    category: str
    sighting: Sighting
    frames: int = 1  # in which it was seen
    empty: int = 0  # frames since then in which its place was seen empty
    index: int = -1  # by which the agent knows it; -1: not yet
    score: float = 0.0  # of its surest detection
    refuted: bool = False  # whether it turned out not to be there, so that it is never believed again
    rescued: bool = False
    evidence: Evidence | None = None  # of all looks; None where they are not fused
    size: float = 0.0  # its pixels at 1 m, by the last sighting
    missed_from: NDArray[np.floating] | None = None  # where the eye was at the last look that must show it, [3] [m]
    belief: float = 1.0  # the chance that it is there and of its category

    @property
    def loose(self) -> bool:
        """Whether it can move."""
        return CATEGORIES[self.category].kind == "object"

    @property
    def radius(self) -> float:
        """The distance from its middle within which the thing lies [m], by what was seen of it and what it can be."""
        most = WIDEST if self.loose else CART_WIDEST if self.category == CART else float("inf")
        return min(self.sighting.radius, most)

    def reach(self, frame: int) -> float:
        """Distance from where it was seen last within which it may be at `frame` [m]."""
        age = frame - self.sighting.frame
        if not self.loose:
            return GATE + self.radius
        return GATE + (DRIFT * age if self.empty else min(UNSEEN_DRIFT * age, UNSEEN_MOST))

    def see(self, seen: Sighting, frame: int) -> None:
        """Enter that it was `seen` at `frame`."""
        self.frames += self.sighting.frame < frame
        self.sighting, self.empty, self.missed_from = merged(self.sighting, seen), 0, None

    def miss(self, eye: NDArray[np.floating]) -> None:
        """Enter that a look from the place `eye` [m], [3], shows its place plainly, and not the thing: it has moved.

        Looks from about one place err alike and count once.
        """
        if self.loose and not self.rescued:
            if self.missed_from is None or np.linalg.norm(self.missed_from - eye) >= APART:
                self.empty, self.missed_from = self.empty + 1, np.array(eye, np.float64)
