"""The arm's ways to a thing from where the base stands, straight, turned aside or driving on.

The quickest is chosen, by the frames that it takes and by what it touches on the map.
"""

from __future__ import annotations

from collections.abc import Iterator, Set
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills.context import Stage
from hazard_ms.skills.motor.arm import before, lacking, postures
from hazard_ms.skills.motor.drift import Drift
from hazard_ms.skills.motor.kinematics import Posture
from hazard_ms.skills.motor.motion import turned
from hazard_ms.skills.motor.navigation import LOW
from hazard_ms.skills.motor.routes import HIT_COST, Route, quickest
from hazard_ms.skills.motor.surface import Leg, Surface, place_of
from hazard_ms.tasks.episode.grasp import GRASP_REACH

GRASP = 0.8 * GRASP_REACH  # the hand shuts this close to the thing [m]
CLEAR = 0.05  # the hand aims this far off the thing, so that it does not push it away [m]
GETS_THERE = GRASP - CLEAR  # position error of a posture at which the hand gets close enough to the thing [m]
STAND_OFF = 0.85  # share of the arm's span at which the base stands for a pick-up
HAND_HEIGHT = 0.06  # of the middle of the hand above a board at least, where the hand goes in between two [m] [ours]
OVER = 0.25  # the hand comes down from above on things higher than this [m]
TURNS = tuple(np.deg2rad([0.0, 30.0, -30.0, 60.0, -60.0]).tolist())  # of the base before it reaches [rad] [ours]
LEAST = 25.0  # a route that is at most this much longer than what it takes to turn is not bettered [frames] [ours]
FEW_HITS = 30  # points of a route that may lie in something: the map is coarse, and makes things wider [ours]
CHASE_FRAMES = 15  # first guess of how long the hand takes to a moving thing [frames] [ours]
HURRY = 3.0  # what a point that lies in something counts as much as, while a thing moves away [frames] [ours]


@dataclass(frozen=True)
class Way:
    """A way to a thing: the base turns, then the arm follows a route."""

    number: int  # of the posture
    turn: float  # of the base, anticlockwise [rad]
    route: Route
    meets: NDArray[np.float64]  # the thing's middle when the hand gets there, [3] [m], world frame
    frames: float  # that it takes at least
    cost: float  # these, and what touching things is likely to cost [frames]


def aims(
    stage: Stage, middle: NDArray[np.float64], index: int, outward: NDArray[np.float64] | None = None
) -> list[NDArray[np.float64]]:
    """Points, [3] [m], for the hand if the middle of the thing `index` were at `middle` [m], [3], world frame.

    Above the thing, and before it as seen from the shoulder; a little off its box. Where furniture is around it, they
    are before it in the direction `outward`, [3], and as seen from the shoulder; None or 0: nothing is.
    """
    half = stage.world.extent[0, index].cpu().numpy().astype(np.float64) / 2
    towards = stage.robot.shoulder() - middle
    towards = towards / max(float(np.linalg.norm(towards)), 1e-6)
    top = middle + np.array([0.0, 0.0, float(half.min() if half[2] > 0.2 else half[2]) + CLEAR])
    near = middle + towards * (float(half[:2].min()) + CLEAR)
    if outward is not None and outward.any():  # the hand is thick: it must not scrape over the board
        above = np.array([0.0, 0.0, max(HAND_HEIGHT - float(half[2]), 0.0)])
        return [middle + above + outward * (float(half[:2].min()) + CLEAR), near + above]
    return [top, near]


def arm_way_where_it_will_be(stage: Stage, index: int, tried: set[int], drift: Drift) -> Way | None:
    """The quickest way to the thing, or to where a thing that moves will be when the hand gets there."""
    if not drift.ahead(1.0).any():
        return arm_way(stage, index, tried, stage.position(index))
    way = arm_way(stage, index, tried, stage.position(index) + drift.ahead(CHASE_FRAMES), HURRY)
    return way and arm_way(stage, index, tried, stage.position(index) + drift.ahead(way.route.frames), HURRY)


def arm_way(
    stage: Stage, index: int, tried: set[int], middle: NDArray[np.float64], hit_cost: float = HIT_COST
) -> Way | None:
    """The quickest way to the thing at `middle` [m], [3], by its frames and what it touches.

    Goals in `tried` are left out; None if the arm is too short for all others, or too much is in its way. The base may
    turn first, or draw back meanwhile, unless the thing moves; that is tried until nothing better can be found.
    """
    place, best, number = replace(place_of(stage, index), middle=middle), None, 0
    for turn in TURNS if hit_cost == HIT_COST else TURNS[:1]:
        surface, back = Surface(stage, place, turn), lacking(stage, turn)
        x, y, _ = stage.robot.base()
        seen = turned(middle, (x, y), -turn)  # where the thing would be before a base that did not turn
        turning = abs(turn) / stage.robot.build.turn_step
        for ahead in standings(stage, middle) if turn == 0.0 else [0.0]:
            for aim in aims(stage, seen, index, surface.outward):
                if best is not None and best.route.hits == 0 and best.frames <= turning + LEAST:
                    return best
                skipped = {n - number for n in tried}
                for k, route in routes(stage, aim, surface, back, ahead, hit_cost, skipped):
                    if best is None or turning + route.cost < best.cost:
                        best = Way(number + k, turn, route, middle, turning + route.frames, turning + route.cost)
                number += len(stage.robot.pointing)
    return None if best is None or best.route.hits > FEW_HITS else best


def routes(
    stage: Stage,
    aim: NDArray[np.float64],
    surface: Surface,
    back: float,
    ahead: float = 0.0,
    hit_cost: float = HIT_COST,
    skipped: Set[int] = frozenset(),
) -> Iterator[tuple[int, Route]]:
    """The quickest route to each posture with the hand at `aim` [m], [3], and the posture's number, from 1 on.

    The base may draw `back` [m] on the way, and drives `ahead` [m]. Postures that are `skipped`, and those that do not
    get there, are left out.
    """
    heading = stage.robot.base()[2]
    moved = ahead * np.array([np.cos(heading), np.sin(heading), 0.0])
    for number, posture in enumerate(postures(stage, aim - moved, surface.inward), start=1):
        if number not in skipped and posture.error <= GETS_THERE:
            above = before(stage, posture.arm, surface) if surface.place.middle[2] > OVER else None
            yield number, quickest(stage, [Leg(posture.arm, ahead)], surface, back, above, hit_cost=hit_cost)


def standings(stage: Stage, thing: NDArray[np.float64]) -> list[float]:
    """The distances [m] by which the base may drive on to reach for `thing`, [3] [m]: 0, and more if there is room."""
    x, y, _ = stage.robot.base()
    far = float(np.hypot(thing[0] - x, thing[1] - y))
    nearer = far - STAND_OFF * stage.robot.build.span(float(thing[2]))[1]
    ahead = min(nearer, stage.room_ahead(LOW, far) - stage.robot.build.radius)
    return [0.0, ahead] if ahead > 0.0 else [0.0]


def reaching(stage: Stage, index: int) -> list[Posture]:
    """The postures that bring the hand to the thing `index` from where the base stands, were nothing in its way."""
    found = (p for aim in aims(stage, stage.position(index), index) for p in postures(stage, aim))
    return [posture for posture in found if posture.error < GETS_THERE]


def free_postures(stage: Stage, index: int) -> list[Posture]:
    """The postures of `reaching` in which no part of the arm lies in anything on the map."""
    surface = Surface(stage, place_of(stage, index))
    return [p for p in reaching(stage, index) if surface.hits([Leg(p.arm, 0.0), Leg(p.arm, 0.0)]) == 0]
