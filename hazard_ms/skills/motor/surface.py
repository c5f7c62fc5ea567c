"""The heights that the arm keeps above, as the map has them, and which points of its routes lie below them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from hazard_ms.skills.context import Stage
from hazard_ms.skills.motor.motion import turned
from hazard_ms.skills.motor.roadmap import Paths
from hazard_ms.skills.motor.touching import Counter, ground

NEARLY = 0.5  # a posture on the way is passed when every joint is this close [rad] [ours]
SPACING = 0.15  # greatest turn of a joint between two postures that are checked [rad] [ours]
ARM_RADIUS = 0.06  # distance that the middle of the arm keeps above things; Fetch's upper arm is 0.12 m thick [m]
BETWEEN = (0.0, 0.33, 0.67)  # points of each link that are checked, as shares of its length [-] [ours]
OWN_HEIGHT = 0.3  # the arm keeps above this over its own base [m] [ours]
WINDOW = 2.0  # distance from the base within which the map is looked at [m] [ours]
COVER = (
    0.15  # distance from the middle of a thing within which most of the map is higher than what covers it [m] [ours]
)
DEEPEST = 0.7  # greatest distance from a thing in furniture to the floor before that [m] [ours]
OPENING = 0.1  # room beside a thing in furniture that its opening leaves for the middle of the arm [m] [ours]
OVERHEAD = 0.05  # room above it that it leaves [m] [ours]
HEADROOM = 0.16  # and above the board that it stands on: boards are 0.22 m apart, or farther [m] [ours]
OTHERS_TOP = 1.2  # height of other robots; Fetch is 1.1 m high, the G1 1.3 [m] [ours]
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
        self.turn = turn
        self._x, self._y, heading = stage.robot.base()
        if at is not None:
            self._x, self._y = at.tolist()
        self._ahead = np.array([np.cos(heading + turn), np.sin(heading + turn)])
        self._origin, self._height = self._window()
        self.out, self._depth = self._opening()
        self._counter = Counter(self._around(), BETWEEN, np.ascontiguousarray(self._height))
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
        corner = seen.origin + seen.cell * np.array([low_x, low_y])
        for disc in self._stage.discs():  # of other robots: arms go round them
            height = np.where(self._stage.covered(disc, height.shape, corner), np.float32(OTHERS_TOP), height)
        return corner, height

    def _around(self) -> Any:
        """What arms keep above, for the kernel that counts what touches."""
        place = self.place
        return ground(
            x=self._x,
            y=self._y,
            ahead_x=float(self._ahead[0]),
            ahead_y=float(self._ahead[1]),
            radius=self._stage.robot.build.radius,
            own=OWN_HEIGHT,
            west=float(self._origin[0]),
            south=float(self._origin[1]),
            cell=self._stage.seen.cell,
            gap=ARM_RADIUS,
            place_x=float(place.middle[0]),
            place_y=float(place.middle[1]),
            place_radius=place.radius,
            bottom=place.bottom,
            slope=SLOPE,
            top=place.top + ARM_RADIUS,
            out_x=float(self.out[0]),
            out_y=float(self.out[1]),
            depth=self._depth,
            half_width=place.radius + OPENING,
            roof=max(place.top + OVERHEAD, place.bottom + HEADROOM),
        )

    @property
    def outward(self) -> NDArray[np.float64]:
        """The direction, [3], out of the furniture around the place, as it is to a base that did not turn; 0: open."""
        return turned(np.array([*self.out, 0.0]), (0.0, 0.0), -self.turn)

    @property
    def inward(self) -> NDArray[np.float64] | None:
        """The direction, [2], into that furniture, as it is to a base that did not turn; None where there is none."""
        return -self.outward[:2] if self.out.any() else None

    def _opening(self) -> tuple[NDArray[np.float64], float]:
        """The direction, [2], from the place to where the furniture around it is open, and how far it reaches [m].

        The map has one height for each cell: that of a shelf's top board. What lies below it was seen, so the shelf is
        open, and most likely so towards the nearest low floor. The distance is 0 for a place in the open.
        """
        middle, cell = self.place.middle[:2], self._stage.seen.cell
        rows, columns = np.indices(self._height.shape)
        away = self._origin + (np.stack([columns, rows], -1) + 0.5) * cell - middle
        far = np.hypot(*np.moveaxis(away, -1, 0))
        around = self._height[far < COVER]
        low = (self._height < self.place.bottom - ARM_RADIUS) & (far < DEEPEST)
        if not len(around) or np.median(around) <= self.place.top + ARM_RADIUS or not low.any():
            return np.zeros(2), 0.0
        nearest = float(far[low].min())
        out = away[low & (far <= nearest + cell / 2)].mean(axis=0)
        return np.asarray(out / max(float(np.hypot(*out)), 1e-9)), nearest + cell

    def hits(self, legs: Sequence[Leg], enough: float = np.inf) -> int:
        """The number of checked points of a route over `legs`, the first of which is its start, that lie in something.

        It stops counting between legs where there are `enough`.
        """
        pieces, start = [], legs[0]
        for end in legs[1:]:
            pieces.append((start, end))
            share = max(0.0, 1.0 - end.near / max(float(np.abs(end.arm - start.arm).max()), 1e-9))
            start = Leg(start.arm + share * (end.arm - start.arm), end.ahead)  # where the next leg begins
        count = 0
        for found in self._hits(pieces):
            count += found
            if count >= enough:
                break
        return count

    def _hits(self, pieces: Sequence[tuple[Leg, Leg]]) -> list[int]:
        """The number of points that lie in something along each of the legs between a start and an end."""
        keys = [(start.ahead, start.arm.tobytes(), end.ahead, end.arm.tobytes()) for start, end in pieces]
        new = {key: piece for key, piece in zip(keys, pieces, strict=True) if key not in self._known}
        if new:
            arms, ahead, owner = [], [], []
            for number, (start, end) in enumerate(new.values()):
                steps = max(1, int(np.ceil(np.abs(end.arm - start.arm).max() / SPACING)))
                shares = np.arange(1, steps + 1) / steps
                arms.append(start.arm + shares[:, None] * (end.arm - start.arm))
                ahead.append(start.ahead + shares * (end.ahead - start.ahead))
                owner += [number] * steps
            places = self._stage.robot.arm_places(np.concatenate(arms), resting=True)
            counts = np.bincount(owner, self._counter.touched(places, np.concatenate(ahead)))
            self._known.update(zip(new, map(int, counts), strict=True))
        return [self._known[key] for key in keys]

    def paths(self, start: NDArray[np.float64], ahead: float, cost: float) -> Paths:
        """The quickest paths over the roadmap from joints `start` [rad], [Joints], with the base `ahead` [m] of here.

        `cost`: what a checked point that lies in something counts as much as [frames].
        """
        key = (ahead, start.tobytes())
        if key not in self._paths:

            def touched(places: NDArray[np.float64]) -> NDArray[np.int64]:
                return self._counter.touched(places, np.full(len(places), ahead))

            self._paths[key] = Paths(self._stage.robot, start, touched, cost)
        return self._paths[key]
