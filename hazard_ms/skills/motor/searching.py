"""Dijkstra's search over a grid of costs as a kernel, which ends as soon as the best end of a path is known.

It needs no graph of all steps, as scipy's does. Cheapest costs are the same to the last bit: both add the same steps in
the same order. Where two cells lead to a third one at costs that are equal to the last bit, either may choose either:
`tied` tells, and `by_graph` asks scipy, so that paths are those that they always were.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import torch
import warp as wp
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import csgraph

from hazard_ms.simulation.kernels.launch import OPTIONS, Launches

wp.set_module_options(OPTIONS)

Floats = wp.array(dtype=wp.float64)
Cells = wp.array(dtype=wp.int32)

ROUNDING = 1e-6  # by which distances and costs may differ between this kernel and its callers [m] and [m] of path
SIDES = ((0, 1), (1, 0), (1, 1), (1, -1))  # half of the eight neighbours
# steps to eight neighbours [cells]
AROUND = np.array([(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1) if y or x]).T

_launches = Launches()


class Aim(NamedTuple):
    """The goal of a path, and the costs of ending elsewhere."""

    x: float  # of the goal from the middle of cell 0, 0 [m]
    y: float
    near: float  # distance from the goal at which nothing is missed [m]
    enough: float  # distance up to which `short` holds [m]
    short: float  # cost of ending a metre farther than `near`, in metres of path
    far_short: float  # the same beyond `enough`


@wp.func
def rise(spent: Floats, heap: Cells, place: Cells, at: int):
    """Move the cell at place `at` of the heap up to where it belongs."""
    cell = heap[at]
    while at > 0 and spent[cell] < spent[heap[(at - 1) // 2]]:
        above = (at - 1) // 2
        heap[at] = heap[above]
        place[heap[at]] = at
        at = above
    heap[at] = cell
    place[cell] = at


@wp.func
def sink(spent: Floats, heap: Cells, place: Cells, size: int):
    """Move the cell at the top of a heap of `size` cells down to where it belongs."""
    cell = heap[0]
    at = int(0)
    below = int(1)
    while below < size:
        if below + 1 < size and spent[heap[below + 1]] < spent[heap[below]]:
            below += 1
        if spent[cell] <= spent[heap[below]]:
            break
        heap[at] = heap[below]
        place[heap[at]] = at
        at = below
        below = 2 * at + 1
    heap[at] = cell
    place[cell] = at


@wp.kernel
def search(
    width: int,
    first: int,
    edge: wp.float64,
    limit: wp.float64,
    aim: Floats,
    cost: Floats,
    spent: Floats,
    before: Cells,
    heap: Cells,
    place: Cells,
):
    """Settle cells in the order of their cheapest cost from `first`, as `cheapest` says; all arrays but `aim` are [N].

    `edge`: of a cell [m]; `spent` is infinite and `before` -1 at first; `heap`: cells that wait, `place` of each in it.
    """
    spent[first] = wp.float64(0.0)
    heap[0] = first
    size = int(1)
    best = limit
    while size > 0:
        here = heap[0]
        if spent[here] > best:
            break
        size -= 1
        if size > 0:
            heap[0] = heap[size]
            sink(spent, heap, place, size)
        y, x = here // width, here % width
        if aim.shape[0] > 0:
            best = wp.min(best, spent[here] + of_ending(aim, edge * wp.float64(x), edge * wp.float64(y)))
        for k in range(9):
            down, right = k // 3 - 1, k % 3 - 1
            inside = x + right >= 0 and x + right < width and y + down >= 0 and (y + down) * width < cost.shape[0]
            if inside and k != 4:
                there = here + down * width + right
                step = (cost[here] + cost[there]) / wp.float64(2.0) * edge
                if down != 0 and right != 0:
                    step *= wp.sqrt(wp.float64(2.0))
                through = spent[here] + step
                if through < spent[there] and through < limit:
                    at = place[there]
                    if before[there] < 0:
                        at = size
                        size += 1
                        heap[at] = there
                    spent[there] = through
                    before[there] = here
                    rise(spent, heap, place, at)


@wp.func
def of_ending(aim: Floats, x: wp.float64, y: wp.float64) -> wp.float64:
    """Cost of ending at a place [m] of the grid, a little more than it is, so that no best end is missed."""
    far = wp.sqrt((x - aim[0]) * (x - aim[0]) + (y - aim[1]) * (y - aim[1])) + aim[6]
    return wp.where(far <= aim[3], aim[4], aim[5]) * wp.max(far - aim[2], wp.float64(0.0)) + aim[6]


def cheapest(
    cost: NDArray[np.float64], cell: float, first: int, limit: float, aim: Aim | None = None
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Cheapest costs from the cell `first` to all N cells, [N], and the cell before each on the way there, [N].

    A step to one of eight neighbours costs its length times the mean `cost`, [Y, X], of its two cells; `cell`: their
    edge [m]. Costs from `limit` on are infinite; no cell, -1, comes before these and before `first`. With an `aim`,
    only the costs of cells at which a path to it may best end, and of those before them, are sure to be the cheapest.
    """
    spent = torch.full((cost.size,), np.inf, dtype=torch.float64)
    before = torch.full((cost.size,), -1, dtype=torch.int32)
    heap, place = torch.empty_like(before), torch.empty_like(before)
    aims = torch.tensor([] if aim is None else [*aim, ROUNDING], dtype=torch.float64)
    flat = torch.from_numpy(cost.ravel())
    _launches.run(search, (1,), cost.shape[1], first, cell, limit, aims, flat, spent, before, heap, place)
    return spent.numpy(), before.numpy()


