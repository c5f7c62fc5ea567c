"""Water in a home, foreseen by the law of the paper from where it was seen: it falls along its way, and rises.

    level(p, t) = rise t - drop(p),   drop(p) = least of drop(c) + tan(1 degree) way(c, p) over places c seen wet

Ways lead through what is open: behind shut doors it stays dry (docs/physics.md 1.2). How fast it rises is what the
highest level was over the frame in which it was seen, as it is at the wall from which it comes; or faster, if it was
seen to. In `realistic` water is flatter than that, and this foresees it too late far from where it was seen [ours].
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from hazard_ms.agents.search.floor_plan import FloorPlan
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sensing.target_table import Target
from hazard_ms.spec.catalogue import CATEGORIES

SLOPE = math.tan(math.radians(1.0))  # of the surface along the way (docs/benchmark.md 1.1)
WATER_DENSITY = 1000.0  # [kg/m^3]
LEAST = 0.01  # level below which nothing floats off [m] [ours: tops are seen to a centimetre]
WET = 0.003  # level from which a cell was seen wet [m] [ours]
AT_SOURCE = 0.03  # drop up to which water comes in beside a place [m] [ours]

Array = NDArray[np.float64]


class HouseWater:
    """The water that is to come, over the part of a map that was seen."""

    def __init__(self, seen: SemanticMap, number: int, plan: FloorPlan) -> None:
        """The water of the hazard `number` of the map `seen`, where `plan` lets it pass."""
        level = seen.levels[number][plan.window].astype(np.float64)
        frame = seen.told_at[plan.window].astype(np.float64)
        known = np.isfinite(level) & (frame > 0.0)
        wet = known & (level >= WET)
        self.rise = float((level[wet] / frame[wet]).max()) if wet.any() else 0.0  # [m/frame]
        drop = np.where(wet, np.maximum(self.rise * frame - level, 0.0), np.inf)
        if wet.any():  # where nothing comes any more it does not rise
            room, _ = ndimage.label(~plan.wall, np.ones((3, 3)))
            fed = np.unique(room[wet & (drop <= max(AT_SOURCE, float(drop.min())))])
            drop = np.where(np.isin(room, fed), drop, np.inf)
        self._plan, self._drop = plan, plan.spread(drop, SLOPE)
        dry = known & (level <= 0.0)
        self._drop = np.where(dry, np.maximum(self._drop, self.rise * frame), self._drop)

    def at(self, points: ArrayLike, frames: ArrayLike) -> Array:
        """Levels [m], [K, M], at M `points` [m], [M, 2], at K `frames`, [K]; 0 where it is dry."""
        drop = self._plan.at(self._drop, np.asarray(points, np.float64).reshape(-1, 2))
        rising = self.rise * np.asarray(frames, np.float64)
        return np.maximum(rising[:, None] - drop, 0.0)


def soaked_at(target: Target, sighting: Sighting) -> float:
    """The level [m] at which water damages a thing where it was seen; inf for never."""
    return np.inf if target.waterproof else float(sighting.position[2])


def floats_at(target: Target, sighting: Sighting) -> float:
    """The level [m] at which water carries a thing away from where it was seen; inf for never.

    It is then lost unless it is rescued, but whole (docs/benchmark.md 4.3).
    """
    low, kind = max(2.0 * float(sighting.position[2]) - sighting.top, 0.0), CATEGORIES.get(target.category)
    if kind is None or kind.density >= WATER_DENSITY:
        return np.inf
    return max(low + kind.density / WATER_DENSITY * (sighting.top - low), LEAST)
