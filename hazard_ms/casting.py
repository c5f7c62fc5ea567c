"""Which scene an episode is played in: the one that was asked for, or the one that its seed chooses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from hazard_ms.checks import one_of


def by_seed(seeds: np.ndarray, names: Sequence[str]) -> list[str]:
    """Seed s plays in scene s modulo their number: consecutive seeds go through all of them."""
    return [names[int(s) % len(names)] for s in seeds]


def by_name(wanted: Any, allowed: Sequence[str], num_envs: int) -> list[str]:
    """The scenes of a reset's option: one name for all environments, or a list of one for each."""
    names = [wanted] * num_envs if isinstance(wanted, str) else wanted
    if not isinstance(names, (list, tuple)) or len(names) != num_envs:
        raise ValueError(f"reset option 'scene' is {wanted!r}; a scene's name, or a list of {num_envs}, is allowed")
    return [one_of(n, allowed, "scene") for n in names]
