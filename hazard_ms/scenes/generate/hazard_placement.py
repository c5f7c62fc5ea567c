"""Chooses the agent's start, and places for fires: near targets and on the paths to them, not on them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.floor import Grid, cells, centre_of, path, steps_from
from hazard_ms.scenes.generate.arrangement import NoPlaceError
from hazard_ms.scenes.generate.draw import Draw
from hazard_ms.scenes.walls import WALLS
from hazard_ms.spec import AgentStart, Room, Vec2

START_RADIUS = 0.5  # free radius around the agent's start [m]
FLAME_RADIUS = 0.15  # half the diagonal of a floor fire of 0.2 m, which must be free [m]
MIN_TARGET_DISTANCE = 0.5  # from a fire to targets [m]
MIN_AGENT_DISTANCE = 1.0  # from a fire to the agent's start [m] [ours]
MIN_FIRE_SPACING = 0.8  # between fires [m] [ours]
MIN_DOORWAY_DISTANCE = 0.4  # from a fire to doorways [m] [ours]: there may be no other way
MAX_TARGET_DISTANCE = 1.1  # from the first fire to a target [m] [ours]
LEAKY_WALL_WEIGHT = 4.0  # how much likelier water comes through a wall with a door or a window [-] [ours]


def start(roomy: Grid, draw: Draw) -> AgentStart:
    """A start on one of the cells of the mask `roomy`, [X, Y], with any heading. Raises NoPlaceError if none is set."""
    places = np.argwhere(roomy)
    if len(places) == 0:
        raise NoPlaceError(f"the agent must start with {START_RADIUS} m free around it, got no such place")
    i, j = places[draw.whole(0, len(places) - 1)]
    return AgentStart(centre_of((int(i), int(j))), round(draw.uniform(-math.pi, math.pi), 4))


def fires(
    number: int, free: Grid, bare: Grid, agent: AgentStart, targets: list[Box], size: Vec2, draw: Draw
) -> tuple[Vec2, ...]:
    """Places of `number` fires [m], on cells of `bare`, [X, Y]: near targets, or, after the first, on paths to them.

    `bare`: floor on which nothing stands; `free`, [X, Y]: cells where the robot can be. Raises NoPlaceError if there is
    no place for any fire.
    """
    x, y = cells(size)
    apart = np.min([t.distance(x, y) for t in targets], axis=0)
    allowed = (
        bare
        & (apart >= MIN_TARGET_DISTANCE)
        & (np.hypot(x - agent.position[0], y - agent.position[1]) >= MIN_AGENT_DISTANCE)
    )
    found: list[Vec2] = []
    for k in range(number):
        near = (apart <= MAX_TARGET_DISTANCE) if k == 0 or draw.whole(0, 1) else _paths(free, agent, targets, size)
        choices = np.argwhere(allowed & near)
        if len(choices) == 0:
            choices = np.argwhere(allowed & (apart <= MAX_TARGET_DISTANCE))
        if len(choices) == 0:
            break
        i, j = choices[draw.whole(0, len(choices) - 1)]
        found.append(centre_of((int(i), int(j))))
        allowed &= np.hypot(x - found[-1][0], y - found[-1][1]) >= MIN_FIRE_SPACING
    if not found:
        raise NoPlaceError("a fire must be near a target, got no such place")
    return tuple(found)


def _paths(free: Grid, agent: AgentStart, targets: list[Box], size: Vec2) -> Grid:
    """The cells of shortest paths from the agent to all targets, and their neighbours, [X, Y]."""
    x, y = cells(size)
    here = np.unravel_index(
        np.argmin(np.where(free, np.hypot(x - agent.position[0], y - agent.position[1]), np.inf)), free.shape
    )
    steps = steps_from(free, (int(here[0]), int(here[1])))
    paths = np.zeros_like(free)
    for t in targets:
        i, j = np.unravel_index(np.argmin(np.where(steps >= 0, np.hypot(x - t.x, y - t.y), np.inf)), free.shape)
        for a, b in path(steps, (int(i), int(j))):
            paths[max(a - 1, 0) : a + 2, max(b - 1, 0) : b + 2] = True
    return paths


def flood_side(room: Room, draw: Draw, dry: Sequence[str] = ()) -> str:
    """The wall from which water comes, none of the `dry` ones; one with a door or a window is more likely."""
    leaky, walls = {o.wall for o in room.openings}, [wall for wall in WALLS if wall not in dry]
    return draw.weighted(walls, [LEAKY_WALL_WEIGHT if wall in leaky else 1.0 for wall in walls])
