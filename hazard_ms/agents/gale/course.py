"""The course of a gale as somebody knows or believes it, and the pressure that it puts on things at places.

The law is that of `hazard_ms.hazards.wind.gale`: three steady winds, each with its lee, whose forces are averaged with
shares that follow from the time since the front. A thing at rest stays if the wind pushes it less than friction holds
it, so a place keeps it if the greatest pressure there until the end is below what the thing withstands. Pressures are
squares of wind speeds [m^2/s^2]: what they are multiplied with, density and area, belongs to the thing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.hazards.wind.air import CELL, LOWEST

Array = NDArray[np.float64]
STEP = 1.0  # time between the moments at which a course is looked at [s] [ours]
KEEPS = 0.85  # share of what a thing withstands up to which it counts as kept: wakes and postures vary [-] [ours]


@dataclass(frozen=True, eq=False)
class Lees:
    """The lee of each of W winds over Y x X cells of edge CELL."""

    corner: Array  # south-west corner of the cells [m], [2]
    loss: Array  # share of the wind that is lost near the ground, [W, Y, X]
    cause: Array  # height of what takes it [m], [W, Y, X]

    def left(self, points: Array) -> Array:
        """Share of each wind that is left at `points` [m], [P, 3]: [W, P]; all of it outside of the cells."""
        x, y = np.floor((points[:, :2] - self.corner) / float(CELL)).astype(np.int64).T
        inside = (x >= 0) & (y >= 0) & (x < self.loss.shape[2]) & (y < self.loss.shape[1])
        y, x = np.where(inside, y, 0), np.where(inside, x, 0)
        low = np.clip(2.0 - 2.0 * points[:, 2] / np.maximum(self.cause[:, y, x], float(LOWEST)), 0.0, 1.0)
        return 1.0 - np.where(inside, self.loss[:, y, x] * low, 0.0)


@dataclass(frozen=True)
class Front:
    """A gust front, as `hazard_ms.hazards.wind.gale` has it."""

    onset: float  # when it passes the `middle` [s]
    way: tuple[float, float]  # where it moves to, a unit vector
    pace: float  # [m/s]
    middle: tuple[float, float]  # of the scene [m]
    rise: float  # [s]
    turning: float  # [s]

    def shares(self, points: Array, times: Array) -> Array:
        """Shares of the three winds at `points` [m], [P, 2 or 3], at `times` [s], [S]: [S, P, 3], with the sum 1."""
        ahead = (points[:, :2] - self.middle) @ np.array(self.way)
        since = times[:, None] - self.onset - ahead / self.pace
        risen = np.clip(since / self.rise, 0.0, 1.0)
        on = np.clip((since - self.rise) / self.turning, 0.0, 1.0)
        return np.stack([1.0 - risen, risen * (1.0 - on), risen * on], -1)


@dataclass(frozen=True, eq=False)
class Course:
    """The three winds of a gale, their lees, and the front between them."""

    flows: Array  # velocity of each wind in the open [m/s], [3, 2]
    lees: Lees
    front: Front
    end: float  # of the episode [s]

    def pressure(self, points: Array, now: float) -> Array:
        """The greatest pressure [m^2/s^2] at `points` [m], [P, 3], from the time `now` [s] to the end: [P]."""
        times = np.append(np.arange(now, self.end, STEP), max(now, self.end))
        speeds = np.hypot(*self.flows.T)
        pushes = self.lees.left(points).T[..., None] ** 2 * (speeds[:, None] * self.flows)  # [P, 3, 2]
        mean = np.einsum("spk,pkd->spd", self.front.shares(points, times), pushes)
        return np.asarray(np.hypot(mean[..., 0], mean[..., 1]).max(axis=0))


def kept(pressure: Array, withstands: float) -> NDArray[np.bool_]:
    """Whether a thing that withstands so much [m^2/s^2] stays where the wind has these pressures, [P]."""
    return pressure <= KEEPS * withstands
