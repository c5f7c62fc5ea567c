"""What lies in the basket of a cart, or on what does; the host's part, and what it means: hazard_ms.hazards.containers."""

from __future__ import annotations

import warp as wp

from hazard_ms.kernels.boxes import axes_of, base_of, spans, to_body
from hazard_ms.launching import OPTIONS

wp.set_module_options(OPTIONS)

# The basket in shares of the cart's extent from its centre: 0.46 to 0.885 m of a height of 1.025 m, the handle is at +y [ours].
BASKET_LOW, BASKET_HIGH = wp.constant(wp.vec3(-0.436, -0.435, -0.051)), wp.constant(wp.vec3(0.436, 0.371, 0.363))
TOUCH = wp.constant(0.02)  # what rests on a thing, or has sunk a little into the basket's floor, counts as inside [m] [ours]


@wp.func
def within(point: wp.vec3, low: wp.vec3, high: wp.vec3) -> bool:
    """Whether `point` is inside the box from `low` to `high`."""
    x = point[0] > low[0] and point[0] < high[0]
    y = point[1] > low[1] and point[1] < high[1]
    return x and y and point[2] > low[2] and point[2] < high[2]


@wp.func
def _in_basket(cart: wp.vec3, axes: wp.mat33, extent: wp.vec3, point: wp.vec3) -> bool:
    """Whether `point` [m] is in the basket of a cart whose centre, axes and extent are given."""
    local = to_body(axes, point - cart)
    low = wp.cw_mul(extent, BASKET_LOW) - wp.vec3(TOUCH, TOUCH, TOUCH)
    high = wp.cw_mul(extent, BASKET_HIGH) + wp.vec3(TOUCH, TOUCH, TOUCH)
    return within(local, low, high)


@wp.kernel
def find(
    containers: wp.array2d(dtype=wp.int64),
    settled: wp.array2d(dtype=bool),
    exists: wp.array2d(dtype=bool),
    movable: wp.array2d(dtype=bool),
    held: wp.array2d(dtype=bool),
    away: wp.array2d(dtype=bool),
    position: wp.array2d(dtype=wp.vec3),
    rotation: wp.array2d(dtype=wp.vec4),
    extent: wp.array2d(dtype=wp.vec3),
    found: wp.array2d(dtype=bool),
):
    """Which bodies lie in a container, or on what has settled."""
    e, b = wp.tid()
    found[e, b] = False
    if not exists[e, b] or not movable[e, b] or held[e, b] or away[e, b]:
        return
    centre = position[e, b]
    base = base_of(centre, axes_of(rotation[e, b]), extent[e, b])
    for c in range(containers.shape[1]):
        cart = int(containers[e, c])
        if cart >= 0:
            axes, place, size = axes_of(rotation[e, cart]), position[e, cart], extent[e, cart]
            if _in_basket(place, axes, size, base) or _in_basket(place, axes, size, centre):
                found[e, b] = True
                return
    for other in range(settled.shape[1]):
        if other != b and settled[e, other] and exists[e, other] and movable[e, other] and not held[e, other] and not away[e, other]:
            half = 0.5 * spans(axes_of(rotation[e, other]), extent[e, other]) + wp.vec3(TOUCH, TOUCH, TOUCH)
            if within(base - position[e, other], -half, half):
                found[e, b] = True
                return
