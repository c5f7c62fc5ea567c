"""The fires of a home as its walls hold them: where flames are, when they were seen, and what each of them threatens.

As `fire_watch` has it for a single room, but for four things: nothing gets through walls; a fire that was seen long ago
has gone on since; what was put out stays out; and what would burn without one of the fires is told, too. All futures
of a map draw the same chances, so that they differ by what was put out alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from hazard_ms.agents.search.fire_watch import WARM, things_of, warm_floor
from hazard_ms.agents.search.floor_plan import FloorPlan, shut_doors
from hazard_ms.agents.search.stands import in_sight
from hazard_ms.sketch.planning.creeping_fire import CELL, STEP, Flames, Things, burning_from, found
from hazard_ms.skills.decision import Decision

FUTURES = 6  # that are drawn for each fire that may be put out [ours]
FARTHEST = 20  # cells that a fire creeps in 3,000 frames (docs/physics.md 1.1) [ours]
LIKELY, WHOLE = 0.05, 0.4  # chance from which a cell is part of a fire, and of all its cells that make one [ours]
APART = 3  # cells between two fires [ours]
FIRES_APART = 2.0  # distance between places that were put out from which they are of two fires [m] [ours]
PUT_OUT = 1.2  # distance from where nothing burned within which older warmth tells nothing [m] [ours]
# the same in sight of where a fire was put out: a fire warms most of its room, and no room begins with two [ours]
ROOM = 3.5
GRID = 0.2  # between the places from which a fire may be fought [m] [ours]

Array = NDArray[np.float64]


class Out(NamedTuple):
    """A place at which a fire was put out [m], and when; `burned`: whether it was there, not gone before."""

    place: tuple[float, float]
    frame: int
    burned: bool


@dataclass(frozen=True)
class Seat:
    """A fire on the floor: flames close to each other."""

    place: tuple[float, float]  # mean of its flames [m]
    flames: float  # how many there were when last seen
    seen: float  # frame of that
    cells: NDArray[np.bool_]  # of the window of all flames, [Y, X]
    flames_at: Array  # where there may be flames [m], [F, 2]
    shares: Array  # of its flames that are expected at each of these, [F]


class HouseFire:
    """The fires of one episode, found anew whenever their warmth on the map has changed."""

    def __init__(self, seed: int) -> None:
        """Begin an episode; `seed` fixes the futures that are drawn."""
        self._seed = seed
        self._seen: tuple[float, ...] = ()
        self._out: tuple[Out, ...] = ()
        self._known: dict[tuple[int, ...], dict[int, float]] = {}
        self._flames: Flames | None = None
        self._ways: dict[tuple[float, float], Array] = {}
        self.seats: tuple[Seat, ...] = ()

    def put_out(self, place: tuple[float, float], frame: int, burned: bool = True) -> None:
        """Remember that what burned around a `place` [m] is out since `frame`; `burned`: whether a fire was there."""
        self._out, self._seen = (*self._out, Out(place, frame, burned)), ()

    @property
    def places(self) -> list[tuple[float, float]]:
        """The places of the fires that were found [m], those that are out first; close to each other they are one."""
        apart: list[tuple[float, float]] = []
        for out in self._out:
            if out.burned and all(np.hypot(*np.subtract(out.place, place)) >= FIRES_APART for place in apart):
                apart.append(out.place)
        return [*apart, *(seat.place for seat in self.seats)]

    def look(self, decision: Decision, number: int) -> None:
        """Find the fires behind the warmth of the hazard `number` on the map."""
        levels = decision.map.levels[number]
        warm = np.isfinite(levels) & (levels >= WARM)
        for out in self._out:
            points = decision.map.centre_of(*np.nonzero(warm))
            warm[warm] = ~(_around(decision, out, points) & (decision.map.told_at[warm] <= out.frame))
        indices, things = things_of(decision)
        burning = float((things.temperature >= 600.0).sum())
        seen = float(warm.sum()), float(levels[warm].sum()), float(len(indices)), burning
        if seen == self._seen:
            return
        self._seen, self._known = seen, {}
        self._indices, self._things = indices, self._cooled(decision, things)
        self._ways = {}
        self._plan, self._end = FloorPlan(decision.map, shut_doors(decision.openings)), decision.max_frames
        self._flames = self._found(decision, levels, warm)
        self.seats = self._seats()

    def _cooled(self, decision: Decision, things: Things) -> Things:
        """Things as they are where fires were put out: what burned there does no more."""
        temperature = things.temperature.copy()
        seen = np.array([decision.map.objects[index].frame for index in decision.map.objects], np.float64)
        for out in self._out:
            old = _around(decision, out, things.base[:, :2]) & (seen <= out.frame)
            temperature[old] = np.minimum(temperature[old], 100.0)
        return replace(things, temperature=temperature, whole_at=seen)

    def _found(self, decision: Decision, levels: NDArray, warm: NDArray[np.bool_]) -> Flames | None:
        floor = warm_floor(decision.map, levels, warm)
        if floor is None:
            return None
        flames = found(floor.points, floor.levels, self._things, floor.blocked, FARTHEST, self._plan.clear)
        if flames is None:
            return None
        nearest = ((flames.places[:, None, :2] - floor.points[:, :2]) ** 2).sum(axis=-1).argmin(axis=1)
        since = decision.map.told_at[floor.cells][nearest].astype(np.float64).reshape(flames.chance.shape)
        return replace(flames, since=since)

    def _seats(self) -> tuple[Seat, ...]:
        flames = self._flames
        if flames is None or flames.since is None:
            return ()
        likely = flames.chance >= LIKELY
        labels, count = ndimage.label(ndimage.binary_dilation(likely, iterations=APART), np.ones((3, 3)))
        made = []
        for label in range(1, count + 1):
            cells = labels == label
            share = np.where(cells & likely, flames.chance, 0.0)
            if share.sum() < WHOLE:
                continue
            y, x = np.nonzero(share)
            places = flames.corner + CELL * np.stack([x, y], -1)
            middle = (places * share[y, x, None]).sum(0) / share.sum()
            seen = float(flames.since[y, x].max())
            at = float(middle[0]), float(middle[1])
            made.append(Seat(at, float(share.sum()), seen, cells, places, share[y, x] / share.sum()))
        return tuple(made)

    def share_around(self, seat: Seat, place: Array, far: float) -> float:
        """The share of the flames of a `seat` within `far` [m] of a `place` [m], [2], with no wall between."""
        near = np.hypot(*(seat.flames_at - place).T) < far
        return float(seat.shares[near][self._plan.clear(seat.flames_at[near], place[None])[:, 0]].sum())

    def stand(self, seat: Seat, here: tuple[float, float], far: float) -> tuple[float, float] | None:
        """The place [m] with the shortest way past walls from `here` [m] from which a `seat` is in sight.

        It is within `far` [m] of the seat; None where there is none on the floor that was seen.
        """
        if here not in self._ways:
            self._ways = {here: self._plan.ways_from(here)}
        y, x = np.mgrid[-far : far + GRID : GRID, -far : far + GRID : GRID]
        points = np.array(seat.place) + np.stack([x, y], -1)[np.hypot(x, y) <= far]
        lengths = self._plan.at(self._ways[here], points)
        lengths[~self._plan.clear(points, np.array([seat.place]))[:, 0]] = np.inf
        best = int(np.argmin(lengths))
        return (float(points[best, 0]), float(points[best, 1])) if np.isfinite(lengths[best]) else None

    def whole_until(self, without: Sequence[int] = ()) -> dict[int, float]:
        """The frame until which each known thing stays whole in half of the futures, by index; inf for all along.

        `without`: numbers of `seats` that are put out. It is empty where no fire is known.
        """
        key = tuple(sorted(without))
        if self._flames is None:
            return {}
        if key not in self._known:
            self._known[key] = self._forecast(self._flames, key)
        return self._known[key]

    def _forecast(self, flames: Flames, without: Sequence[int]) -> dict[int, float]:
        chance = flames.chance.copy()
        for number in without:
            chance[self.seats[number].cells] = 0.0
        if not self._indices or not (chance > 0.0).any():
            return dict.fromkeys(self._indices, float("inf"))
        assert flames.since is not None
        start = float(flames.since[chance > 0.0].min())
        draws = np.random.default_rng([self._seed, 0x484F5553])  # "HOUS": the same for all of `without`
        left = replace(flames, chance=chance)
        caught = burning_from(left, self._things, start, self._end, FUTURES, draws, self._plan.clear)
        return dict(zip(self._indices, np.median(caught - STEP, axis=0).tolist(), strict=True))


def _around(decision: Decision, out: Out, points: Array) -> NDArray[np.bool_]:
    """Which of the `points` [m], [P, 2], are of what is out: [P]."""
    near = np.hypot(*(points - out.place).T) < PUT_OUT
    return near | in_sight(decision.map, out.place, points, ROOM) if out.burned else near
