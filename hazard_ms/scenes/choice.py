"""The choice of the scene of an episode: the one that was asked for, or the one that its seed chooses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from hazard_ms.spec import Task
from hazard_ms.spec.checks import one_of

LISTING = "`hazard-ms scenes list` prints all"


def by_seed(seeds: Sequence[int] | np.ndarray, names: Sequence[str]) -> list[str]:
    """The scenes of `seeds`, [E]: seed s plays in scene s modulo their number, so consecutive seeds go through all."""
    return [names[int(s) % len(names)] for s in seeds]


def by_name(wanted: Any, allowed: Sequence[str], num_envs: int) -> list[str]:
    """The scenes that a reset asks for: one name for all environments, or a list with one for each.

    Raises ValueError for lists of another length and for unknown names.
    """
    names = [wanted] * num_envs if isinstance(wanted, str) else wanted
    if not isinstance(names, (list, tuple)) or len(names) != num_envs:
        raise ValueError(f"reset option 'scene' must be a scene's name or a list of {num_envs} names, got {wanted!r}")
    return [one_of(n, allowed, "scene", LISTING) for n in names]


class SceneChoice:
    """The scenes of a task that are played in one split.

    Raises ValueError for a split that the task does not have.
    """

    def __init__(self, task: Task, split: str) -> None:
        self.split = one_of(split, task.splits, "split")
        self.scenes = task.scenes(split)
        self._every = task.all_scenes

    def names(self, wanted: Any, seeds: Sequence[int] | np.ndarray) -> list[str]:
        """The scene of each environment: the `wanted` ones of any split, or where that is None those of `seeds`, [E].

        Raises ValueError for unknown names, and for lists of another length.
        """
        return by_seed(seeds, self.scenes) if wanted is None else by_name(wanted, self._every, len(seeds))


class SceneTurns:
    """Counts resets without a seed: every `every`-th one since the last one with a seed draws a new scene; 0: none."""

    def __init__(self, every: int) -> None:
        self._every, self._count = every, 0

    def next(self, seeded: bool) -> bool:
        """Count one more reset; whether it draws a new scene."""
        self._count = 0 if seeded else self._count + 1
        return self._every > 0 and self._count > 0 and self._count % self._every == 0
