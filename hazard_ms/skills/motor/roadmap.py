"""A roadmap of the arm: postures before the robot, and which of them lie near one another.

It is the same wherever the robot stands (a probabilistic roadmap: Kavraki et al., IEEE Trans. Robotics and Automation
12(4), 1996). What lies in the way is looked up for all its lines at once, and the quickest path over it is found by
Dijkstra's algorithm. Postures are drawn among mixtures of those that the robot names, from a fixed seed.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from hazard_ms.simulation.robot import Robot

POSTURES = 500  # that are drawn [ours]
NEIGHBOURS = 8  # nearest postures to which each has a line [ours]
ENDS = 12  # nearest postures to which the start and the goal of a path have one [ours]
NOISE = 0.35  # standard deviation of each joint about a mixture of named postures [rad] [ours]
MIXING = 0.4  # of the Dirichlet distribution of the shares in a mixture: mostly two or three count [-] [ours]
SEED = 0  # of the postures [ours]
SPACING = 0.25  # greatest turn of a joint between two postures that are checked on a line [rad] [ours]

Postures = NDArray[np.float64]  # [..., J] [rad]
# How many of the P points along the arm lie in something, [N], for places in the base's frame [m], [N, P, 3]
Touched = Callable[[NDArray[np.float64]], NDArray[np.int64]]


class Roadmap:
    """Postures and lines between them for one hand of a robot, with the places of its arm along these lines."""

    def __init__(self, robot: Robot) -> None:
        self.postures = _drawn(robot)
        gap = np.abs(self.postures[:, None] - self.postures).max(axis=-1)
        np.fill_diagonal(gap, np.inf)
        near = np.argsort(gap, axis=1, kind="stable")[:, :NEIGHBOURS]
        ends = np.stack([np.repeat(np.arange(len(near)), NEIGHBOURS), near.ravel()], axis=1)
        self.lines = np.unique(np.sort(ends, axis=1), axis=0)  # [L, 2]
        first, last = self.postures[self.lines[:, 0]], self.postures[self.lines[:, 1]]
        self.lengths = np.abs(last - first).max(axis=1)  # largest turn of a joint [rad], [L]
        self._places, self._owner = _along(robot, first, last)

    def touching(self, touched: Touched) -> NDArray[np.float64]:
        """The number of checked points along each line that lie in something, [L]."""
        return np.bincount(self._owner, touched(self._places), len(self.lines)).astype(np.float64)


class Paths:
    """The quickest paths from one posture to all postures of a roadmap, by frames and by what they touch."""

    def __init__(self, robot: Robot, start: Postures, touched: Touched, cost: float) -> None:
        """Find the paths from `start`, [J]; `cost`: what a point that touches counts as much as [frames]."""
        self._robot, self._touched, self._cost = robot, touched, cost
        self._made = made = roadmap(robot)
        count = len(made.postures)
        near, ends = self._ends(start)
        rows = np.concatenate([made.lines[:, 0], np.full(len(near), count)])
        columns = np.concatenate([made.lines[:, 1], near])
        frames = np.concatenate([self._frames(made.lengths, made.touching(touched)), ends])
        graph = csr_matrix((frames, (rows, columns)), (count + 1, count + 1))
        self._far, self._back = dijkstra(graph, directed=False, indices=count, return_predecessors=True)

    def _frames(self, lengths: NDArray[np.float64], touching: NDArray[np.float64]) -> NDArray[np.float64]:
        least = 1e-6  # a line between equal postures is a line, too [frames]
        return np.asarray(np.maximum(lengths / self._robot.build.arm_step + self._cost * touching, least))

    def _ends(self, posture: Postures) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """The numbers of the ENDS postures nearest to any `posture`, and the frames that lines to them take."""
        gap = np.abs(self._made.postures - posture).max(axis=1)
        near = np.argsort(gap, kind="stable")[:ENDS]
        first = np.broadcast_to(posture, (len(near), len(posture)))
        places, owner = _along(self._robot, first, self._made.postures[near])
        touching = np.bincount(owner, self._touched(places), len(near)).astype(np.float64)
        return near, self._frames(gap[near], touching)

    def to(self, goal: Postures) -> list[Postures]:
        """The postures between the start and the `goal`, [J], both left out."""
        near, frames = self._ends(goal)
        at, start = int(near[np.argmin(self._far[near] + frames)]), len(self._made.postures)
        found = []
        while at != start and at >= 0:  # below 0: there is no way to it
            found.append(self._made.postures[at])
            at = int(self._back[at])
        return found[::-1] if at == start else []


_made: dict[tuple[type, bool], Roadmap] = {}  # by kind of robot and side of the hand


def roadmap(robot: Robot) -> Roadmap:
    """The roadmap for the hand in use, which is made once in a process for every kind of robot and every hand."""
    hand = robot.arm_places(robot.tucked, resting=True)[-1]
    key = (type(robot), bool(hand[1] > 0.0))
    if key not in _made:
        _made[key] = Roadmap(robot)
    return _made[key]


def _drawn(robot: Robot) -> Postures:
    """The postures of a roadmap: those that the robot names, and mixtures of them, [N, J] [rad]."""
    rng = np.random.default_rng(SEED)
    named = np.array([robot.tucked, *robot.between, *robot.outstretched])
    shares = rng.dirichlet(np.full(len(named), MIXING), POSTURES)
    drawn = shares @ named + rng.normal(0.0, NOISE, (POSTURES, named.shape[1]))
    return np.clip(np.vstack([named, drawn]), robot.arm_limits[:, 0], robot.arm_limits[:, 1])


def _along(robot: Robot, first: Postures, last: Postures) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Places of the arm along lines from `first` to `last`, [L, J] [rad], and the number of the line of each.

    Places are [C, P, 3] [m], in the base's frame.
    """
    steps = np.maximum(1, np.ceil(np.abs(last - first).max(axis=1) / SPACING)).astype(np.int64)
    owner = np.repeat(np.arange(len(steps)), steps)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(steps) - steps, steps)
    share = (number + 0.5) / steps[owner]
    arms = first[owner] + share[:, None] * (last - first)[owner]
    return robot.arm_places(arms, resting=True), owner
