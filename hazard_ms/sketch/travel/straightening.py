"""Kernels that straighten the paths of `hazard_ms.sketch.travel.geodesic`, cell by cell.

Numpy, which goes from one number of steps to the next, takes four times as long.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

Floats = wp.array(dtype=wp.float64)
Cells = wp.array(dtype=wp.int32)


@wp.func
def straight(cost: Floats, width: int, start: int, end: int, samples: int) -> wp.vec2d:
    """Mean and highest cost of the cells under a straight line between two cells, at so many points of it."""
    y, x = wp.float64(start // width), wp.float64(start % width)
    down, right = wp.float64(end // width) - y, wp.float64(end % width) - x
    total, highest = wp.float64(0.0), wp.float64(0.0)
    for k in range(samples):
        share = wp.float64(k) * (wp.float64(1.0) / wp.float64(wp.max(samples - 1, 1)))
        if k > 0 and k == samples - 1:
            share = wp.float64(1.0)
        crossed = cost[int(wp.rint(y + down * share)) * width + int(wp.rint(x + right * share))]
        total += crossed
        highest = wp.max(highest, crossed)
    return wp.vec2d(total / wp.float64(samples), highest)


@wp.kernel
def choose(
    width: int,
    rounding: wp.float64,
    cost: Floats,
    spent: Floats,
    before: Cells,
    order: Cells,
    depths: Cells,
    dearest: Floats,
    corner: Cells,
    end: Cells,
):
    """Choose the corner that each cell goes to, and note where its way ends, as `geodesic.straightened` says.

    `order`: cells by their number of steps to the end; `depths` [D + 1]: where each number begins in it. `dearest`:
    the highest cost on the way, of each cell at first; `corner` and `end` are `before` at first. [N] each.
    """
    for depth in range(depths.shape[0] - 1):
        longest = int(0)  # of the lines that are compared at this depth [cells]
        for i in range(depths[depth], depths[depth + 1]):
            here = order[i]
            ahead = corner[before[here]]
            longest = wp.max(longest, wp.abs(ahead // width - here // width))
            longest = wp.max(longest, wp.abs(ahead % width - here % width))
        for i in range(depths[depth], depths[depth + 1]):
            here = order[i]
            following = before[here]
            ahead = corner[following]
            limit = wp.max(cost[here], dearest[following])
            down, right = ahead // width - here // width, ahead % width - here % width
            line = straight(cost, width, here, ahead, 2 * longest + 1)
            length = wp.sqrt(wp.float64(down * down + right * right))
            most = (spent[here] - spent[ahead]) * (wp.float64(1.0) + rounding)
            chosen = following
            dearest[here] = wp.max(cost[here], cost[following])
            if line[1] <= limit and line[0] * length <= most:
                chosen = ahead
                dearest[here] = limit
            corner[here] = chosen
            end[here] = end[chosen]


@wp.kernel
def add_up(order: Cells, corner: Cells, own: Floats, total: wp.array(dtype=wp.float32)):
    """Add to `own`, [N], of each cell the `total`, [N], of the corner that it goes to, from the end outwards."""
    for i in range(order.shape[0]):
        here = order[i]
        total[here] = wp.float32(wp.float64(total[corner[here]]) + own[here])
