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
TOUCHING = 0.05  # gap after a physics step beyond which two links cannot have pushed each other in it: PhysX pushes
# within twice ManiSkill's contact_offset of 0.02 m, and two links part by less in a step [m]
LONGEST = 1.5  # from an axis of a robot to its farthest point: longer than any arm, which is half of NEAR [m] [ours]
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
        turning = [[joint.type[0].startswith("revolute") for joint in robot.robot.active_joints] for robot in robots]
        self._sweeps = [np.where(row, LONGEST, 1.0) for row in turning]  # of a link, per motion of a joint [m/rad] or 1
        self._room, self._then = -np.inf, self._joints()  # least gap when it was looked at last, and where joints were
        self.record = Encounters.allocate({"E": 1, "P": len(self._pairs)}, "cpu")

    def _joints(self) -> list[NDArray[np.float32]]:
        """Positions of all joints of each robot [rad] or [m], [J]."""
        return [robot.robot._objs[0].qpos.copy() for robot in self._robots]

    def begin(self) -> None:
        """Note the speeds of the links that others may touch in the frame; call it before the physics of a frame."""
        self._fast: dict[tuple[int, int], bool] = {}  # pairs that push each other in this frame, and whether fast
        self._close: list[list[list[Any]]] = []  # links of one robot and of another, some of which are close
        self._speeds: dict[Any, NDArray[np.float32]] = {}
        now = self._joints()
        moved = sorted(float(w @ np.abs(a - b)) for w, a, b in zip(self._sweeps, now, self._then, strict=True))
        if self._room - moved[-1] - moved[-2] < MARGIN:
            self._then, self._room = now, self._look_at_gaps()
            self._speeds = {k: k.linear_velocity.copy() for sides in self._close for links in sides for k in links}

    def _look_at_gaps(self) -> float:
        """Find the links that are close, of all robots; returns the least gap between two robots, or less [m]."""
        places = [np.array(robot.base()[:2]) for robot in self._robots]
        apart = {p: float(np.hypot(*(places[p[0]] - places[p[1]]))) for p in self._pairs}
        near = [p for p in self._pairs if apart[p] < NEAR]
        room = min((apart[p] - NEAR + MARGIN for p in self._pairs if p not in near), default=np.inf)
        boxes = {k: _boxes(self._links[k]) for k in {k for pair in near for k in pair}}
        discs = {k: self._discs(k, boxes[k]) for k in boxes}
        for one, other in near:
            gaps = np.maximum(_gaps(boxes[one], boxes[other]), _aside(discs[one], discs[other]))
            room, close = min(room, float(gaps.min())), gaps < MARGIN
            if close.any():
                sides = ((one, close.any(1)), (other, close.any(0)))
                self._close.append([[self._links[k][n] for n in np.flatnonzero(some)] for k, some in sides])
        return room

    def _discs(self, number: int, boxes: NDArray[np.float64]) -> NDArray[np.float64]:
        """Middles x, y and radii of upright cylinders round the links of a robot in their `boxes`, [3, L] [m]."""
        low, high = boxes[:, :2]
        discs = np.vstack([(low + high) / 2, np.hypot(*(high - low))[None] / 2])
        robot, base = self._robots[number], self._robots[number].base_body()
        if base in self._links[number]:  # which is round
            discs[:, self._links[number].index(base)] = *robot.base()[:2], robot.build.radius
        return discs

    def look(self) -> None:
        """Look at the contacts; call it after each physics step."""
        if not any((_gaps(*map(_boxes, sides)) < TOUCHING).any() for sides in self._close):
            return
        for contact in self._px.get_contacts():
            first, second = contact.bodies
            if first not in self._speeds or second not in self._speeds:
                continue
            one, other = self._owner[first], self._owner[second]
            if one != other and any(np.any(point.impulse) for point in contact.points):
                speed = float(np.linalg.norm(self._speeds[first] - self._speeds[second]))
                pair = (min(one, other), max(one, other))
                self._fast[pair] = self._fast.get(pair, False) or speed > FAST

    def end(self) -> None:
        """Count the collisions that began in this frame."""
        since = self.record.since
        since.add_(1).clamp_(max=LONG_AGO)
        for number, pair in enumerate(self._pairs):
            if pair not in self._fast:
                continue
            again = int(since[0, number]) <= self._gap
            if self._fast[pair] and not again:
                self.record.count += 1
            if self._fast[pair] or again:
                since[0, number] = 0


def _boxes(links: Sequence[Any]) -> NDArray[np.float64]:
    """The lower and upper corners of the boxes round `links`, [2, 3, L] [m]."""
    return np.array([link.get_global_aabb_fast() for link in links], np.float64).transpose(1, 2, 0)


def _gaps(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Gaps between boxes `one`, [2, 3, L], and `other`, [2, 3, M], along any axis [m], [L, M]; below 0 they overlap."""
    below, above = one[0, :, :, None] - other[1, :, None], other[0, :, None] - one[1, :, :, None]
    gaps: NDArray[np.float64] = np.maximum(below, above).max(0)
    return gaps


def _aside(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Gaps between upright cylinders `one`, [3, L], and `other`, [3, M] [m], [L, M]; below 0: they overlap."""
    x, y, radius = (a[:, None] + sign * b for a, b, sign in zip(one, other, (-1.0, -1.0, 1.0), strict=True))
    gaps: NDArray[np.float64] = np.hypot(x, y) - radius
    return gaps
