"""Lengths of lines of sight in flames (Warp, one thread per pixel).

A flame is an upright cylinder. A line is cut by its mantle and by its ends: a quadratic equation and two planes, exact
up to rounding. Where cylinders overlap, each counts: flames that merge are as thick together.
"""

from __future__ import annotations

import torch
import warp as wp
from torch import Tensor

from hazard_ms.sensing.senses.signals import Flames
from hazard_ms.simulation.kernels.launch import OPTIONS
from hazard_ms.simulation.world import World

wp.set_module_options(OPTIONS)

TINY = wp.constant(1.0e-9)  # least value of a divisor, in its own unit


@wp.struct
class Columns:
    """The fields of `signals.Flames` with the same names."""

    place: wp.array2d(dtype=wp.vec3)
    width: wp.array2d(dtype=float)
    height: wp.array2d(dtype=float)


@wp.kernel
def cross(
    eye: wp.array(dtype=wp.vec3), points: wp.array2d(dtype=wp.vec3), columns: Columns, found: wp.array2d(dtype=float)
):
    """Set `found` to the length [m] in `columns` of the straight way from the `eye` [m] to each of `points` [m]."""
    e, p = wp.tid()
    start = eye[e]
    way = points[e, p] - start
    length = wp.length(way)
    steep = way[0] * way[0] + way[1] * way[1]
    total = float(0.0)
    for m in range(columns.width.shape[1]):
        radius, tall = 0.5 * columns.width[e, m], columns.height[e, m]
        if radius > 0.0 and tall > 0.0:
            base = columns.place[e, m]
            x, y = start[0] - base[0], start[1] - base[1]
            low, high = float(0.0), float(1.0)
            mixed, outside = x * way[0] + y * way[1], x * x + y * y - radius * radius
            if steep > TINY:
                root = mixed * mixed - steep * outside
                if root <= 0.0:
                    high = -1.0
                else:
                    half = wp.sqrt(root)
                    low = wp.max(low, (-mixed - half) / steep)
                    high = wp.min(high, (-mixed + half) / steep)
            elif outside > 0.0:
                high = -1.0
            bottom, top = base[2] - start[2], base[2] + tall - start[2]
            if wp.abs(way[2]) > TINY:
                low = wp.max(low, wp.min(bottom / way[2], top / way[2]))
                high = wp.min(high, wp.max(bottom / way[2], top / way[2]))
            elif bottom > 0.0 or top < 0.0:
                high = -1.0
            total = total + wp.max(high - low, 0.0) * length
    found[e, p] = total


def through(world: World, flames: Flames, eye: Tensor, points: Tensor) -> Tensor:
    """Length [m], [E, P], in `flames` of the lines from the `eye` [m], [E, 3], to `points` [m], [E, P, 3]."""
    found = torch.empty_like(points[..., 0], memory_format=torch.contiguous_format)
    shown = Flames(*(v.contiguous() if isinstance(v, Tensor) else v for v in flames))
    columns = world.launches.struct(Columns, shown)
    world.launches.run(cross, tuple(found.shape), eye.contiguous(), points.contiguous(), columns, found)
    return found
