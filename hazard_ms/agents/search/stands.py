"""The ends of walks to things, past the walls of several rooms, and the floor that is in sight from there.

In a single room things are about as far as they look, and little hides the floor. In a home a thing behind a wall may
be the whole way round, and a look shows no more than the room and what is seen through its doors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.motor.navigation import Ways
from hazard_ms.skills.motor.walking import ARRIVED
from hazard_ms.spec.robot import GRASP_REACH

Place = tuple[float, float]
HIDES = 1.2  # height from which what stands in between hides the floor [m] [ours]: the eyes of Fetch are 1.1 m high
ARM = 1.2  # distance up to which an arm reaches from where a walk ends [m] [ours]: Fetch's is 1.1 m long


@dataclass(frozen=True)
class Stand:
    """The end of a walk to a thing."""

    name: str  # of the thing
    place: Place  # of the robot [m], world frame
    length: float  # of the way there [m]


def stands(decision: Decision, names: Sequence[str], radius: float) -> dict[str, Stand]:
    """The ends of walks to things on the map or into openings, by name, for a robot of `radius` [m]: where a way leads.

    Floor that was never seen counts as free, but costs more. Raises ValueError for a name that nothing has.
    """
    seen, here = decision.map, decision.agent_position
    openings = {opening.name: opening.position for opening in decision.openings}
    things = [None if name in openings else seen.objects[decision.index(name)] for name in names]
    edges = [0.0 if thing is None else thing.radius for thing in things]
    places = [openings[name] if thing is None else thing.position for name, thing in zip(names, things, strict=True)]
    goals = [(float(place[0]), float(place[1])) for place in places]
    if not goals:
        return {}
    ways = Ways(seen.obstacles, seen.explored, seen.cell, seen.origin, here, [*goals, here], radius)
    made = {}
    for name, goal, edge in zip(names, goals, edges, strict=True):
        path = ways.path(goal, ARRIVED + edge, ARM + GRASP_REACH + edge)
        if path is not None and path.short <= ARM + GRASP_REACH + edge:
            end = path.points[-1] if len(path.points) else here
            made[name] = Stand(name, (float(end[0]), float(end[1])), path.length)
    return made


def in_sight(seen: SemanticMap, place: Place, points: NDArray[np.float64], far: float) -> NDArray[np.bool_]:
    """A mask, [P], of the `points` [m], [P, 2], within `far` [m] of `place` [m] that nothing in between hides."""
    away = np.asarray(points, np.float64) - place
    near = np.hypot(*away.T) < far
    steps = np.arange(1, round(far / seen.cell)) * seen.cell / far
    line = place + steps[:, None, None] * away[near]  # [S, N, 2]
    cells = np.floor((line - seen.origin) / seen.cell).astype(np.int64).clip(0, len(seen.explored) - 1)
    hidden = (seen.height[cells[..., 1], cells[..., 0]] > HIDES).any(axis=0)
    made = np.zeros(len(points), bool)
    made[near] = ~hidden
    return made
