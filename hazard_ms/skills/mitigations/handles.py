"""Chooses the place from which a robot takes the handle of a door: in reach, and out of the leaf's way if it can."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from hazard_ms.simulation.mitigation import hinges
from hazard_ms.skills.context import Stage
from hazard_ms.skills.mitigations.leaf import Leaf
from hazard_ms.skills.mitigations.views import in_view
from hazard_ms.skills.motor.navigation import Ways

Place = tuple[float, float]  # [m], world frame
SHARES = (0.92, 0.87, 0.82)  # of the arm's span: distances from the handle [ours]: nearer, the elbow meets the leaf
SIDES = 24  # directions from the handle in which places are tried [ours]
ASIDE = 0.05  # gap that the base leaves to a leaf that turns [m] [ours]
STEPPING = (
    1.2  # metres of way that take as long as folding the arm and stepping out of the leaf's way [ours: 80 frames]
)
BEFORE = 0.1  # distance from the wall of what must be in view of a shut door: its handle [m] [ours]
BESIDE = 0.7  # distance from a door of the places on both sides to which ways are compared [m] [ours]
CLOSE, ENOUGH = 0.05, 0.1  # distance from a place at which one stands on it, and with an obstacle on it [m] [ours]


def stand(stage: Stage, leaf: Leaf, goal: float, home: float, without: Collection[Place] = ()) -> Place | None:
    """The place with the least way to it from which the handle of `leaf` is in reach; None for none.

    To step aside before the leaf turns to the angle `goal` [rad] counts as a way. A place lies on the side `home` (as
    Leaf.side has it), so that a robot does not shut itself in; or beyond the door, in the way of its leaf, where it
    gets through. Places within ENOUGH of those in `without` do not count.
    """
    handle, seen, build = leaf.handle(), stage.seen, stage.robot.build
    nearest, farthest = build.span(float(handle[2]))
    angles = np.arange(SIDES) * 2.0 * np.pi / SIDES
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    places = np.concatenate([handle[:2] + max(nearest, share * farthest) * ring for share in SHARES])
    x, y, _ = stage.robot.base()
    away = float(np.hypot(*(handle[:2] - (x, y))))
    if SHARES[-1] * farthest <= away <= SHARES[0] * farthest:
        places = np.concatenate([[[x, y]], places])
    column, row = np.floor((places - seen.origin) / seen.cell).astype(np.int64).T
    inside = (np.minimum(row, column) >= 0) & (np.maximum(row, column) < len(seen.explored))
    places = places[inside][seen.explored[row[inside], column[inside]]]
    passes = leaf.o.width * hinges.share(leaf.angle) > 2.0 * build.radius
    aim = handle if passes else handle + np.sign(home) * BEFORE * np.array([*leaf.out, 0.0])
    places = places[in_view(stage, np.pad(places, ((0, 0), (0, 1)), constant_values=handle[2]), aim)]
    gap = np.full(len(places), build.radius + ASIDE)
    meets = leaf.in_the_way(leaf.angle, goal, places, gap)
    sides = np.array([leaf.side(*place) for place in places]) * home
    fresh = np.array([all(np.hypot(*(p - w)) > ENOUGH for w in without) for p in places], dtype=bool)
    kept = (meets & passes | (sides > 0.0)) & fresh
    places, cost = places[kept], STEPPING * meets[kept]
    if not len(places):
        return None
    goals = [(float(px), float(py)) for px, py in places]
    # two goals at least: one search for all
    ways = Ways(stage.obstacles(), seen.explored, seen.cell, seen.origin, (x, y), [*goals, goals[0]], build.radius)
    lengths = cost + [_length(ways, goal_at, (x, y)) for goal_at in goals]
    best = int(np.argmin(lengths))
    return goals[best] if np.isfinite(lengths[best]) else None


def home_side(stage: Stage, leaf: Leaf) -> float:
    """The side of the `leaf` from which the robot comes, as the sign of Leaf.side.

    It is the side to which its way is shorter, whichever of them the robot lies on if the wall went on for ever: who
    comes from another room on the same side of a hall has to go through the door to get to that side of it.
    """
    seen, (x, y, _) = stage.seen, stage.robot.base()
    start, along, out = hinges.hinge(leaf.room, leaf.o)
    middle = start + along * leaf.o.width / 2
    goals = [(float(px), float(py)) for px, py in (middle + BESIDE * out, middle - BESIDE * out)]
    ways = Ways(stage.obstacles(), seen.explored, seen.cell, seen.origin, (x, y), goals, stage.robot.build.radius)
    paths = [ways.path(goal, CLOSE, BESIDE / 2) for goal in goals]
    one, other = (p.length + p.short if p is not None and p.short <= BESIDE / 2 else np.inf for p in paths)
    return float(np.sign(other - one)) if one != other else leaf.side(x, y)


def _length(ways: Ways, place: Place, here: Place) -> float:
    if np.hypot(place[0] - here[0], place[1] - here[1]) < CLOSE:
        return 0.0
    path = ways.path(place, CLOSE, ENOUGH)
    return path.length if path is not None and path.short <= ENOUGH else float("inf")
