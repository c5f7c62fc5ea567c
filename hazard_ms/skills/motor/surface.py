"""The heights that the arm keeps above, as the map has them, and which points of its routes lie below them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from hazard_ms.skills.context import Stage
from hazard_ms.skills.motor.roadmap import Paths

NEARLY = 0.5  # a posture on the way is passed when every joint is this close [rad] [ours]
SPACING = 0.15  # greatest turn of a joint between two postures that are checked [rad] [ours]
ARM_RADIUS = 0.06  # distance that the middle of the arm keeps above things; Fetch's upper arm is 0.12 m thick [m]
HAND_RADIUS = 0.1  # and that the middle of the hand keeps; the G1's palm and thumb need most [m] [ours]
BETWEEN = (0.0, 0.33, 0.67)  # points of each link that are checked, as shares of its length [-] [ours]
OWN_HEIGHT = 0.3  # the arm keeps above this over its own base [m] [ours]
WINDOW = 2.0  # distance from the base within which the map is looked at [m] [ours]
SLOPE = 0.7  # of the cone around the thing within which the hand comes down to what it stands on [-] [ours]


@dataclass(frozen=True)
class Leg:
    """A straight part of a route: to the joints `arm` [rad], [J], with the base `ahead` [m] of the route's start."""

    arm: NDArray[np.float64]
    ahead: float
    near: float = NEARLY  # it is passed when every joint is this close [rad]


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

    def __init__(self, stage: Stage, place: Place, turn: float = 0.0, at: NDArray[np.float64] | None = None) -> None:
        """Take the map of `stage` as it is; around `place` the hand may come down.

        The base is taken to have turned by `turn` [rad], anticlockwise, from where it is, and to stand `at` [m], [2],
        world frame; None: where it is.
        """
        self._stage = stage
        self.place = place
        self._x, self._y, heading = stage.robot.base()
        if at is not None:
            self._x, self._y = at.tolist()
        self._ahead = np.array([np.cos(heading + turn), np.sin(heading + turn)])
        self._origin, self._height = self._window()
        self._paths: dict[tuple[float, bytes], Paths] = {}
        self._known: dict[tuple[float, bytes, float, bytes], int] = {}  # hits of legs that were checked before

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
            share = max(0.0, 1.0 - end.near / max(float(np.abs(end.arm - start.arm).max()), 1e-9))
            start = Leg(start.arm + share * (end.arm - start.arm), end.ahead)  # where the next leg begins
        return count

    def _hits(self, start: Leg, end: Leg) -> int:
        key = (start.ahead, start.arm.tobytes(), end.ahead, end.arm.tobytes())
        if key not in self._known:
            steps = max(1, int(np.ceil(np.abs(end.arm - start.arm).max() / SPACING)))
            shares = np.arange(1, steps + 1) / steps
            arms = start.arm + shares[:, None] * (end.arm - start.arm)
            places = self._stage.robot.arm_places(arms, resting=True)
            self._known[key] = int(self._touching(places, start.ahead + shares * (end.ahead - start.ahead)).sum())
        return self._known[key]

    def paths(self, start: NDArray[np.float64], ahead: float, cost: float) -> Paths:
        """The quickest paths over the roadmap from joints `start` [rad], [Joints], with the base `ahead` [m] of here.

        `cost`: what a checked point that lies in something counts as much as [frames].
        """
        key = (ahead, start.tobytes())
        if key not in self._paths:

            def touched(places: NDArray[np.float64]) -> NDArray[np.int64]:
                return self._touching(places, np.full(len(places), ahead))

            self._paths[key] = Paths(self._stage.robot, start, touched, cost)
        return self._paths[key]

    def _touching(self, places: NDArray[np.float64], ahead: NDArray[np.float64]) -> NDArray[np.int64]:
        """How many points along each arm lie in something, [N].

        Joints are at `places` [m], [N, P, 3], in the frame of the base, which is `ahead` [m], [N], of where it is.
        """
        points = _dense(places)
        count, along = points.shape[:2]
        middle = np.array([self._x, self._y]) + ahead[:, None] * self._ahead
        points[..., :2] = points[..., :2] @ np.array([self._ahead, [-self._ahead[1], self._ahead[0]]])
        points[..., :2] += middle[:, None]
        inside = self._inside(points.reshape(-1, 3), np.repeat(middle, along, axis=0), np.tile(_radii(along), count))
        return np.asarray(inside.reshape(count, along).sum(axis=1))

    def _inside(
        self, points: NDArray[np.float64], base: NDArray[np.float64], radius: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        """Which of the `points` [m], [N, 3], with `radius` [m], [N], lie in something.

        The base's middle is at `base` [m], [N, 2].
        """
        x, y = np.floor((points[:, :2] - self._origin) / self._stage.seen.cell).astype(int).T
        within = (x >= 0) & (y >= 0) & (x < self._height.shape[1]) & (y < self._height.shape[0])
        height = np.where(within, self._height[np.where(within, y, 0), np.where(within, x, 0)], 0.0)
        beside = np.hypot(*(points[:, :2] - self.place.middle[:2]).T) - self.place.radius
        cone = self.place.bottom + SLOPE * np.maximum(beside, 0.0)
        level = (height < self.place.top + ARM_RADIUS) | (beside < ARM_RADIUS)  # neither a wall nor the back of a chair
        low = np.where(level, np.minimum(height + ARM_RADIUS, cone), height + ARM_RADIUS)
        own = np.hypot(*(points[:, :2] - base).T) < self._stage.robot.build.radius
        return np.asarray(points[:, 2] < np.where(own, OWN_HEIGHT, low))


def _dense(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """The points that are checked, [N, Q, 3], along arms whose joints are at `places`, [N, P, 3]; the hand is last."""
    along = places[:, 1:] - places[:, :-1]
    links = [places[:, :-1] + b * along for b in BETWEEN]
    return np.concatenate([*links, places[:, -1:]], axis=1)


def _radii(count: int) -> NDArray[np.float64]:
    """How far each of `count` checked points keeps from things [m], [Q]."""
    return np.append(np.full(count - 1, ARM_RADIUS), HAND_RADIUS)
