"""Places of the first fires of homes: each in another room, near to much value that burns, but not at it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.floor import Grid, cells, centre_of
from hazard_ms.scenes.generate.arrangement import NoPlaceError
from hazard_ms.scenes.generate.draw import Draw
from hazard_ms.scenes.generate.hazard_placement import MIN_AGENT_DISTANCE
from hazard_ms.scenes.generate.house.plan import House
from hazard_ms.spec import AgentStart, Area, Vec2

BEST_SHARE = 0.1  # of the places in a room: those with the most value around them are drawn from [ours]


def outbreaks(
    layout: House,
    bare: Grid,
    rooms: Sequence[Area],
    agent: AgentStart,
    targets: Sequence[tuple[Box, float]],
    size: Vec2,
    draw: Draw,
) -> tuple[Vec2, ...]:
    """Places of the fires of a home [m], on cells of `bare`, [X, Y], in different `rooms`.

    `targets`: the boxes of all, each with its value if it burns, else 0. Rooms are drawn by the value in them that
    burns. Raises NoPlaceError if fewer rooms than there are to be fires have such value and a place for one.
    """
    x, y = cells(size)
    apart = np.array([box.distance(x, y) for box, _ in targets])
    allowed = bare & (apart.min(axis=0) >= layout.fire_distance)
    allowed &= np.hypot(x - agent.position[0], y - agent.position[1]) >= MIN_AGENT_DISTANCE
    left = [(allowed & within(area, size), _value(area, targets)) for area in rooms]
    left = [(places, value) for places, value in left if value > 0.0 and places.any()]
    number, found = draw.one(layout.fires), []
    if len(left) < number:
        raise NoPlaceError(f"{number} rooms must have something that burns and a place for a fire, got {len(left)}")
    for _ in range(number):
        places, _ = left.pop(draw.weighted(range(len(left)), [value for _, value in left]))
        near = sum(value * (far[places] <= layout.fire_reach) for far, (_, value) in zip(apart, targets, strict=True))
        best = np.argsort(-np.asarray(near), kind="stable")[: max(1, int(BEST_SHARE * places.sum()))]
        i, j = np.argwhere(places)[best[draw.whole(0, len(best) - 1)]]
        found.append(centre_of((int(i), int(j))))
    return tuple(found)


def within(area: Area, size: Vec2) -> Grid:
    """The cells of a floor of `size` [m] in an `area`, [X, Y]."""
    x, y = cells(size)
    return (x >= area.min[0]) & (x <= area.max[0]) & (y >= area.min[1]) & (y <= area.max[1])


def _value(area: Area, targets: Sequence[tuple[Box, float]]) -> float:
    """The sum of what the `targets` whose middles are in an `area` are worth."""
    (x0, y0), (x1, y1) = area.min, area.max
    return sum(value for box, value in targets if x0 <= box.x <= x1 and y0 <= box.y <= y1)
