"""The truth with stated faults: planners can be studied against the quality of perception without any network.

Faults that come and go from frame to frame hurt little, since agents look often; a network that misses a thing tends to
miss it again. `hold` makes faults last.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from hazard_ms.sensing.detection.detector import Detection, PrivilegedDetector, box_of
from hazard_ms.spec.catalogue import CATEGORIES
from hazard_ms.spec.checks import whole

MOST_EROSION = 64  # pixels; any larger number must be a mistake [ours]
MOST_HOLD = 10**6  # frames; longer than any episode [ours]
STREAM = 0x4E4F4953  # "NOIS": not the random numbers of anything else with the same seed


class Noisy(PrivilegedDetector):
    """Misses things, takes them for others and sees too little of them, each thing in each frame by chance of its own.

    The chance is a function of the episode's seed, the frame and the thing's index: the same in every process.
    """

    def __init__(self, miss: float = 0.0, confuse: float = 0.0, erode: int = 0, hold: int = 1) -> None:
        """State the faults.

        `miss`: share of things that are not found; `confuse`: share of the others that get the category of another
        thing of the scene, furniture that of furniture; `erode`: pixels by which masks shrink on all sides; `hold`:
        frames for which a thing's faults stay the same. Raises ValueError for shares that are not from 0 to 1, and for
        other numbers of pixels than 0 to 64 and of frames than 1 to 1,000,000.
        """
        for name, share in (("miss", miss), ("confuse", confuse)):
            if not 0.0 <= share <= 1.0:
                raise ValueError(f"{name} must be from 0 to 1, got {share!r}")
        self._miss, self._confuse = miss, confuse
        self._erode = whole(erode, 0, MOST_EROSION, "erode")
        self._hold = whole(hold, 1, MOST_HOLD, "hold")

    def detect(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        """Find some of the true things of the picture; `rgb` [H, W, 3] and `depth` [H, W] [m] are not looked at."""
        labels, found = self.truth.labels, []
        for index in np.unique(labels[labels >= 0]).tolist():
            chance = np.random.default_rng([STREAM, self.truth.seed, self.truth.frame // self._hold, index])
            missed, confused = chance.random() < self._miss, chance.random() < self._confuse
            mask = labels == index
            if self._erode:
                mask = ndimage.binary_erosion(mask, iterations=self._erode, border_value=1)
            if missed or not mask.any():
                continue
            category = self.truth.categories[index]
            others = self._others(category) if confused else []
            taken_for = others[int(chance.integers(len(others)))] if others else category
            found.append(Detection(taken_for, 1.0, box_of(mask), mask))
        return found

    def _others(self, category: str) -> list[str]:
        """The other categories of its kind in the scene, in a fixed order."""
        kind = CATEGORIES[category].kind
        return sorted({c for c in self.truth.categories if c != category and CATEGORIES[c].kind == kind})