def graph_of(cost: NDArray[np.float64], cell: float) -> sparse.csr_matrix:
    """The graph of steps to eight neighbours: each costs its length times the mean `cost`, [Y, X], of its two cells.

    `cell`: the edge of a cell [m].
    """
    number = np.arange(cost.size).reshape(cost.shape)
    rows, columns, weights = [], [], []
    for dy, dx in SIDES:
        a = (slice(0, cost.shape[0] - dy), slice(max(0, -dx), cost.shape[1] - max(0, dx)))
        b = (slice(dy, cost.shape[0]), slice(max(0, dx), cost.shape[1] - max(0, -dx)))
        rows.append(number[a].ravel())
        columns.append(number[b].ravel())
        weights.append(((cost[a] + cost[b]) / 2 * cell * np.hypot(dy, dx)).ravel())
    shape = (cost.size, cost.size)
    half = sparse.coo_matrix(
        (np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))), shape=shape
    ).tocsr()
    return half + half.T


def by_graph(cost: NDArray[np.float64], cell: float, first: int) -> NDArray[np.int32]:
    """The cell before each of N cells, [N], as scipy's search finds it; below 0: none.

    `cost`, [Y, X], the edge `cell` [m] of its cells, and `first` are as for `cheapest`.
    """
    _, before = csgraph.dijkstra(graph_of(cost, cell), indices=first, return_predecessors=True)
    return np.asarray(before)


def trace(before: NDArray[np.int32], end: int, width: int) -> NDArray[np.int64]:
    """Cells (y, x) [-] from the start to `end`, [P, 2]."""
    chain = [end]
    while before[chain[-1]] >= 0:
        chain.append(int(before[chain[-1]]))
    return np.stack(np.divmod(np.array(chain[::-1]), width), axis=-1)


def tied(cells: NDArray[np.int64], spent: NDArray[np.float64], cost: NDArray[np.float64], cell: float) -> bool:
    """Whether other `cells` could come before those of a path (y, x), [P, 2], at costs equal to the last bit.

    `spent`, [N], and `cost`, [Y, X], as for `cheapest`, with the edge `cell` [m] of a cell.
    """
    paid, price = (np.pad(grid, 1, constant_values=np.inf) for grid in (spent.reshape(cost.shape), cost))
    y, x = cells[1:, :, None].transpose(1, 0, 2) + 1
    dy, dx = AROUND
    step = (price[y, x] + price[y + dy, x + dx]) / 2 * cell * np.hypot(dy, dx)
    before = paid[cells[:-1, 0] + 1, cells[:-1, 1] + 1]
    same = (paid[y + dy, x + dx] + step == paid[y, x]) & (paid[y + dy, x + dx] == before[:, None])
    return bool((same.sum(axis=1) > 1).any())


def straighten(cells: NDArray[np.int64], cost: NDArray[np.float64]) -> NDArray[np.int64]:
    """The fewest cells of a path over costs [Y, X] whose straight connections cost no more, and cross no dearer cell.

    `cells` are those of the path, (y, x) [-], [P, 2]; the ones that are kept [-], [K, 2], begin and end it.
    """
    along = cost[tuple(cells.T)]
    steps = np.hypot(*np.diff(cells, axis=0).T) * (along[1:] + along[:-1]) / 2
    spent = np.concatenate([[0.0], np.cumsum(steps)])
    kept, at = [0], 0
    while at < len(cells) - 1:
        ahead, dearest = len(cells) - 1, np.maximum.accumulate(along[at:])
        while ahead > at + 1 and not _clear(
            cells[at], cells[ahead], cost, dearest[ahead - at], spent[ahead] - spent[at]
        ):
            ahead -= 1
        kept.append(ahead)
        at = ahead
    return cells[kept]


def _clear(a: NDArray[np.int64], b: NDArray[np.int64], cost: NDArray[np.float64], dearest: float, most: float) -> bool:
    """Whether the line from `a` to `b` costs at most `most` and crosses no cell dearer than `dearest`."""
    y, x = (b - a).tolist()
    line = np.rint(a + (b - a) * _shares(max(abs(y), abs(x)) * 2 + 1)).astype(int)
    crossed = cost[line[:, 0], line[:, 1]]
    return bool(crossed.max() <= dearest and crossed.mean() * np.hypot(y, x) <= most * (1.0 + 1e-9))


@lru_cache(maxsize=1024)
def _shares(count: int) -> NDArray[np.float64]:
    """So many shares from 0 to 1, equally far apart: [C, 1]."""
    return np.linspace(0.0, 1.0, count)[:, None]
