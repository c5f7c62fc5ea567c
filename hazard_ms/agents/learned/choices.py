"""Choices of a teacher, from which a student learns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

HELD_OUT = 10  # every so many episodes, one is kept to see how well a student agrees with it [ours]


@dataclass(frozen=True)
class Choices:
    """M decisions at which a teacher began an option that its student could choose, too."""

    features: NDArray[np.float32]  # as of `hazard_ms.skills.options.features`, [M, F]
    mask: NDArray[np.bool_]  # options that could be chosen, [M, A]
    option: NDArray[np.int64]  # that the teacher chose, [M]
    episode: NDArray[np.int64]  # number of its episode, [M]

    def of(self, rows: NDArray[np.bool_]) -> Choices:
        """Some of them; `rows`: which, [M]."""
        return Choices(*(getattr(self, name)[rows] for name in ("features", "mask", "option", "episode")))

    def split(self) -> tuple[Choices, Choices]:
        """Choices to learn from, and those of every tenth episode, which are none if there are fewer episodes."""
        out = self.episode % HELD_OUT == HELD_OUT - 1
        return self.of(~out), self.of(out)
