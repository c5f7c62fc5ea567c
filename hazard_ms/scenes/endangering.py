"""Where the agent starts, and where it burns: near targets and on the ways to them, not on them."""

from __future__ import annotations

import math

import numpy as np

from hazard_ms.scenes.arrangement import NoPlaceError
from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.draw import Draw
from hazard_ms.scenes.floor import Grid, cells, centre_of, path, steps_from
from hazard_ms.scenes.shell import WALLS
from hazard_ms.spec import AgentStart, Room, Vec2

START = 0.5  # radius that is free around the agent's start [m]
FLAME = 0.15  # half the diagonal of a floor fire of 0.2 m: its floor must be free [m]
APART = 0.5  # from targets, at least [m]
FROM_AGENT = 1.0  # from the agent's start, at least [m] [ours]
BETWEEN = 0.8  # from each other, at least [m] [ours]
FROM_DOORWAYS = 0.4  # from the thresholds of doorways, at least: the only way to what is beyond [m] [ours]
NEAR = 1.1  # from a target or a way to one, at most [m] [ours]
LEAKY = 4.0  # how much sooner water comes through a wall with a door or a window [-] [ours]


def start(roomy: Grid, draw: Draw) -> AgentStart:
    """A start on one of the cells `roomy`, anywhere, looking anywhere."""
    places = np.argwhere(roomy)
    if len(places) == 0:
        raise NoPlaceError(f"no place with a free radius of {START} m for the agent")
    i, j = places[draw.whole(0, len(places) - 1)]
    return AgentStart(centre_of((int(i), int(j))), round(draw.uniform(-math.pi, math.pi), 4))


def fires(number: int, free: Grid, bare: Grid, agent: AgentStart, targets: list[Box], size: Vec2, draw: Draw) -> tuple[Vec2, ...]:
    """`number` fires on cells of `bare` (floor on which nothing stands), the first near a target, others there or on a way to one.

    `free`: where the robot can be.
    """
    x, y = cells(size)
    apart = np.min([t.distance(x, y) for t in targets], axis=0)
    allowed = bare & (apart >= APART) & (np.hypot(x - agent.position[0], y - agent.position[1]) >= FROM_AGENT)
    ways = _ways(free, agent, targets, size)
    found: list[Vec2] = []
    for k in range(number):
        near = (apart <= NEAR) if k == 0 or draw.whole(0, 1) else ways
        choices = np.argwhere(allowed & near)
        if len(choices) == 0:
            choices = np.argwhere(allowed & (apart <= NEAR))
        if len(choices) == 0:
            break
        i, j = choices[draw.whole(0, len(choices) - 1)]
        found.append(centre_of((int(i), int(j))))
        allowed &= np.hypot(x - found[-1][0], y - found[-1][1]) >= BETWEEN
    if not found:
        raise NoPlaceError("no place for a fire near a target")
    return tuple(found)


def _ways(free: Grid, agent: AgentStart, targets: list[Box], size: Vec2) -> Grid:
    """Cells of shortest ways from the agent to all targets, and their neighbours."""
    x, y = cells(size)
    here = np.unravel_index(np.argmin(np.where(free, np.hypot(x - agent.position[0], y - agent.position[1]), np.inf)), free.shape)
    steps = steps_from(free, (int(here[0]), int(here[1])))
    ways = np.zeros_like(free)
    for t in targets:
        i, j = np.unravel_index(np.argmin(np.where(steps >= 0, np.hypot(x - t.x, y - t.y), np.inf)), free.shape)
        for a, b in path(steps, (int(i), int(j))):
            ways[max(a - 1, 0) : a + 2, max(b - 1, 0) : b + 2] = True
    return ways


def flood_side(room: Room, draw: Draw) -> str:
    """The wall from which water comes, sooner one with a door or a window."""
    leaky = {o.wall for o in room.openings}
    return draw.weighted(WALLS, [LEAKY if wall in leaky else 1.0 for wall in WALLS])
