"""The random draws of a scene: a function of the generator's version and the scene's name, the same on every machine.

Only raw uniform numbers of PCG64 are used: numpy keeps that stream the same over its versions, unlike `choice` or
`integers`.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import TypeVar

import numpy as np

T = TypeVar("T")

GENERATOR = "2.4"  # goes up whenever the same name would give another scene
STREAM = "2"  # of random numbers; goes up when all scenes shall be drawn anew


class Draw:
    """A stream of random draws. Attempts at the same scene differ by `attempt`."""

    def __init__(self, version: str, name: str, attempt: int = 0) -> None:
        digest = hashlib.sha256(f"{version}|{name}|{attempt}".encode()).digest()
        self._raw = np.random.Generator(np.random.PCG64(int.from_bytes(digest[:16], "little")))

    def uniform(self, low: float = 0.0, high: float = 1.0) -> float:
        """A number that is uniform from `low` up to, but not including, `high`."""
        return low + (high - low) * float(self._raw.random())

    def whole(self, low: int, high: int) -> int:
        """A whole number from `low` to `high`, both included."""
        return low + int(float(self._raw.random()) * (high - low + 1))

    def one(self, items: Sequence[T]) -> T:
        """One of `items`, all equally likely."""
        return items[self.whole(0, len(items) - 1)]

    def weighted(self, items: Sequence[T], weights: Sequence[float]) -> T:
        """One of `items`, with probabilities in proportion to `weights`."""
        left = self.uniform(0.0, sum(weights))
        for item, weight in zip(items, weights, strict=True):
            left -= weight
            if left < 0.0:
                return item
        return items[-1]

    def shuffled(self, items: Sequence[T]) -> list[T]:
        """All of `items` in random order."""
        pile = list(items)
        for i in range(len(pile) - 1, 0, -1):
            j = self.whole(0, i)
            pile[i], pile[j] = pile[j], pile[i]
        return pile
