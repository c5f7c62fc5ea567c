"""Routes of the arm: how it gets from where it is to a posture, past the furniture that was seen, in the fewest frames.

A route goes straight in the space of joints, or over postures between: one of the robot's own, with the elbow up, and
one with the hand above the thing. Meanwhile the base may draw back, and drive on. Joints along the arm and the hand,
and points between them, must keep above what the map shows.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from hazard_ms.skills.context import Stage

NEARLY = 0.5  # a posture on the way is passed when every joint is this close [rad] [ours]
SPACING = 0.15  # greatest turn of a joint between two postures that are checked [rad] [ours]
ARM_RADIUS = 0.06  # distance that the middle of the arm keeps above things; Fetch's upper arm is 0.12 m thick [m]
HAND_RADIUS = 0.1  # and that the middle of the hand keeps; the G1's palm and thumb need most [m] [ours]
BETWEEN = (0.0, 0.33, 0.67)  # points of each link that are checked, as shares of its length [-] [ours]
OWN_HEIGHT = 0.3  # the arm keeps above this over its own base [m] [ours]
HIT_COST = 8.0  # what a checked point that lies in something counts as much as [frames] [ours]
WINDOW = 2.0  # distance from the base within which the map is looked at [m] [ours]
SLOPE = 0.7  # of the cone around the thing within which the hand comes down to what it stands on [-] [ours]


@dataclass(frozen=True)
class Leg:
    """A straight part of a route: to the joints `arm` [rad], [J], with the base `ahead` [m] of the route's start."""

    arm: NDArray[np.float64]
    ahead: float


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


@dataclass(frozen=True)
class Place:
    """The place of the thing that is reached for: there the hand may come down to what the thing stands on."""

    middle: NDArray[np.float64]  # [3] [m], world frame
    radius: float  # of the circle around the thing [m]
    bottom: float  # height of what it stands on above the floor [m]
    top: float  # its own height above the floor [m]


def place_of(stage: Stage, index: int) -> Place:
    """The place where the thing `index` is now."""
    middle = stage.position(index)
    half = stage.world.extent[0, index].cpu().numpy().astype(np.float64) / 2
    return Place(middle, float(np.hypot(*half[:2])), float(middle[2] - half[2]), float(middle[2] + half[2]))


class Surface:
    """The heights that the arm keeps above, as the map has them now."""

    def __init__(self, stage: Stage, place: Place) -> None:
        """Take the map of `stage` as it is; around `place` the hand may come down."""
        self._stage = stage
        self._place = place
        self._x, self._y, heading = stage.robot.base()
        self._ahead = np.array([np.cos(heading), np.sin(heading)])
        self._origin, self._height = self._window()

    def _window(self) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
        """The map within WINDOW of the base: its corner [m], [2], and heights [m], [Y, X].

        A cell that was never seen is taken to be as high as the nearest one that was.
        """
        seen = self._stage.seen
        size = int(np.ceil(WINDOW / seen.cell))
        y, x = seen.cell_of((self._x, self._y))
        low_x, low_y = max(0, x - size), max(0, y - size)
        part = np.s_[low_y : max(low_y + 1, y + size + 1), low_x : max(low_x + 1, x + size + 1)]
        height, explored = seen.height[part], seen.explored[part]
        if explored.any():
            nearest = ndimage.distance_transform_edt(~explored, return_distances=False, return_indices=True)
            height = height[tuple(nearest)]
        return seen.origin + seen.cell * np.array([low_x, low_y]), height

    def hits(self, legs: Sequence[Leg], enough: float = np.inf) -> int:
        """The number of checked points of a route over `legs`, the first of which is its start, that lie in something.

        It stops counting between legs where there are `enough`.
        """
        count, start = 0, legs[0]
        for end in legs[1:]:
            count += self._hits(start, end)
            if count >= enough:
                break
            share = max(0.0, 1.0 - NEARLY / max(float(np.abs(end.arm - start.arm).max()), 1e-9))
            start = Leg(start.arm + share * (end.arm - start.arm), end.ahead)  # where the next leg begins
        return count

    def _hits(self, start: Leg, end: Leg) -> int:
        points, middles, radii = [], [], []
        steps = max(1, int(np.ceil(np.abs(end.arm - start.arm).max() / SPACING)))
        for share in np.arange(1, steps + 1) / steps:
            along = self._stage.robot.arm_places(start.arm + share * (end.arm - start.arm))
            along = np.vstack([*(along[:-1] + b * np.diff(along, axis=0) for b in BETWEEN), along[-1:]])
            moved = (start.ahead + share * (end.ahead - start.ahead)) * self._ahead
            along[:, :2] += moved
            points.append(along)
            middles.append(np.broadcast_to(moved + (self._x, self._y), (len(along), 2)))
            radii += [ARM_RADIUS] * (len(along) - 1) + [HAND_RADIUS]
        return int(self._inside(np.vstack(points), np.vstack(middles), np.array(radii)).sum())

    def _inside(
        self, points: NDArray[np.float64], base: NDArray[np.float64], radius: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        """Which of the `points` [m], [N, 3], with `radius` [m], [N], lie in something.

        The base's middle is at `base` [m], [N, 2].
        """
        x, y = np.floor((points[:, :2] - self._origin) / self._stage.seen.cell).astype(int).T
        within = (x >= 0) & (y >= 0) & (x < self._height.shape[1]) & (y < self._height.shape[0])
        height = np.where(within, self._height[np.where(within, y, 0), np.where(within, x, 0)], 0.0)
        beside = np.hypot(*(points[:, :2] - self._place.middle[:2]).T) - self._place.radius
        cone = self._place.bottom + SLOPE * np.maximum(beside, 0.0)
        level = (height < self._place.top + ARM_RADIUS) | (
            beside < ARM_RADIUS
        )  # neither a wall nor the back of a chair
        low = np.where(level, np.minimum(height + ARM_RADIUS, cone), height + ARM_RADIUS)
        own = np.hypot(*(points[:, :2] - base).T) < self._stage.robot.build.radius
        return np.asarray(points[:, 2] < np.where(own, OWN_HEIGHT, low))


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
    return best


def _routes(
    stage: Stage, now: Leg, goal: Leg, back: float, above: NDArray[np.float64] | None, leaving: bool
) -> Iterator[Route]:
    """All routes to `goal`, not yet checked."""
    over = [] if above is None else [Leg(above, 0.0 if leaving else goal.ahead)]
    by = [Leg(posture, ahead) for posture in stage.robot.between for ahead in {0.0, -back / 2, -back}]
    ways = [over, *([*over, b] if leaving else [b, *over] for b in by)]
    if leaving:
        ways += [[], *([b] for b in by)]
    for legs in ways:
        yield _timed(stage, now, (*legs, goal))


def _timed(stage: Stage, now: Leg, legs: tuple[Leg, ...]) -> Route:
    build = stage.robot.build
    frames = sum(
        max(float(np.abs(b.arm - a.arm).max()) / build.arm_step, abs(b.ahead - a.ahead) / build.forward_step)
        for a, b in itertools.pairwise([now, *legs])
    )
    return Route(legs, frames, 0)
