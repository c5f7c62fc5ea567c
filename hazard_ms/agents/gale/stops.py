"""Places where an agent could put down what it holds: before it, now, or at the end or after a step of a walk."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.search.walks import TURNING
from hazard_ms.sketch.travel.ways import WALK
from hazard_ms.skills.decision import DROP, WALK_ONE_STEP, WALK_TO, Action, Decision
from hazard_ms.skills.mitigations.putting import BEFORE
from hazard_ms.skills.motor.navigation import LOW, Ways
from hazard_ms.skills.motor.walking import ARRIVED, MIDPOINT, midpoint

PUT_DOWN = 75.0  # frames in which a thing is put on the ground [measured: 68 to 82 in two episodes, Fetch]
SEEKING = 60.0  # frames by which the way to a site is longer, since walks end where they may [ours]
ROOM = 0.15  # distance around the place within which nothing may stand [m] [ours]
ASIDE = 0.2  # how far from where it is planned a walk may end [m] [ours]
FARTHEST = 9.0  # distance of the things to which a walk is weighed [m] [ours]
SURER = 40.0  # frames by which a cart may be farther than a place on the ground, since it keeps things for good [ours]

Keeps = Callable[[NDArray[np.float64]], NDArray[np.bool_]]  # places x, y [m], [P, 2] -> whether they keep it, [P]


class Stop(NamedTuple):
    """A place where what is in the hand could be put down."""

    action: Action  # that leads there: a walk, whole or one step of it, or the drop itself
    place: tuple[float, float]  # [m]
    frames: float  # of the walk and of putting it down


def stops(decision: Decision, radius: float) -> list[Stop]:
    """The places that are free, for a robot of `radius` [m], whose arm puts things down before it."""
    seen, ahead = decision.map, radius + BEFORE
    here, heading = np.asarray(decision.agent_position), decision.agent_heading
    facing = np.array([np.cos(heading), np.sin(heading)])
    made = [Stop(Action(DROP), _point(here + ahead * facing), PUT_DOWN)]
    things = {
        decision.names[index]: thing
        for index, thing in seen.objects.items()
        if decision.names[index] != decision.held and np.hypot(*(thing.position[:2] - here)) < FARTHEST
    }
    goals = {name: _point(thing.position) for name, thing in things.items()}
    if goals:
        start = _point(here)
        ways = Ways(seen.obstacles, seen.explored, seen.cell, seen.origin, start, [*goals.values(), start], radius)
        for name, goal in goals.items():
            path = ways.path(goal, ARRIVED + things[name].radius)
            if path is None or path.short > ARRIVED + things[name].radius + ARRIVED:
                continue
            end = path.points[-1] if len(path.points) else here
            place = _point(end + ahead * _unit(np.array(goal) - end))
            made.append(Stop(Action(WALK_TO, name), place, WALK * path.length + TURNING + PUT_DOWN))
            step = midpoint(path, (*start, heading))
            if step is not path.points:
                before = step[-2] if len(step) > 1 else here
                place = _point(step[-1] + ahead * _unit(step[-1] - before))
                made.append(Stop(Action(WALK_ONE_STEP, name), place, WALK * MIDPOINT + TURNING + PUT_DOWN))
    return [stop for stop in made if _free(decision, stop.place)]


def put_away(decision: Decision, radius: float, keeps: Keeps, cart: float) -> Stop | None:
    """The nearest place that keeps what is in the hand; None where there is none, or a cart is hardly farther.

    `radius` of the robot [m]; `keeps` tells which places keep the thing; `cart`: the frames that putting it into the
    nearest cart takes, with the way. Around the ends of walks, all places must keep it.
    """
    found = stops(decision, radius)
    if not found:
        return None
    around = np.array([(0.0, 0.0), (ASIDE, 0.0), (-ASIDE, 0.0), (0.0, ASIDE), (0.0, -ASIDE)])
    places = np.array([stop.place for stop in found])[:, None] + around
    good = keeps(places.reshape(-1, 2)).reshape(len(found), -1)
    fine = [row[0] if stop.action.verb == DROP else row.all() for stop, row in zip(found, good, strict=True)]
    kept = [stop for stop, keep in zip(found, fine, strict=True) if keep]
    best = min(kept, key=lambda stop: stop.frames, default=None)
    return None if best is None or best.frames + SURER > cart else best


def _unit(vector: NDArray[np.floating]) -> NDArray[np.floating]:
    return vector / max(float(np.hypot(*vector)), 1e-6)


def _point(place: NDArray[np.floating]) -> tuple[float, float]:
    return float(place[0]), float(place[1])


def _free(decision: Decision, place: tuple[float, float]) -> bool:
    """Whether the ground around a place was seen, and nothing stands there."""
    seen = decision.map
    reach = int(np.ceil(ROOM / seen.cell))
    x, y = np.floor((np.array(place) - seen.origin) / seen.cell).astype(int)
    rows, columns = slice(max(y - reach, 0), y + reach + 1), slice(max(x - reach, 0), x + reach + 1)
    return bool(seen.explored[rows, columns].any() and (seen.height[rows, columns] <= LOW).all())
