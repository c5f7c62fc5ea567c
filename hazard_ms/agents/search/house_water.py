"""Water in a home, foreseen by the law of the paper from where it was seen: it falls along its way, and rises.

    level(p, t) = rise t - drop(p),   drop(p) = least of drop(c) + tan(1 degree) way(c, p) over places c seen wet

Ways lead through what is open: behind shut doors it stays dry (docs/physics.md 1.2). Behind a flood board in an outer
door it stays as high as it was when the board was set: it rises on from the other outer doors alone, and nowhere once
boards stand in all. As long as less than OUTER_DOORS are known, one is believed to be open somewhere. How fast it rises
is what the highest level was over the frame in which it was seen, as it is at the wall from which it comes; or faster,
if it was seen to. In `realistic` water is flatter than that, and this foresees it too late far from where it was seen
[ours].
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from hazard_ms.agents.search.floor_plan import FloorPlan
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sensing.target_table import Target
from hazard_ms.spec.catalogue import CATEGORIES

SLOPE = math.tan(math.radians(1.0))  # of the surface along the way (docs/benchmark.md 1.1)
WATER_DENSITY = 1000.0  # [kg/m^3]
LEAST = 0.01  # level below which nothing floats off [m] [ours: tops are seen to a centimetre]
WET = 0.003  # level from which a cell was seen wet [m] [ours]
OUTER_DOORS = 2  # of a home [hazard_ms.scenes.generate.house.plan]
AT_SOURCE = 0.03  # drop up to which water comes in beside a place [m] [ours]

Array = NDArray[np.float64]


class HouseWater:
    """The water that is to come, over the part of a map that was seen."""

    def __init__(self, seen: SemanticMap, number: int, plan: FloorPlan, openings: Sequence[KnownOpening] = ()) -> None:
        """The water of the hazard `number` of the map `seen`, where `plan` lets it pass, with known `openings`."""
        outer = [o for o in openings if o.outer and o.kind == "door"]
        set_at = [o.boarded for o in outer if o.boarded is not None and len(outer) >= OUTER_DOORS]
        self._set_at = float(max(set_at)) if set_at else np.inf
        level = seen.levels[number][plan.window].astype(np.float64)
        frame = seen.told_at[plan.window].astype(np.float64)
        known = np.isfinite(level) & (frame > 0.0)
        wet = known & (level >= WET)
        self.rise = float((level[wet] / frame[wet]).max()) if wet.any() else 0.0  # [m/frame]
        free = [o for o in outer if o.boarded is None]
        rose = frame if free else np.minimum(frame, self._set_at)
        drop = np.where(wet, np.maximum(self.rise * rose - level, 0.0), np.inf)
        if wet.any():  # where nothing comes any more it does not rise
            room, _ = ndimage.label(~plan.wall, np.ones((3, 3)))
            fed = np.unique(room[wet & (drop <= max(AT_SOURCE, float(drop.min())))])
            drop = np.where(np.isin(room, fed), drop, np.inf)
        self._plan, self._drop = plan, plan.spread(drop, SLOPE)
        dry = known & (level <= 0.0)
        self._drop = np.where(dry, np.maximum(self._drop, self.rise * rose), self._drop)
        self._rising = plan.spread(plan.beside(free), SLOPE) if set_at else self._drop  # drop from where none stands

    def at(self, points: ArrayLike, frames: ArrayLike) -> Array:
        """Levels [m], [K, M], at M `points` [m], [M, 2], at K `frames`, [K]; 0 where it is dry."""
        places, when = np.asarray(points, np.float64).reshape(-1, 2), np.asarray(frames, np.float64)[:, None]
        held = self.rise * np.minimum(when, self._set_at) - self._plan.at(self._drop, places)
        return np.maximum(np.maximum(held, self.rise * when - self._plan.at(self._rising, places)), 0.0)


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
