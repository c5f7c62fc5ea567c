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
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.boxes import axes_of, spans
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

NEAR = wp.constant(0.1)  # distance from the plane of an opening within which a piece lies in it [m] [ours]


@wp.struct
class Furniture:
    """The fields of InundationState with the same names."""

    float_depth: wp.array2d(dtype=float)
    afloat: wp.array2d(dtype=bool)
    ground_of: wp.array2d(dtype=wp.int64)
    displaced: wp.array(dtype=float)


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


@wp.func
def lift_off(e: int, rows: int, columns: int, basin: Basin, furniture: Furniture, bodies: Bodies):
    """Set afloat what floats now, and make its ground floor; note the water that takes its place."""
    fresh = bool(False)
    for b in range(furniture.float_depth.shape[1]):
        deep = furniture.float_depth[e, b]
        if deep < FENCE and not furniture.afloat[e, b]:
            axes, edges = axes_of(bodies.rotation[e, b]), bodies.extent[e, b]
            if around(e, bodies.position[e, b], axes, edges, rows, columns, basin) >= deep:
                furniture.afloat[e, b] = True
                fresh = True
    if fresh:
        gained = float(0.0)
        for c in range(furniture.ground_of.shape[1]):
            k = int(furniture.ground_of[e, c])
            if k >= 0 and basin.bed[e, c] > 0.0:
                if furniture.afloat[e, k]:
                    before = basin.depth[e, c]
                    after = wp.max(basin.surface[e, c], 0.0)
                    if before > 0.0:
                        after = basin.bed[e, c] + before
                    basin.bed[e, c] = 0.0
                    basin.depth[e, c] = after
                    basin.surface[e, c] = after
                    gained += (after - before) * SIDE * SIDE
        furniture.displaced[e] = furniture.displaced[e] + gained


@wp.func
def overlap(middle: float, half: float, low: float, high: float) -> float:
    """Length [m] of what is within `half` of `middle` and between `low` and `high` [m]."""
    return wp.max(wp.min(middle + half, high) - wp.max(middle - half, low), 0.0)


@wp.func
def covered(
    e: int,
    columns: int,
    cell: wp.int64,
    side: wp.int64,
    width: float,
    wet: float,
    furniture: Furniture,
    bodies: Bodies,
) -> float:
    """Share of an opening that floating furniture covers.

    It is `width` [m] wide, `wet` [m] deep under water, and in the middle of a `side` of a `cell`, -1 for none.
    """
    if cell < wp.int64(0) or wet <= 0.0:
        return 0.0
    c, pitch, found = int(cell), columns + 2, float(0.0)
    plane, middle, across = float(c // pitch - 1) * SIDE, (float(c % pitch) - 0.5) * SIDE, 0
    if side >= wp.int64(2):
        plane, middle, across = float(c % pitch - 1) * SIDE, (float(c // pitch) - 0.5) * SIDE, 1
    if side == wp.int64(1) or side == wp.int64(3):
        plane += SIDE
    half = 0.5 * width
    for b in range(furniture.afloat.shape[1]):
        if furniture.afloat[e, b]:
            place = bodies.position[e, b]
            box = 0.5 * spans(axes_of(bodies.rotation[e, b]), bodies.extent[e, b])
            if overlap(place[across], box[across], plane - NEAR, plane + NEAR) > 0.0:
                wide = overlap(place[1 - across], box[1 - across], middle - half, middle + half)
                found += wide * overlap(place[2], box[2], 0.0, wet) / (width * wet)
    return wp.min(found, 1.0)


@wp.kernel
def drift(outside: float, rows: int, columns: int, basin: Basin, furniture: Furniture, bodies: Bodies):
    """Let furniture leave the floor, and dam the openings it lies in, up to the depth `outside` [m]."""
    e = wp.tid()
    lift_off(e, rows, columns, basin, furniture, bodies)
    for k in range(basin.inlet.shape[1]):
        wet = wp.min(basin.inlet_height[e, k], outside)
        basin.dammed[e, k] = covered(
            e, columns, basin.inlet[e, k], basin.inlet_side[e, k], basin.inlet_width[e, k], wet, furniture, bodies
        )
    for k in range(basin.door.shape[1]):
        wet = wp.min(basin.door_height[e, k], outside)
        basin.door_dammed[e, k] = covered(
            e, columns, basin.door[e, k], basin.door_side[e, k], SIDE, wet, furniture, bodies
        )
