"""Places from which to search for targets that were not seen yet, and how many may be found there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from hazard_ms.agents.search.memory import Place
from hazard_ms.agents.search.stands import in_sight, stands
from hazard_ms.sensing.detection.eyes import FAR
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.options.landmarks import MOST_VISITS, WALKABLE

Mask = NDArray[np.bool_]
MOST = 5  # places to search that are weighed at a time [ours]
DEPTH = 2.0  # how far unseen floor is believed to reach beyond the border of the floor that was seen [m] [ours]
HIDDEN = 0.3  # share of the targets that a look at all this floor would miss, and that no look shows at all [ours]
AGAIN = 0.3  # what a look shows from beside where one was, as a share of what it would have shown first [ours]
FROM_AFAR = 0.7  # the same share of a look from where a detector tells little [ours]
BARRED = 0.5  # share of the targets out of sight from a look nearby that were not there either [ours]
LITTLE = 0.05  # least share of it that a place must show to be worth a search [ours]
EVERY = 2  # cells of the map, along each side, for which one is looked at where walls count [ours]
ANEW = 1.5  # distance between places from which things are seen from different sides [m] [ours]


@dataclass(frozen=True)
class Lookout:
    """A thing from which to look around, and the share of the unseen targets that is expected to be found there."""

    name: str
    place: Place
    share: float


def lookouts(
    decision: Decision,
    visits: Mapping[str, int],
    looks: Sequence[Place],
    avoided: Sequence[str],
    radius: float | None = None,
    sight: float = FAR,
) -> tuple[Lookout, ...]:
    """The best places to search: those where most may be found for their distance, each counting what others leave.

    `visits`: how often each thing was walked to in search; `looks`: where the agent has looked around [m]; things in
    `avoided` are left out. Where no place promises anything, they are the nearest things that were not visited.
    `radius` of the robot [m] where walls divide the place: they hide what is behind them, and ways lead round them.
    `sight`: distance up to which a look tells most of what is there [m].
    """
    things = _things(decision, [*avoided, *(name for name, count in visits.items() if count >= MOST_VISITS)])
    if radius is None:
        floor, weight = _searchable(decision.map, looks, sight)
    else:
        floor, weight = _searchable(decision.map, looks, sight, EVERY)
        ends = stands(decision, [name for name, _ in things], radius)
        things = [thing for thing in things if thing[0] in ends]
    if not len(floor) or not things:
        return _unvisited(things, visits)
    names, places = [name for name, _ in things], np.array([place for _, place in things])
    away = np.hypot(*(places - decision.agent_position).T)
    if radius is None:
        seen = np.hypot(*np.moveaxis(places[:, None] - floor, -1, 0)) < sight
    else:
        seen = np.array([in_sight(decision.map, ends[name].place, floor, sight) for name in names])
        away = np.array([ends[name].length for name in names])
    hidden = HIDDEN / (1 - HIDDEN) * len(floor)  # before any look the weight of all floor is 1
    shows = seen * (weight / (weight.sum() + hidden))
    again = np.array([sum(np.hypot(*(place - look)) < ANEW for look in looks) for place in places])
    shows *= (AGAIN**again)[:, None]
    ease = 1.0 / (1.0 + away)
    chosen: list[Lookout] = []
    for _ in range(MOST):
        share = shows.sum(axis=1)
        best = int(np.argmax(share * ease))
        if share[best] < LITTLE:
            break
        place = float(places[best, 0]), float(places[best, 1])
        chosen.append(Lookout(names[best], place, float(share[best])))
        shows[:, shows[best] > 0] = 0.0
    return tuple(chosen) or _unvisited(things, visits)


def _searchable(
    seen: SemanticMap, looks: Sequence[Place], sight: float, every: int = 0
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The middles of floor [m], [P, 2], and how likely a target that was not seen is there, relative to each other [P].

    Floor that was seen counts HIDDEN of that which was not. Each further look from within `sight` [m] multiplies it by
    that. Floor that a detector has only seen from farther off counts FROM_AFAR. With `every`, only one in so many cells
    along each side, and only looks past which no wall stands. What no look shows keeps its weight, so each look in vain
    leaves less hope for the next.
    """
    unseen = unseen_floor(seen)
    cells = unseen | (seen.explored & (seen.height < WALKABLE))
    if every:
        cells &= (np.indices(cells.shape) % every == 0).all(axis=0)
    points, new = seen.centre_of(*np.nonzero(cells)), unseen[cells]
    near = np.zeros(len(points), int)
    for place in looks:
        near += in_sight(seen, place, points, sight) if every else np.hypot(*(points - place).T) < sight
    passing = HIDDEN if sight >= FAR else FROM_AFAR  # by what is seen without a look around
    return points, np.where(new, BARRED**near, np.where(near > 0, HIDDEN**near, passing))


def unseen_floor(seen: SemanticMap) -> Mask:
    """The cells, [Y, X], that were not seen and are within DEPTH of floor that was, with no other seen cell between."""
    floor = seen.explored & (seen.height < WALKABLE)
    steps = round(DEPTH / seen.cell)
    return ndimage.binary_dilation(floor, iterations=steps, mask=~seen.explored | floor) & ~seen.explored


def _things(decision: Decision, avoided: Sequence[str]) -> list[tuple[str, NDArray[np.float64]]]:
    """The things on the map and their places [m], the nearest first."""
    here = np.asarray(decision.agent_position)
    things = [
        (decision.names[index], sighting.position[:2].astype(np.float64))
        for index, sighting in decision.map.objects.items()
        if decision.names[index] not in (*avoided, decision.held)
    ]
    return sorted(things, key=lambda thing: float(np.hypot(*(thing[1] - here))))


def _unvisited(things: Sequence[tuple[str, NDArray[np.float64]]], visits: Mapping[str, int]) -> tuple[Lookout, ...]:
    """The first of `things` that it has not walked to in search, apart from each other."""
    chosen: list[Lookout] = []
    for name, place in things:
        apart = all(np.hypot(*(place - mark.place)) >= ANEW for mark in chosen)
        if len(chosen) < MOST and apart and not visits.get(name):
            chosen.append(Lookout(name, (float(place[0]), float(place[1])), HIDDEN / MOST))
    return tuple(chosen)
