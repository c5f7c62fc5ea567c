"""Routes of the arm: how it gets from where it is to a posture, past the furniture that was seen, in the fewest frames.

A route goes straight in the space of joints, or over postures between: one of the robot's own, with the elbow up, or
those of a path over the roadmap, and one with the hand above the thing. Meanwhile the base may draw back, and drive on.
Joints along the arm and the hand, and points between them, must keep above what the map shows.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills.context import Stage
from hazard_ms.skills.motor.surface import Leg, Surface

CLOSELY = 0.25  # from above a thing, joints must be this close before the hand comes down on it [rad] [ours]
HIT_COST = 8.0  # what a checked point that lies in something counts as much as [frames] [ours]


@dataclass(frozen=True)
class Route:
    """Legs one after another, the `frames` that they take at least, and how many checked points lie in something."""

    legs: tuple[Leg, ...]
    frames: float
    hits: int
    hit_cost: float = HIT_COST  # [frames]

    @property
    def cost(self) -> float:
        """The frames that the route takes, and what touching things is likely to cost [frames]."""
        return self.frames + self.hit_cost * self.hits


def quickest(
    stage: Stage,
    goals: Sequence[Leg],
    surface: Surface,
    back: float,
    above: NDArray[np.float64] | None = None,
    leaving: bool = False,
    hit_cost: float = HIT_COST,
) -> Route:
    """The quickest route from where the arm is to one of `goals` by its frames and what it touches.

    `back`: how far the base may draw back on the way [m]; `above`: joints [rad], [..., J], with the hand above the
    thing, which are passed last, or, where they help, first when `leaving` it; `hit_cost`: what a
    checked point that lies in something counts as much as [frames].
    """
    now = Leg(stage.robot.arm(), 0.0)
    made = [route for goal in goals for route in _routes(stage, now, goal, back, above, leaving)]
    best: Route | None = None
    for route in sorted(made, key=lambda r: r.frames):
        if best is not None and best.cost <= route.frames:
            break
        hits = surface.hits([now, *route.legs], np.inf if best is None else (best.cost - route.frames) / hit_cost)
        found = Route(route.legs, route.frames, hits, hit_cost)
        best = found if best is None or found.cost < best.cost else best
    assert best is not None
    if best.hits or len(best.legs) > 1:  # for a straight one that is free there is nothing better
        over = (_over_roadmap(stage, now, goal, surface, above, leaving, hit_cost) for goal in goals)
        best = min(best, *over, key=lambda route: route.cost)
    return best


def _over_roadmap(
    stage: Stage,
    now: Leg,
    goal: Leg,
    surface: Surface,
    above: NDArray[np.float64] | None,
    leaving: bool,
    hit_cost: float,
) -> Route:
    """The quickest route to `goal` over the roadmap, without those of its postures that it can do without."""
    ends = [] if above is None else [_above(above, goal, leaving)]
    first, last = (ends, [goal]) if leaving else ([], [*ends, goal])
    paths = surface.paths(first[0].arm if first else now.arm, goal.ahead, hit_cost)
    middle = [Leg(posture, goal.ahead) for posture in paths.to(last[0].arm)]

    def checked(legs: Sequence[Leg]) -> Route:
        timed = _timed(stage, now, (*first, *legs, *last))
        return replace(timed, hits=surface.hits([now, *timed.legs]), hit_cost=hit_cost)

    best, number = checked(middle), 0
    while number < len(middle):
        fewer = middle[:number] + middle[number + 1 :]
        found = checked(fewer)
        if found.cost <= best.cost:
            middle, best, number = fewer, found, max(0, number - 1)
        else:
            number += 1
    return best


def _routes(
    stage: Stage, now: Leg, goal: Leg, back: float, above: NDArray[np.float64] | None, leaving: bool
) -> Iterator[Route]:
    """All routes to `goal`, not yet checked."""
    over = [] if above is None else [_above(above, goal, leaving)]
    by = [Leg(posture, ahead) for posture in stage.robot.between for ahead in {0.0, -back / 2, -back}]
    ways = [over, *([*over, b] if leaving else [b, *over] for b in by)]
    if leaving:
        ways += [[], *([b] for b in by)]
    for legs in ways:
        yield _timed(stage, now, (*legs, goal))


def _above(arm: NDArray[np.float64], goal: Leg, leaving: bool) -> Leg:
    """The leg to the joints `arm` [rad], [J], at which the hand is above the thing: it comes down from nowhere else."""
    return Leg(arm, 0.0) if leaving else Leg(arm, goal.ahead, CLOSELY)


def _timed(stage: Stage, now: Leg, legs: tuple[Leg, ...]) -> Route:
    build = stage.robot.build
    frames = sum(
        max(float(np.abs(b.arm - a.arm).max()) / build.arm_step, abs(b.ahead - a.ahead) / build.forward_step)
        for a, b in itertools.pairwise([now, *legs])
    )
    return Route(legs, frames, 0)
