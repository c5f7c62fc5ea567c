"""Shortest ways from everywhere to one goal, over a grid of costs, with their lengths and corners.

The cheapest path of every cell is that of Dijkstra over eight neighbours, as in `hazard_ms.skills.motor.navigation`.
It is straightened from the goal outwards: a cell goes straight to the corner that the next cell of its path goes to,
where that costs no more and crosses no dearer cell than the path does, and else to that next cell. Lengths are
therefore those of the straight pieces that a robot drives, not of the steps over the grid, up to 8 % longer.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import csgraph

from hazard_ms.skills.motor.motion import ALONG
from hazard_ms.skills.motor.navigation import AT_MOST, OBSTACLE_COST, SHORT

Array = NDArray[np.float64]
NEARLY_NOTHING = 1e-9  # cost of ending at the goal: a graph drops edges that cost nothing
ROUNDING = 1e-6  # by which costs of equal ways differ


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
        _straightened(cost, spent_on_it / cell, centres, np.where(found, chain, -1), np.asarray(goal), far)
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


def _straightened(
    cost: Array, spent: Array, centres: Array, before: NDArray[np.int32], goal: Array, near: float
) -> Field:
    """The field of one goal; `before` [N]: the next cell of each, itself where its way ends, -1 without a way.

    `spent` [N]: costs of the ways from the cells, in cells.
    """
    corner, end = before.copy(), before.copy()
    rest = np.where(before >= 0, 0.0, np.inf).astype(np.float32)
    turned, dearest, width = np.zeros_like(rest), cost.ravel().copy(), cost.shape[1]
    for row in _by_depth(before):
        following = before[row]
        ahead = corner[following]
        limit = np.maximum(cost.ravel()[row], dearest[following])
        clear = _clear(cost.ravel(), width, row, ahead, limit, spent[row] - spent[ahead])
        chosen = np.where(clear, ahead, following)
        corner[row], end[row] = chosen, end[chosen]
        dearest[row] = np.where(clear, limit, np.maximum(cost.ravel()[row], cost.ravel()[following]))
        rest[row] = rest[chosen] + leg(centres[row], centres[chosen], chosen == end[chosen], goal, near)
        onward = np.where((chosen == end[chosen])[:, None], goal, centres[corner[chosen]])
        turn = wrapped(direction(centres[chosen], onward) - direction(centres[row], centres[chosen]))
        turned[row] = turned[chosen] + np.where(chosen == end[chosen], np.abs(turn), on_the_spot(turn))
    return Field(corner.astype(np.int32), end.astype(np.int32), rest, turned)


def leg(start: Array, corner: Array, last: NDArray[np.bool_], goal: Array, near: Array | float) -> Array:
    """Lengths [m], [...], of the straight pieces from `start` to `corner` [m], [..., 2].

    The `last` piece, bool [...], ends where it is within `near` [m] of the `goal` [m], [..., 2], which the middle of a
    cell only approaches.
    """
    whole = np.hypot(*np.moveaxis(corner - start, -1, 0))
    to_goal = np.hypot(*np.moveaxis(goal - start, -1, 0)) - near
    arrives = last & (np.hypot(*np.moveaxis(goal - corner, -1, 0)) <= near)
    return np.where(arrives, np.maximum(to_goal, 0.0), whole)


def _by_depth(before: NDArray[np.int32]) -> Sequence[NDArray[np.int64]]:
    """The cells that have a way and are not its end, in groups by their number of steps to the end."""
    here = np.arange(len(before))
    jump = np.where(before >= 0, before, here)
    depth = (jump != here).astype(np.int64)
    while (jump[jump] != jump).any():
        depth += depth[jump]
        jump = jump[jump]
    order = np.argsort(depth, kind="stable")
    return np.split(order, np.cumsum(np.bincount(depth))[:-1])[1:]


def _clear(
    cost: Array, width: int, start: NDArray[np.int64], end: NDArray[np.int32], dearest: Array, most: Array
) -> NDArray[np.bool_]:
    """Whether the straight lines between cells, [P], cost at most `most` [P] and cross none dearer than `dearest` [P].

    Costs are in cells.
    """
    y, x = np.divmod(start, width)
    down, right = np.divmod(end, width)
    down, right = down - y, right - x
    share = np.linspace(0.0, 1.0, 2 * int(max(np.abs(down).max(), np.abs(right).max())) + 1)[:, None]
    crossed = cost[np.rint(y + down * share).astype(np.int64) * width + np.rint(x + right * share).astype(np.int64)]
    spent = crossed.mean(axis=0) * np.hypot(down, right)
    return np.asarray((crossed.max(axis=0) <= dearest) & (spent <= most * (1.0 + ROUNDING)))
