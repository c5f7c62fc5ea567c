"""A watch on a fire: the flames behind the temperatures on the map, and when things will catch fire from them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sketch.planning.creeping_fire import FLAME, ROOM, STEP, Flames, Things, burning_from, found
from hazard_ms.skills.decision import Decision
from hazard_ms.spec.catalogue import CATEGORIES

FUTURES = 12  # that are drawn at a time [ours]
WARM = 80.0  # floor of this temperature tells where flames are [C] [ours]
MOST_POINTS = 300  # of the floor from which flames are found [ours]
FURNITURE = 0.15  # height of what stands in the way of flames [m] [ours]
WARMED = 0.6  # share of the excess over the room around a thing that it has taken on, while it heats up [ours]


class FireWatch:
    """Forecasts a fire anew whenever its temperatures on the map have changed."""

    def __init__(self, seed: int) -> None:
        """Begin an episode; `seed` fixes the futures that are drawn."""
        self._chance = np.random.default_rng([seed, 0x46495245])  # "FIRE": not the stream of a search
        self._seen: tuple[int, float] = (0, 0.0)
        self._caught: dict[int, float] = {}

    def whole_until(self, decision: Decision, number: int) -> dict[int, float]:
        """The frame until which each known thing stays whole in half of the futures, by index; inf for all along.

        It is empty while no flames show in the levels of the hazard `number` on the map.
        """
        levels = decision.map.levels[number]
        warm = np.isfinite(levels) & (levels >= WARM)
        seen = int(warm.sum()), float(levels[warm].sum())
        if seen != self._seen:
            self._seen = seen
            self._caught = self._forecast(decision, levels, warm)
        return self._caught

    def _forecast(self, decision: Decision, levels: NDArray, warm: NDArray[np.bool_]) -> dict[int, float]:
        indices, things = things_of(decision)
        flames = _flames(decision.map, levels, warm, things)
        if flames is None or not indices:
            return {}
        caught = burning_from(flames, things, decision.frame, decision.max_frames, FUTURES, self._chance)
        return dict(zip(indices, np.median(caught - STEP, axis=0).tolist(), strict=True))


def things_of(decision: Decision) -> tuple[list[int], Things]:
    """The things on the map, by index, as the fire sees them."""
    base, temperature, threshold = [], [], []
    indices = list(decision.map.objects)
    for index in indices:
        sighting = decision.map.objects[index]
        x, y, z = sighting.position.tolist()
        base.append((x, y, max(2 * z - sighting.top, 0.0)))  # as far below its middle as its top is above
        kind = CATEGORIES.get(decision.names[index].replace("#", "_").rpartition("_")[0])  # mug_3, or a track, mug#3
        threshold.append(kind.ignition_temperature if kind is not None and kind.flammable else np.inf)
        warmth = sighting.hazard if np.isfinite(sighting.hazard) else ROOM
        believed = FLAME if sighting.damaged else min(ROOM + WARMED * (warmth - ROOM), threshold[-1] - 1.0)
        temperature.append(believed)
    return indices, Things(np.array(base).reshape(-1, 3), np.array(temperature), np.array(threshold))


def _flames(seen: SemanticMap, levels: NDArray, warm: NDArray[np.bool_], things: Things) -> Flames | None:
    """The flames behind the warm floor of a map."""
    floor = warm_floor(seen, levels, warm)
    return None if floor is None else found(floor.points, floor.levels, things, floor.blocked)


class WarmFloor(NamedTuple):
    """The places by which fires are found on a map, the hottest first."""

    points: NDArray  # [m], [P, 3]
    levels: NDArray  # temperatures there [C], [P]
    cells: tuple[NDArray, NDArray]  # y and x of these places on the map, [P] each
    blocked: NDArray  # places where furniture stands [m], [Q, 2]


def warm_floor(seen: SemanticMap, levels: NDArray, warm: NDArray[np.bool_]) -> WarmFloor | None:
    """The floor of a map where it is `warm`, [Y, X], at most MOST_POINTS places of it, by `levels` [C], [Y, X]."""
    height = seen.height
    y, x = np.nonzero(warm & (height < FURNITURE))
    if not len(y):
        return None
    hottest = np.argsort(-levels[y, x], kind="stable")
    some = hottest[:: max(1, -(-len(hottest) // MOST_POINTS))]
    y, x = y[some], x[some]
    points = np.column_stack([seen.centre_of(y, x), height[y, x]])
    blocked = seen.centre_of(*np.nonzero(height >= FURNITURE))
    return WarmFloor(points, levels[y, x].astype(np.float64), (y, x), blocked)
