"""The targets of a scene that a robot can get at: where it fits on the true floor, and how far its arm is from there.

Generated scenes leave their robots room everywhere. Scenes of the original benchmark were made for a person, and some
of their targets no robot can get at. Agents never see this: it says how much of a scene could be rescued at all.
"""

from __future__ import annotations

import math

import numpy as np
from scipy import ndimage

from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.boxes import box_of
from hazard_ms.scenes.floor import FLOOR_CELL, Grid, boxes_of, cell_of, cells, free_for, halls, open_leaves, take
from hazard_ms.spec import Body, Build, SceneSpec, Vec2
from hazard_ms.spec.catalogue import value_of
from hazard_ms.spec.robot import GRASP_REACH

PUSHED_HEIGHT = 0.15  # things up to this height are pushed aside, as the robots' paths have it [m] [ours]


def reachable(spec: SceneSpec, build: Build) -> tuple[str, ...]:
    """Names of the targets that a robot can get close enough to, without clearing anything out of its way.

    It counts where the robot's circle fits between everything that is higher than PUSHED_HEIGHT at the start, in the
    part of the floor on which it starts. There the arm, stretched at the height of the target's middle, must bring the
    hand to within GRASP_REACH of its box. Whether furniture around a target leaves room for the arm does not count.
    """
    part = floor_of(spec, build.radius)
    return tuple(t.name for t in spec.targets if _away(spec, t, part) <= _span(t, build) + GRASP_REACH)


def share(spec: SceneSpec, names: tuple[str, ...]) -> float:
    """The part of the value of all targets of a scene, 0 to 1, that the targets called `names` have."""
    whole = sum(value_of(t) for t in spec.targets)
    return sum(value_of(t) for t in spec.targets if t.name in names) / whole


def floor_of(spec: SceneSpec, radius: float) -> Grid:
    """The cells to which a robot of `radius` [m] gets from its start, [X, Y]; none if it is stuck there.

    A robot that starts too near to something leaves for the nearest cell where it fits, at most `radius` away.
    """
    return part_of(standing_room(spec, radius), spec.agent_start.position, radius)


def standing_room(spec: SceneSpec, radius: float) -> Grid:
    """The cells where a robot of `radius` [m] fits between walls, open leaves and what it cannot push aside, [X, Y]."""
    fixtures, bodies = boxes_of(spec)
    free = free_for(spec.room, fixtures, [b for b in bodies if b.high > PUSHED_HEIGHT], radius)
    return take(free, spec.room.size, open_leaves(spec.room), radius)


def part_of(free: Grid, start: Vec2, most: float) -> Grid:
    """The connected part of `free`, [X, Y], that begins nearest to `start` [m], at most `most` [m] away: [X, Y]."""
    x, y = ((np.arange(n) + 0.5) * FLOOR_CELL for n in free.shape)
    far = np.where(free, np.hypot(x[:, None] - start[0], y[None, :] - start[1]), math.inf)
    nearest = np.unravel_index(int(far.argmin()), far.shape)
    if not far[nearest] <= most:
        return np.zeros_like(free)
    label, _ = ndimage.label(free)
    return np.asarray(label == label[nearest])


def _away(spec: SceneSpec, target: Body, part: Grid) -> float:
    """The distance of a target's box from the nearest cell of `part` on its side of all partitions [m]."""
    box = box_of(target, asset(target.asset).extent)
    x, y = cells(spec.room.size)
    i, j = np.clip(cell_of((box.x, box.y)), 0, np.array(part.shape) - 1)
    (hall,) = ((a, b) for a, b in halls(spec.room) if a.start <= i < a.stop and b.start <= j < b.stop)
    away = box.distance(x[hall[0]], y[:, hall[1]])
    return float(away.min(initial=math.inf, where=part[hall]))


def _span(target: Body, build: Build) -> float:
    """The largest horizontal distance of the base at which the hand gets to the height of the target's middle [m]."""
    box = box_of(target, asset(target.asset).extent)
    return build.span((box.low + box.high) / 2)[1]
