"""Shortest ways from everywhere to one goal, over a grid of costs, with their lengths and corners.

The cheapest path of every cell is that of Dijkstra over eight neighbours, as in `hazard_ms.skills.motor.navigation`.
It is straightened from the goal outwards: a cell goes straight to the corner that the next cell of its path goes to,
where that costs no more and crosses no dearer cell than the path does, and else to that next cell. Lengths are
therefore those of the straight pieces that a robot drives, not of the steps over the grid, up to 8 % longer.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import csgraph

from hazard_ms.simulation.kernels.launch import Launches
from hazard_ms.sketch.travel import straightening
from hazard_ms.skills.motor.motion import ALONG
from hazard_ms.skills.motor.navigation import AT_MOST, OBSTACLE_COST, SHORT

Array = NDArray[np.float64]
NEARLY_NOTHING = 1e-9  # cost of ending at the goal: a graph drops edges that cost nothing
ROUNDING = 1e-6  # by which costs of equal ways differ

_launches = Launches()


class Field(NamedTuple):
    """The ways of all N cells to one goal."""

    corner: NDArray[np.int32]  # the cell to which the way of a cell first leads, [N]; itself where it ends
    end: NDArray[np.int32]  # the cell where the way ends, [N]
    rest: NDArray[np.float32]  # length of the way from the cell [m], [N]; inf: no way
    turned: NDArray[np.float32]  # sum of the turns on the spot at its corners and, to face the goal, its end [rad], [N]


def wrapped(angle: Array) -> Array:
    """Angles [rad], [...], brought into -pi to pi."""
    return np.remainder(angle + np.pi, 2 * np.pi) - np.pi


def on_the_spot(angle: Array) -> Array:
    """The part of turns by `angle` [rad], [...], for which a driving robot stops: it stops until it is off by ALONG."""
    return np.maximum(np.abs(wrapped(angle)) - ALONG, 0.0)


def direction(start: Array, end: Array) -> Array:
    """Headings from `start` to `end` [m], [..., 2]: anticlockwise from +x [rad], [...]."""
    off = end - start
    return np.arctan2(off[..., 1], off[..., 0])


def fields(
    cost: Array, graph: sparse.csr_matrix, centres: Array, cell: float, goals: Array, near: Array
) -> list[Field]:
    """The fields of G `goals` [m], [G, 2], at which a way ends within `near` [m], [G], or up to AT_MOST short of that.

    `cost` [Y, X] of the cells and the `graph` of steps between them are those of `navigation.known_floor`; `centres`
    [m], [N, 2], of all cells; `cell`: their edge [m].
    """
    spent, before = _search(cost.ravel(), graph, centres, goals, near)
    reached = (spent < OBSTACLE_COST * cell / 2) & (cost.ravel() < OBSTACLE_COST)
    return [
        straightened(cost, spent_on_it / cell, centres, np.where(found, chain, -1), np.asarray(goal), far)
        for found, spent_on_it, chain, goal, far in zip(reached, spent, before, goals, near, strict=True)
    ]


def _search(
    cost: Array, graph: sparse.csr_matrix, centres: Array, goals: Array, near: Array
) -> tuple[Array, NDArray[np.int32]]:
    """Cheapest costs from all cells to each goal, [G, N], and the next cell on the way there, itself at its end."""
    count = len(cost)
    far = np.hypot(*np.moveaxis(centres - goals[:, None], -1, 0))
    short = np.maximum(far - near[:, None], 0.0)
    ends = [np.flatnonzero((left <= AT_MOST) & (cost < OBSTACLE_COST)) for left in short]
    missed = [left[end] for left, end in zip(short, ends, strict=True)]
    starts = np.cumsum([0, *(len(e) for e in ends)])
    whole = sparse.csr_matrix(
        (
            np.concatenate([graph.data, *(SHORT * m + NEARLY_NOTHING for m in missed)]),
            np.concatenate([graph.indices, *ends]),
            np.concatenate([graph.indptr, graph.indptr[-1] + starts[1:]]),
        ),
        shape=(count + len(goals),) * 2,
    )
    roots = count + np.arange(len(goals))
    spent, before = csgraph.dijkstra(whole, indices=roots, return_predecessors=True)
    here = np.arange(count)
    return spent[:, :count], np.where(before[:, :count] == roots[:, None], here, before[:, :count])


def straightened(
    cost: Array, spent: Array, centres: Array, before: NDArray[np.int32], goal: Array, near: float
) -> Field:
    """The field of one goal; `before` [N]: the next cell of each, itself where its way ends, -1 without a way.

    `cost` [Y, X] of the cells; `spent` [N]: costs of the ways from the cells, in cells.
    """
    flat, width = np.ascontiguousarray(cost.ravel()), cost.shape[1]
    rows, depths = _by_depth(before)
    before = before.astype(np.int32)
    dearest, corner, end = flat.copy(), before.copy(), before.copy()
    known = (flat, np.ascontiguousarray(spent), before, rows, depths)
    made = (torch.from_numpy(part) for part in (*known, dearest, corner, end))
    _launches.run(straightening.choose, (1,), width, ROUNDING, *made)

    chosen, own = corner[rows], np.zeros((2, len(before)))
    last = chosen == end[chosen]
    own[0, rows] = leg(centres[rows], centres[chosen], last, goal, near)
    onward = np.where(last[:, None], goal, centres[corner[chosen]])
    turn = wrapped(direction(centres[chosen], onward) - direction(centres[rows], centres[chosen]))
    own[1, rows] = np.where(last, np.abs(turn), on_the_spot(turn))
    rest = np.where(before >= 0, 0.0, np.inf).astype(np.float32)
    turned = np.zeros_like(rest)
    for part, total in zip(own, (rest, turned), strict=True):
        _launches.run(straightening.add_up, (1,), *map(torch.from_numpy, (rows, corner, part, total)))
    return Field(corner, end, rest, turned)


def leg(start: Array, corner: Array, last: NDArray[np.bool_], goal: Array, near: Array | float) -> Array:
    """Lengths [m], [...], of the straight pieces from `start` to `corner` [m], [..., 2].

    The `last` piece, bool [...], ends where it is within `near` [m] of the `goal` [m], [..., 2], which the middle of a
    cell only approaches.
    """
    whole = np.hypot(*np.moveaxis(corner - start, -1, 0))
    to_goal = np.hypot(*np.moveaxis(goal - start, -1, 0)) - near
    arrives = last & (np.hypot(*np.moveaxis(goal - corner, -1, 0)) <= near)
    return np.where(arrives, np.maximum(to_goal, 0.0), whole)


def _by_depth(before: NDArray[np.int32]) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """The cells that have a way and are not its end, by their number of steps to the end, and where each begins."""
    here = np.arange(len(before))
    jump = np.where(before >= 0, before, here)
    depth = (jump != here).astype(np.int64)
    while (jump[jump] != jump).any():
        depth += depth[jump]
        jump = jump[jump]
    starts = np.cumsum(np.bincount(depth))
    return np.argsort(depth, kind="stable")[starts[0] :].astype(np.int32), (starts - starts[0]).astype(np.int32)
