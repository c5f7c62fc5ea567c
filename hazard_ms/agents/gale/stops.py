"""Where an agent that holds a thing could put it down: before it, now or at the end of a walk to something it knows."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.search.walks import TURNING
from hazard_ms.sketch.travel.ways import WALK
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.mitigations.putting import BEFORE
from hazard_ms.skills.motor.navigation import LOW, Ways
from hazard_ms.skills.motor.walking import ARRIVED

PUT_DOWN = 70.0  # frames in which a thing is put on the ground [ours]
ROOM = 0.15  # distance around the place within which nothing may stand [m] [ours]
FARTHEST = 9.0  # distance of the things to which a walk is weighed [m] [ours]
SURER = 40.0  # frames by which a cart may be farther than a place on the ground, since it keeps things for good [ours]

Keeps = Callable[[NDArray[np.float64]], NDArray[np.bool_]]  # places x, y [m], [P, 2] -> whether they keep it, [P]


class Stop(NamedTuple):
    """A place where what is in the hand could be put down."""

    name: str | None  # of the thing to walk to first; None: here
    place: tuple[float, float]  # [m]
    frames: float  # of the walk and of putting it down


def stops(decision: Decision, radius: float) -> list[Stop]:
    """The places that are free, for a robot of `radius` [m], whose arm puts things down before it."""
    seen, ahead = decision.map, radius + BEFORE
    here, heading = np.asarray(decision.agent_position), decision.agent_heading
    made = [Stop(None, _point(here + ahead * np.array([np.cos(heading), np.sin(heading)])), PUT_DOWN)]
    things = {
        decision.names[index]: thing
        for index, thing in seen.objects.items()
        if decision.names[index] != decision.held and np.hypot(*(thing.position[:2] - here)) < FARTHEST
    }
    goals = {name: _point(thing.position) for name, thing in things.items()}
    if goals:
        start = _point(here)
        ways = Ways(seen.height, seen.explored, seen.cell, seen.origin, start, [*goals.values(), start], radius)
        for name, goal in goals.items():
            path = ways.path(goal, ARRIVED + things[name].radius)
            if path is None or path.short > ARRIVED + things[name].radius + ARRIVED:
                continue
            end = path.points[-1] if len(path.points) else here
            facing = (np.array(goal) - end) / max(float(np.hypot(*(np.array(goal) - end))), 1e-6)
            made.append(Stop(name, _point(end + ahead * facing), WALK * path.length + TURNING + PUT_DOWN))
    return [stop for stop in made if _free(decision, stop.place)]


def put_away(decision: Decision, radius: float, keeps: Keeps, cart: float) -> Stop | None:
    """The nearest place that keeps what is in the hand; None where there is none, or a cart is hardly farther.

    `keeps` tells which places keep it; `cart`: the frames that putting it into the nearest cart takes, with the way.
    """
    found = stops(decision, radius)
    if not found:
        return None
    good = keeps(np.array([stop.place for stop in found]))
    kept = [stop for stop, fine in zip(found, good, strict=True) if fine]
    best = min(kept, key=lambda stop: stop.frames, default=None)
    return None if best is None or best.frames + SURER > cart else best


def _point(place: NDArray[np.floating]) -> tuple[float, float]:
    return float(place[0]), float(place[1])


def _free(decision: Decision, place: tuple[float, float]) -> bool:
    """Whether the ground around a place was seen, and nothing stands there."""
    seen = decision.map
    reach = int(np.ceil(ROOM / seen.cell))
    x, y = np.floor((np.array(place) - seen.origin) / seen.cell).astype(int)
    rows, columns = slice(max(y - reach, 0), y + reach + 1), slice(max(x - reach, 0), x + reach + 1)
    return bool(seen.explored[rows, columns].any() and (seen.height[rows, columns] <= LOW).all())
