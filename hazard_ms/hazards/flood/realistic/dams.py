"""Furniture that leaves the floor, and that dams the openings it drifts into (Warp).

A piece floats off where the water on its four sides is as deep on average as .buoyant says; from then on it is a body
like all others, for the rest of the episode. The ground that it was is floor again, as full as the water around:
floating, it raises the level as its own weight of water would. A piece that floats is no ground: water runs under it.
In an opening it dams it by the share of the wetted area, width over depth, that its box covers; what overlaps counts
twice, up to all. Limits: it dams outer and inner doorways only, not the floor; a turned box counts with the box around
it; a current does not shove it along the floor before it floats.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.flood.realistic.basin import FENCE, SIDE, Basin, here
from hazard_ms.kernels.bodies import Bodies
from hazard_ms.kernels.boxes import axes_of, spans
from hazard_ms.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

NEAR = wp.constant(0.1)  # distance from the plane of an opening within which a piece lies in it [m] [ours]


@wp.func
def around(e: int, place: wp.vec3, axes: wp.mat33, edges: wp.vec3, rows: int, columns: int, basin: Basin) -> float:
    """Depth of the water [m] above the base of an upright piece, the mean of its four sides.

    A jet that runs up one side does not lift it.
    """
    depth = float(0.0)
    for k in range(4):
        far = wp.vec3(0.5 * edges[0] + SIDE, 0.0, 0.0)
        if k >= 2:
            far = wp.vec3(0.0, 0.5 * edges[1] + SIDE, 0.0)
        if k == 1 or k == 3:
            far = -far
        at = place + axes * far
        water = here(e, at[0], at[1], rows, columns, basin)
        depth += 0.25 * wp.max(water.level - place[2] + 0.5 * edges[2], 0.0)
    return depth


@wp.kernel
def lift_off(
    rows: int,
    columns: int,
    basin: Basin,
    bodies: Bodies,
    float_depth: wp.array2d(dtype=float),
    ground_of: wp.array2d(dtype=wp.int64),
    displaced: wp.array(dtype=float),
    afloat: wp.array2d(dtype=bool),
):
    """Set what floats now `afloat`, and make its ground floor; add the water that takes its place to `displaced` [m^3].

    `ground_of`: which thing is the ground of each cell, -1 for none; `float_depth` [m]: infinite for all that stays.
    """
    e = wp.tid()
    fresh = bool(False)
    for b in range(float_depth.shape[1]):
        if float_depth[e, b] < FENCE and not afloat[e, b]:
            axes, edges = axes_of(bodies.rotation[e, b]), bodies.extent[e, b]
            if around(e, bodies.position[e, b], axes, edges, rows, columns, basin) >= float_depth[e, b]:
                afloat[e, b] = True
                fresh = True
    if fresh:
        gained = float(0.0)
        for c in range(ground_of.shape[1]):
            k = int(ground_of[e, c])
            if k >= 0 and basin.bed[e, c] > 0.0:
                if afloat[e, k]:
                    before = basin.depth[e, c]
                    after = wp.max(basin.surface[e, c], 0.0)
                    if before > 0.0:
                        after = basin.bed[e, c] + before
                    basin.bed[e, c] = 0.0
                    basin.depth[e, c] = after
                    basin.surface[e, c] = after
                    gained += (after - before) * SIDE * SIDE
        displaced[e] = displaced[e] + gained


@wp.func
def overlap(middle: float, half: float, low: float, high: float) -> float:
    """Length [m] of what is within `half` of `middle` and between `low` and `high` [m]."""
    return wp.max(wp.min(middle + half, high) - wp.max(middle - half, low), 0.0)


@wp.kernel
def dam(
    columns: int,
    outside: float,
    bodies: Bodies,
    afloat: wp.array2d(dtype=bool),
    cell: wp.array2d(dtype=wp.int64),
    side: wp.array2d(dtype=wp.int64),
    width: wp.array2d(dtype=float),
    height: wp.array2d(dtype=float),
    dammed: wp.array2d(dtype=float),
):
    """Write the share of each opening's wetted area, up to the depth `outside` [m], that floating furniture covers.

    An opening of `width` [m] and `height` [m] is in the middle of a `side` of a `cell`, -1 for none.
    """
    e, k = wp.tid()
    covered = float(0.0)
    c = int(cell[e, k])
    wet = wp.min(height[e, k], outside)
    if c >= 0 and wet > 0.0:
        pitch = columns + 2
        i, j = float(c // pitch - 1), float(c % pitch - 1)
        at = int(side[e, k])
        plane, middle, across = i * SIDE, (j + 0.5) * SIDE, 0
        if at == 1:
            plane += SIDE
        if at >= 2:
            plane, middle, across = j * SIDE, (i + 0.5) * SIDE, 1
        if at == 3:
            plane += SIDE
        half = 0.5 * width[e, k]
        for b in range(afloat.shape[1]):
            if afloat[e, b]:
                place = bodies.position[e, b]
                box = 0.5 * spans(axes_of(bodies.rotation[e, b]), bodies.extent[e, b])
                if overlap(place[across], box[across], plane - NEAR, plane + NEAR) > 0.0:
                    wide = overlap(place[1 - across], box[1 - across], middle - half, middle + half)
                    covered += wide * overlap(place[2], box[2], 0.0, wet) / (2.0 * half * wet)
    dammed[e, k] = wp.min(covered, 1.0)
