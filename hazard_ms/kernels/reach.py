"""How water comes to a place in a room; the host's part, and what the arguments are: hazard_ms.hazards.surface."""

from __future__ import annotations

import warp as wp

from hazard_ms.launching import OPTIONS

wp.set_module_options(OPTIONS)

NEVER = wp.constant(1e6)  # way to where water cannot get [m]


@wp.struct
class Reach:
    """How water comes to a place."""

    way: float  # how far it has come [m], NEVER where it cannot
    toward: wp.vec2  # which way it flows there


@wp.func
def reach(
    e: int,
    x: float,
    y: float,
    flow: wp.array(dtype=wp.vec2),
    start: wp.array(dtype=float),
    wall: wp.array2d(dtype=wp.vec2),
    near: wp.array2d(dtype=wp.int64),
    gate: wp.array2d(dtype=wp.vec4),
    gate_way: wp.array2d(dtype=float),
    gate_part: wp.array3d(dtype=wp.int64),
) -> Reach:
    """Of the place `x`, `y` [m] in environment `e`; the others: see Ways."""
    found = Reach()
    found.toward = flow[e]
    found.way = flow[e][0] * x + start[e] + flow[e][1] * y
    part = wp.int64(0)
    for k in range(wall.shape[1]):
        across = x
        if wall[e, k][0] > 0.0:
            across = y
        if across > wall[e, k][1]:
            part |= wp.int64(1) << wp.int64(k)
    if (part & near[e, 0]) != near[e, 1]:
        found.way = NEVER
    for k in range(gate.shape[1]):
        if ((part ^ gate_part[e, k, 0]) & ~gate_part[e, k, 1]) == wp.int64(0):
            box = gate[e, k]
            off = wp.vec2(x - wp.clamp(x, box[0], box[2]), y - wp.clamp(y, box[1], box[3]))
            apart = wp.length(off)
            if gate_way[e, k] + apart < found.way:
                found.way = gate_way[e, k] + apart
                if apart > 0.0:
                    found.toward = off / apart
    return found


@wp.kernel
def ways_to(
    flow: wp.array(dtype=wp.vec2),
    start: wp.array(dtype=float),
    wall: wp.array2d(dtype=wp.vec2),
    near: wp.array2d(dtype=wp.int64),
    gate: wp.array2d(dtype=wp.vec4),
    gate_way: wp.array2d(dtype=float),
    gate_part: wp.array3d(dtype=wp.int64),
    place: wp.array2d(dtype=wp.vec3),
    way: wp.array2d(dtype=float),
    toward: wp.array2d(dtype=wp.vec2),
):
    """The way of the water to every `place` [m], and where it flows there."""
    e, p = wp.tid()
    found = reach(e, place[e, p][0], place[e, p][1], flow, start, wall, near, gate, gate_way, gate_part)
    way[e, p] = found.way
    toward[e, p] = found.toward
