"""Beliefs about things that were seen: where they drift, how high the water will stand, when they come to harm.

A belief rests on sightings alone. Frames count from the start of the episode.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
POSITION_ERROR = 0.15  # by which a thing at rest seems to move between two sightings [m] [ours]
FEWEST_FRAMES = 15  # between two sightings that tell a speed [ours]
SPEEDING = 1.5  # a thing is not believed to move faster than this many times the fastest that was seen [ours]
LONGEST_DRIFT = 200.0  # frames for which a thing is believed to go on drifting: by then it meets a wall [ours]
RISE = 0.001  # rise of the water that is believed before it was seen to rise [m/frame] (docs/physics.md 1.2)
CAP = 1.5  # highest level of the water [m] (docs/physics.md 1.2)
LEVEL_ERROR = 0.02  # of a level that was seen [m] [ours: it was seen somewhere on the thing]
DOUBTS = (0.1, 0.05, 0.0005)  # of the belief before any sighting: level [m], slope [-], rise [m/frame] [ours]


def drifted(frames: ArrayLike, places: ArrayLike, fastest: float, at: float) -> Array:
    """The place [m], [2], where a thing is believed to be at the frame `at`: on the line through its last sightings.

    It was seen at `places` [m], [S, 2], at increasing `frames`, [S], S > 0. `fastest`: the greatest speed that anything
    was seen to have [m/frame].
    """
    times, seen = np.asarray(frames, np.float64), np.asarray(places, np.float64)
    velocity = speed_of(times, seen)
    speed = float(np.hypot(*velocity))
    if speed > SPEEDING * fastest:
        velocity = velocity * (SPEEDING * fastest / speed)
    return seen[-1] + velocity * min(max(at - times[-1], 0.0), LONGEST_DRIFT)


def speed_of(frames: ArrayLike, places: ArrayLike) -> Array:
    """The velocity [m/frame], [2], of a thing that was seen at `places` [m], [S, 2], at increasing `frames`, [S].

    It is zero where the last sightings show none, or no more than their error.
    """
    times, seen = np.asarray(frames, np.float64), np.asarray(places, np.float64)
    earlier = np.flatnonzero(times <= times[-1] - FEWEST_FRAMES)
    if not len(earlier):
        return np.zeros(2)
    moved = seen[-1] - seen[earlier[-1]]
    return moved / (times[-1] - times[earlier[-1]]) if np.hypot(*moved) > POSITION_ERROR else np.zeros(2)


@dataclass(frozen=True)
class WaterPlane:
    """A surface of water that is plane and rises evenly, up to CAP."""

    level: float  # at the origin at frame 0 [m]; it may lie below the floor
    slope: tuple[float, float]  # along x and y [-]
    rise: float  # [m/frame]

    @classmethod
    def fitted(cls, points: ArrayLike, frames: ArrayLike, levels: ArrayLike) -> WaterPlane:
        """The plane of the least squared errors through `levels` [m], [S], at `points` [m], [S, 2], and `frames`, [S].

        Points that were dry have the level 0 and say nothing. What few sightings leave open stays as it was believed to
        be before any: a level surface that rises by RISE from nothing.
        """
        where, heights = np.asarray(points, np.float64).reshape(-1, 2), np.asarray(levels, np.float64)
        wet = heights > 0.0
        at = np.asarray(frames, np.float64)[wet]
        rows = np.column_stack([np.ones(wet.sum()), where[wet], at]) / LEVEL_ERROR
        level_doubt, slope_doubt, rise_doubt = DOUBTS
        doubts = np.diag([1 / level_doubt, 1 / slope_doubt, 1 / slope_doubt, 1 / rise_doubt])
        believed = np.array([0.0, 0.0, 0.0, RISE])
        sides = np.concatenate([heights[wet] / LEVEL_ERROR, doubts @ believed])
        level, x, y, rise = np.linalg.lstsq(np.vstack([rows, doubts]), sides, rcond=None)[0].tolist()
        return cls(level, (x, y), max(rise, 0.0))

    def at(self, points: ArrayLike, frames: ArrayLike) -> Array:
        """Levels [m], [K, M], at M `points` [m], [M, 2], at K `frames`, [K]; 0 where it is dry."""
        tilt = np.asarray(points, np.float64).reshape(-1, 2) @ np.asarray(self.slope)
        rising = self.level + self.rise * np.asarray(frames, np.float64)
        return np.clip(rising[:, None] + tilt, 0.0, CAP)


def extended(frames: ArrayLike, levels: ArrayLike, at: ArrayLike) -> Array:
    """Levels, [K], at the frames `at`, [K], on the straight line through the last two `levels`, [S], seen at `frames`.

    A single level is believed to stay. Levels are in the unit of their hazard.
    """
    times, seen, later = (np.asarray(values, np.float64) for values in (frames, levels, at))
    earlier = np.flatnonzero(times < times[-1])
    if not len(earlier):
        return np.full(len(later), seen[-1])
    before = earlier[-1]
    return seen[-1] + (seen[-1] - seen[before]) / (times[-1] - times[before]) * (later - times[-1])


def last_whole(harms: Callable[[float], bool], frames: ArrayLike, levels: ArrayLike) -> float:
    """The last of `frames`, [F], before the first one at whose level, of `levels`, [F], a thing comes to harm.

    It is 0 if that is the first of all, and inf if there is none. Levels are in the unit of their hazard.
    """
    times = np.asarray(frames, np.float64)
    for number, level in enumerate(np.asarray(levels, np.float64).tolist()):
        if harms(level):
            return float(times[number - 1]) if number else 0.0
    return float("inf")
