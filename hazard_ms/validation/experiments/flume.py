"""Experiments with water that passes doors, whose results are compared in hazard_ms.validation.flume_cases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hazard_ms.hazards.flood.realistic.floor_plan import CELL
from hazard_ms.spec import Opening, Partition
from hazard_ms.validation.experiments.basin import SMOOTH, Basin

WIDE = 0.9  # width of the doors [m]


def steady(outside: float) -> float:
    """Discharge [m^3/s] through an open door into a large dry room, from 2 to 5 s after the water came."""
    return _through_door((14.0, 12.0), outside, 0.0, 2.0, 3.0)


def submerged(part: float, outside: float = 1.0) -> float:
    """Discharge into a hall whose water stands `part` as high as that `outside` [m], over that of a free weir."""
    free = 0.4 * WIDE * (2.0 * 9.81) ** 0.5 * outside**1.5
    return _through_door((30.0, 24.0), outside, part * outside, 1.0, 2.0) / free


def _through_door(size: tuple[float, float], outside: float, depth: float, start: float, seconds: float) -> float:
    door = Opening("door", "south", size[0] / 2, WIDE, 2.0)
    basin = Basin(size, depth=depth, law=replace(SMOOTH, outside=outside), openings=(door,))
    basin.run(start)
    before, begun = basin.volume, basin.now
    basin.run(seconds)
    return (basin.volume - before) / (basin.now - begun)


def doorway(deep: float = 0.5) -> float:
    """Discharge [m^3/s] through a doorway from a room kept `deep` [m] into a dry one, from 2 to 4 s after it opens."""
    wall, opening = Partition("middle", "y", 7.0), Opening("doorway", "middle", 6.0, WIDE, 2.0)
    full = np.where(np.arange(140) < 70, deep, 0.0)[:, None] * np.ones((1, 120))
    basin = Basin((14.0, 12.0), depth=full, openings=(opening,), partitions=(wall,))
    basin.state.inlet[:] = -1
    behind = []
    for _ in range(120):
        basin.run(1 / 30)
        depth = basin.get("depth")
        behind.append((float(depth[70:].sum()) * CELL**2, basin.now))
        depth[:60] = deep
        basin.put("depth", depth)
    return (behind[-1][0] - behind[60][0]) / (behind[-1][1] - behind[60][1])
