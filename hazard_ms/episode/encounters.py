"""Collisions of robots with one another, from the contacts that PhysX finds on the CPU.

A collision begins with a frame in which links of two robots push each other that moved at more than FAST relative to
each other when the frame began, unless these two robots pushed each other in the GAP before.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from torch import Tensor

from hazard_ms.hazards.base import State, quantity

FAST = 0.1  # relative speed from which a contact is a collision [m/s] [ours]
GAP = 0.5  # time without contact after which two robots that touch collide anew [s] [ours]
NEAR = 3.0  # distance of two bases from which their arms cannot touch: twice the longest reach, and a bit [m] [ours]
MARGIN = 0.1  # gap between boxes round two links that they do not close in a frame: hands are slower [m] [ours]
LONG_AGO = 1_000_000  # [frames]


@dataclass
class Encounters(State):
    """The collisions of the robots of an episode with one another; P is the number of pairs of robots."""

    count: Tensor = quantity("E", "", "collisions of robots with one another so far", dtype="int")
    since: Tensor = quantity(
        "E P", "frame", "since two robots last pushed each other", dtype="int", fill=LONG_AGO, high=LONG_AGO
    )


class Contacts:
    """Watches the robots of the one environment of a CPU, frame by frame, and keeps their Encounters."""

    def __init__(self, px: Any, robots: Sequence[Any], frames_per_second: int) -> None:
        """Watch `robots`, two or more, in SAPIEN's physics system `px`."""
        self._px, self._robots, self._gap = px, robots, round(GAP * frames_per_second)
        self._pairs = list(itertools.combinations(range(len(robots)), 2))
        every = [[link._objs[0] for link in robot.robot.links] for robot in robots]
        self._links = [[link for link in row if link.collision_shapes] for row in every]
        self._owner = {link: number for number, row in enumerate(self._links) for link in row}
        self.record = Encounters.allocate({"E": 1, "P": len(self._pairs)}, "cpu")

    def begin(self) -> None:
        """Note the speeds of the links of robots that are near one another; call it before the physics of a frame."""
        places = [np.array(robot.base()[:2]) for robot in self._robots]
        self._fast: dict[tuple[int, int], bool] = {}  # pairs that push each other in this frame, and whether fast
        near = [p for p in self._pairs if np.hypot(*(places[p[0]] - places[p[1]])) < NEAR]
        boxes = {k: self._boxes(k) for k in {k for pair in near for k in pair}}
        self._near = {k for p in near if _apart(boxes[p[0]], boxes[p[1]]) < MARGIN for k in p}
        self._speeds = {link: link.linear_velocity.copy() for k in self._near for link in self._links[k]}

    def _boxes(self, number: int) -> NDArray[np.float64]:
        """The lower and upper corners of the boxes round the links of a robot, [L, 2, 3] [m]."""
        return np.array([link.get_global_aabb_fast() for link in self._links[number]], np.float64)

    def look(self) -> None:
        """Look at the contacts; call it after each physics step."""
        if not self._near:
            return
        for contact in self._px.get_contacts():
            first, second = contact.bodies
            one, other = self._owner.get(first), self._owner.get(second)
            if one is None or other is None or one == other or not {one, other} <= self._near:
                continue
            if any(np.any(point.impulse) for point in contact.points):
                speed = float(np.linalg.norm(self._speeds[first] - self._speeds[second]))
                pair = (min(one, other), max(one, other))
                self._fast[pair] = self._fast.get(pair, False) or speed > FAST

    def end(self) -> None:
        """Count the collisions that began in this frame."""
        since = self.record.since
        since.copy_((since + 1).clamp(max=LONG_AGO))
        for number, pair in enumerate(self._pairs):
            if pair not in self._fast:
                continue
            again = int(since[0, number]) <= self._gap
            if self._fast[pair] and not again:
                self.record.count += 1
            if self._fast[pair] or again:
                since[0, number] = 0


def _apart(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """The least gap between boxes `one`, [L, 2, 3], and `other` [m], along any axis; below 0 where two overlap."""
    one, other = one[:, None], other[None]
    return float(np.maximum(one[..., 0, :] - other[..., 1, :], other[..., 0, :] - one[..., 1, :]).max(-1).min())
