"""Experiments with water that passes doors, whose results are compared in hazard_ms.validation.flume_cases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import torch

from hazard_ms.hazards.flood.realistic import buoyant, footing
from hazard_ms.hazards.flood.realistic.floor_plan import CELL
from hazard_ms.spec import Build, Fixture, Opening, Partition
from hazard_ms.validation.experiments.basin import SMOOTH, Basin

WIDE = 0.9  # width of the doors [m]
PERSON = Build(  # legs displace 0.2 m square, feet are 0.25 m long; what does not matter in water is 1
    mass=70.0,
    width=0.2,
    stance=0.25,
    friction=0.6,
    drag_area=0.7,
    forward_step=1.0,
    turn_step=1.0,
    arm_step=1.0,
    radius=1.0,
    shoulder=(0.0, 1.0),
    reach=1.0,
    elbow_room=1.0,
    nearest=1.0,
)
G1 = replace(PERSON, mass=35.0, width=0.13, stance=0.19)  # as their makers give them, and as hazard_ms.robots has it
FETCH = replace(PERSON, mass=115.0, width=0.51, stance=0.51)


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


def under_door(deep: float = 0.5) -> float:
    """Discharge [m^3/s] under a closed door from a room `deep` [m] in water into a dry one, over five seconds."""
    wall, shut = Partition("middle", "y", 7.0), Opening("door", "middle", 6.0, WIDE, 2.0)
    full = np.where(np.arange(140) < 70, deep, 0.0)[:, None] * np.ones((1, 120))
    basin = Basin((14.0, 12.0), depth=full, openings=(shut,), partitions=(wall,))
    basin.state.inlet[:] = -1
    basin.run(5.0)
    return float(basin.get("depth")[70:].sum()) * CELL**2 / basin.now


def breaking_depth() -> float:
    """Depth [m] of the water on one side at which a closed door between rooms breaks, within 1 mm."""
    wall, shut = Partition("middle", "y", 3.0), Opening("door", "middle", 2.0, WIDE, 2.0)
    low, high = 0.1, 2.0
    while high - low > 1e-3:
        middle = 0.5 * (low + high)
        full = np.where(np.arange(60) < 30, middle, 0.0)[:, None] * np.ones((1, 40))
        basin = Basin((6.0, 4.0), depth=full, openings=(shut,), partitions=(wall,))
        basin.state.inlet[:] = -1
        basin.run(1e-4, 1e-4)
        openings = basin.world.openings
        openings.bear([basin.law.strain(basin.state, basin.world)], torch.ones(1, dtype=torch.bool), 0.1)
        low, high = (low, middle) if bool(openings.state.broken[0, 0]) else (middle, high)
    return middle


def dammed(share: float, outside: float = 1.0) -> float:
    """Discharge [m^3/s] through an open door of which furniture covers a `share`, into a large dry room."""
    basin = Basin(
        (14.0, 12.0), law=replace(SMOOTH, outside=outside), openings=(Opening("door", "south", 7.0, WIDE, 2.0),)
    )
    basin.state.dammed[:] = share
    basin.run(1.0)
    before, begun = basin.volume, basin.now
    basin.run(1.0)
    return (basin.volume - before) / (basin.now - begun)


def topples_at(depth: float, build: Build = G1) -> float:
    """Least speed [m/s] of water `depth` [m] deep that throws a robot over, to 1 mm/s; infinite if none does."""
    speeds = torch.arange(0.0, 6.0, 0.001)
    fell = footing.topples(torch.tensor([depth]), speeds, build, 1000.0, 9.81)
    return float(speeds[fell][0]) if bool(fell.any()) else float("inf")


def keels_over(build: Build) -> float:
    """Least depth [m] of still water in which a robot falls over, to 1 mm."""
    depths = torch.arange(0.0, 3.0, 0.001)
    fell = footing.topples(depths, torch.zeros(1), build, 1000.0, 9.81)
    return float(depths[fell][0])


def floats_at(name: str) -> float:
    """Depth of the water [m] in which the furniture called `name` leaves the floor."""
    return buoyant.floating(Fixture(name, name.rsplit("_", 1)[0], name, (0.0, 0.0, 0.0))).depth
