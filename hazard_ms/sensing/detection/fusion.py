"""The evidence of all looks at the place of one track, by `hazard_ms.sensing.detection.confusion`.

Looks from about one place err alike, so of those from within APART of each other only the one with the most pixels
counts, the earliest of equal ones.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.detection.confusion import Confusion, Look

APART = 0.5  # distance between places from which looks err each in its own way [m] [ours]
UNTOLD = 0.2  # how many things there are of a category that nobody has told of [ours]
SWITCH = 2.0  # how much likelier another category must be before a track changes its own [ours]


class Evidence:
    """The looks at one place that count."""

    def __init__(self, confusion: Confusion, look: Look, eye: NDArray[np.floating]) -> None:
        """Begin with a `look` that tells something, from the place `eye` [m], [3]."""
        self._confusion = confusion
        self._looks = [look]
        self._eyes = [np.array(eye, np.float64)]

    def look(self, look: Look, eye: NDArray[np.floating]) -> None:
        """Enter a `look` from the place `eye` [m], [3]."""
        far = np.linalg.norm(np.array(self._eyes) - eye, axis=-1)
        near = int(np.argmin(far))
        if far[near] >= APART:
            self._looks.append(look)
            self._eyes.append(np.array(eye, np.float64))
        elif look.pixels > self._looks[near].pixels and (
            near > 0 or look.told is not None
        ):  # the first tells something
            self._looks[near] = look

    def join(self, other: Evidence) -> None:
        """Add the looks of `other` at the same thing: of those from about one place the one that tells most counts."""
        every = zip(self._looks + other._looks, self._eyes + other._eyes, strict=True)
        self._looks, self._eyes = [], []
        for look, eye in sorted(every, key=lambda each: (each[0].told is None, -each[0].pixels)):
            if not self._eyes or np.linalg.norm(np.array(self._eyes) - eye, axis=-1).min() >= APART:
                self._looks.append(look)
                self._eyes.append(eye)

    @property
    def looks(self) -> tuple[Look, ...]:
        """The looks that count, in their order."""
        return tuple(self._looks)

    def chances(self, expected: Mapping[str, float]) -> dict[str, float]:
        """The chance of each category, where so many of each are `expected` in the scene; the rest is none of them."""
        found = self._confusion.posterior(self._looks, expected, UNTOLD)
        return dict(zip(self._confusion.classes, found[:-1].tolist(), strict=True))


def category_of(chances: Mapping[str, float], now: str) -> str:
    """The category of a track that has been `now`: another one only if that is SWITCH times as likely."""
    best = max(chances, key=lambda name: chances[name])
    return best if chances[best] > SWITCH * chances.get(now, 0.0) else now
