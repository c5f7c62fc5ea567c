"""Places from which to search for targets that were not seen yet, and how many may be found there."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from hazard_ms.agents.search.memory import Place
from hazard_ms.agents.search.stands import HIDES, in_sight, stands
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
# in homes: targets that are unseen on floor that was seen in passing, and on floor that was looked at, for each on as
# much floor that was not [measured: 0.07 and 0 in seven homes of `train`, every 400 frames of `greedy`; the last ours]
PASSED, LOOKED = 0.07, 0.02
LITTLE = 0.05  # least share of it that a place must show to be worth a search [ours]
EVERY = 2  # cells of the map, along each side, for which one is looked at where walls count [ours]
ANEW = 1.5  # distance between places from which things are seen from different sides [m] [ours]
HERE = ""  # name of where the agent stands, from which a look takes no walk
WIDE = 0.7  # share of a door that is open from which a robot gets through [ours]
HOME = 87.0  # floor of a home [m2] [measured: mean of 12 homes of `train`]
ROOM = 3.7  # length and width of what may burn behind a passage [m] [measured: rooms of `train` have 8 to 17 m2]
COLD = 1.2  # distance from a young fire within which floor is warm [m] [docs/physics.md 1.1: 80 C at 1.5 m]
WARMTH = 6.0  # distance up to which warm floor is seen [m] [ours]: longer than most rooms
SAME_ROOM = 3.0  # distance in sight up to which it is surely the same room: walls may not be on the map yet [m] [ours]
SECOND = 0.1  # of the chance of a fire in sight of another, which is in another room, or of a look in vain [ours]
LEAST_NEW = 0.01  # share of the unseen floor of a home that a place must show to be worth a look [ours]


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
    doors: bool = False,
    barred: Collection[Place] = (),
) -> tuple[Lookout, ...]:
    """The best places to search: those where most may be found for their distance, each counting what others leave.

    `visits`: how often each thing was walked to in search; `looks`: where the agent has looked around [m]; things in
    `avoided` are left out. Where no place promises anything, they are the nearest things that were not visited.
    `radius` of the robot [m] where walls divide the place: they hide what is behind them, and ways lead round them.
    `sight`: distance up to which a look tells most of what is there [m]; `doors`: whether openings of a home count.
    Where no way led to `barred` [m], and no place promises anything, they are the nearest things to there.
    """
    avoided = [*avoided, *(name for name, count in visits.items() if count >= MOST_VISITS)]
    things = _things(decision, avoided)
    if radius is None:
        floor, weight = _searchable(decision.map, looks, sight)
    else:
        floor, weight = _searchable(decision.map, looks, sight, EVERY)
        things += _passages(decision, avoided).items() if doors else ()
        ends = stands(decision, [name for name, _ in things], radius)
        things = [thing for thing in things if thing[0] in ends]
    none_left = 0.0 if doors and radius is not None else HIDDEN / MOST  # who can open doors does so first
    others = sorted(things, key=lambda thing: min((float(np.hypot(*(thing[1] - at))) for at in barred), default=0.0))
    if not len(floor) or not things:
        return _unvisited(others, visits, none_left)
    names, places = [name for name, _ in things], np.array([place for _, place in things])
    away = np.hypot(*(places - decision.agent_position).T)
    if radius is None:
        seen = np.hypot(*np.moveaxis(places[:, None] - floor, -1, 0)) < sight
    else:
        inside = {o.name for o in decision.openings}  # where walks end, not before them
        eyes = [at if name in inside else ends[name].place for name, at in things]
        seen = np.array([in_sight(decision.map, (float(x), float(y)), floor, sight) for x, y in eyes])
        away = np.array([ends[name].length for name in names])
    hidden = HIDDEN / (1 - HIDDEN) * len(floor)  # before any look the weight of all floor is 1
    if radius is not None:  # the rest of the home
        area = decision.map.cell**2
        unseen = (HOME - float(decision.map.explored.sum()) * area) / (area * EVERY**2)
        hidden = max(unseen - float(weight[weight > PASSED].sum()), 0.0)
    shows = seen * (weight / (weight.sum() + hidden))
    again = np.array([sum(np.hypot(*(place - look)) < ANEW for look in looks) for place in places])
    shows *= (AGAIN**again)[:, None]
    ease = 1.0 / (1.0 + away)
    least = LITTLE if radius is None else LEAST_NEW
    return _best(names, list(places), shows, ease, least) or _unvisited(others, visits, none_left)


def fire_lookouts(
    decision: Decision,
    visits: Mapping[str, int],
    looks: Sequence[Place],
    avoided: Sequence[str],
    radius: float,
    fires: Sequence[Place],
) -> tuple[Lookout, ...]:
    """The best places of a home to look for fires that nobody saw: their share of the fires is that of unseen floor.

    Arguments as for `lookouts`; `fires`: where the others were found [m], each of which is in another room. From
    openings rooms are seen in which nothing is known. Where the agent stands is called HERE.
    """
    exhausted = [*avoided, *visits]
    passages = _passages(decision, exhausted)
    things, seen = [*_things(decision, exhausted), *passages.items()], decision.map
    ends = stands(decision, [name for name, _ in things], radius)
    floor, weight, behind = _where_it_may_burn(seen, [passages[name] for name in passages])
    for place in (*looks, *fires):
        weight[in_sight(seen, place, floor, SAME_ROOM)] *= SECOND
    kept = [(name, place) for name, place in things if name in ends]
    names, places = [HERE, *(name for name, _ in kept)], [np.array(decision.agent_position), *(p for _, p in kept)]
    eyes = [decision.agent_position, *(ends[name].place for name, _ in kept)]
    shown = np.array([in_sight(seen, place, floor, WARMTH) for place in eyes]).reshape(len(names), -1)
    for room, name in zip(behind, passages, strict=True):
        if name in ends:
            shown[names.index(name)] |= room
    ease = 1.0 / (1.0 + np.array([0.0, *(ends[name].length for name, _ in kept)]))
    return _best(names, places, shown * weight, ease, LEAST_NEW, True)


def _where_it_may_burn(
    seen: SemanticMap, passages: Sequence[NDArray[np.float64]]
) -> tuple[NDArray[np.float64], NDArray[np.float64], Mask]:
    """Floor on which a fire would not have shown [m], [P, 2], its chance of a fire, [P], and if it is behind a passage.

    The last is [D, P], for D `passages` at these places [m], each of which leads to a room on the side of it on which
    least was seen. A fire shows by the warmth of floor up to COLD from it.
    """
    floor = seen.explored & (seen.height < WALKABLE)
    cold = ndimage.binary_dilation(floor, iterations=round(COLD / seen.cell), mask=seen.height <= HIDES)
    hidden = ~seen.explored & ~cold
    y, x = np.nonzero((np.indices(hidden.shape) % EVERY == 0).all(axis=0))
    grid = seen.centre_of(y, x)
    behind = np.zeros((len(passages), len(grid)), bool)
    for row, passage in enumerate(passages):
        along, across = (grid - passage).T
        sides = [
            (abs(a) <= ROOM / 2) & (sign * b > 0) & (sign * b <= ROOM)
            for a, b in ((along, across), (across, along))
            for sign in (-1, 1)
        ]
        unknown = [float(hidden[y[side], x[side]].mean()) if side.any() else 0.0 for side in sides]
        side = sides[int(np.argmax(unknown))] & hidden[y, x]
        behind[row, side] = in_sight(seen, (float(passage[0]), float(passage[1])), grid[side], WARMTH)
    may = hidden[y, x] & (unseen_floor(seen, DEPTH)[y, x] | behind.any(axis=0))
    area = seen.cell**2
    left = max(HOME - float(floor.sum()) * area, float(may.sum()) * area * EVERY**2)
    return grid[may], np.full(int(may.sum()), area * EVERY**2 / max(left, area)), behind[:, may]


def _best(
    names: Sequence[str],
    places: Sequence[NDArray[np.float64]],
    shows: NDArray,
    ease: NDArray,
    least: float,
    passes: bool = False,
) -> tuple[Lookout, ...]:
    """The best of N places by what they show, [N, P], and their `ease`, [N], each counting what others leave.

    Where the best one shows less than `least` that is the end; or, if it `passes` over such places, the next one comes.
    """
    chosen: list[Lookout] = []
    for _ in range(MOST):
        share = shows.sum(axis=1)
        score = share * ease
        best = int(np.argmax(np.where(share >= least, score, 0.0) if passes else score))
        if share[best] < least:
            break
        place = float(places[best][0]), float(places[best][1])
        chosen.append(Lookout(names[best], place, float(share[best])))
        shows[:, shows[best] > 0] = 0.0
    return tuple(chosen)


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
    if every and sight >= FAR:
        return points, np.where(new, BARRED**near, np.where(near > 0, LOOKED, PASSED))
    return points, np.where(new, BARRED**near, np.where(near > 0, HIDDEN**near, passing))


def unseen_floor(seen: SemanticMap, depth: float = DEPTH) -> Mask:
    """The cells, [Y, X], not seen and within `depth` [m] of floor that was, with no other seen cell between."""
    floor = seen.explored & (seen.height < WALKABLE)
    steps = round(depth / seen.cell)
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


def _passages(decision: Decision, avoided: Sequence[str]) -> dict[str, NDArray[np.float64]]:
    """The places [m] of the openings through which a robot gets, by name."""
    passable = [o for o in decision.openings if o.kind != "window" and (o.open >= WIDE or o.broken)]
    return {o.name: np.array(o.position[:2], np.float64) for o in passable if o.name not in avoided}


def _unvisited(
    things: Sequence[tuple[str, NDArray[np.float64]]], visits: Mapping[str, int], share: float
) -> tuple[Lookout, ...]:
    """The first of `things` that it has not walked to in search, apart from each other, each of which has a `share`."""
    chosen: list[Lookout] = []
    for name, place in things:
        apart = all(np.hypot(*(place - mark.place)) >= ANEW for mark in chosen)
        if len(chosen) < MOST and apart and not visits.get(name):
            chosen.append(Lookout(name, (float(place[0]), float(place[1])), share))
    return tuple(chosen)
