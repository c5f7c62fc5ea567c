"""Things that lie in the basket of a cart, or on other things that do (Warp).

The meaning, and the part that runs on the host: hazard_ms.simulation.containers.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.boxes import axes_of, base_of, spans, to_body
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

# Corners of the basket in shares of the cart's extent from its centre: 0.46 to 0.885 m of a height of 1.025 m, with the
# handle at +y [ours]
BASKET_LOW, BASKET_HIGH = wp.constant(wp.vec3(-0.436, -0.435, -0.051)), wp.constant(wp.vec3(0.436, 0.371, 0.363))
# Margin around a container: what rests on a thing, or has sunk a little into the basket's floor, is inside [m] [ours]
TOUCH = wp.constant(0.02)


@wp.func
def within(point: wp.vec3, low: wp.vec3, high: wp.vec3) -> bool:
    """Whether `point` is inside the box from `low` to `high`."""
    x = point[0] > low[0] and point[0] < high[0]
    y = point[1] > low[1] and point[1] < high[1]
    return x and y and point[2] > low[2] and point[2] < high[2]


@wp.func
def in_basket(cart: wp.vec3, axes: wp.mat33, extent: wp.vec3, point: wp.vec3) -> bool:
    """Whether `point` [m] is in the basket of a `cart` with this centre [m], these axes and edges `extent` [m]."""
    local = to_body(axes, point - cart)
    low = wp.cw_mul(extent, BASKET_LOW) - wp.vec3(TOUCH, TOUCH, TOUCH)
    high = wp.cw_mul(extent, BASKET_HIGH) + wp.vec3(TOUCH, TOUCH, TOUCH)
    return within(local, low, high)


@wp.kernel
def find(
    containers: wp.array2d(dtype=wp.int64),
    settled: wp.array2d(dtype=bool),
    bodies: Bodies,
    found: wp.array2d(dtype=bool),
):
    """Set `found` for bodies that lie in one of `containers` (indices, -1 for none) or on what has `settled`."""
    e, b = wp.tid()
    found[e, b] = False
    if not bodies.exists[e, b] or not bodies.movable[e, b] or bodies.held[e, b] or bodies.away[e, b]:
        return
    centre = bodies.position[e, b]
    base = base_of(centre, axes_of(bodies.rotation[e, b]), bodies.extent[e, b])
    for c in range(containers.shape[1]):
        cart = int(containers[e, c])
        if cart >= 0:
            axes, place, size = axes_of(bodies.rotation[e, cart]), bodies.position[e, cart], bodies.extent[e, cart]
            if in_basket(place, axes, size, base) or in_basket(place, axes, size, centre):
                found[e, b] = True
                return
    for other in range(settled.shape[1]):
        if (
            other != b
            and settled[e, other]
            and bodies.exists[e, other]
            and bodies.movable[e, other]
            and not bodies.held[e, other]
            and not bodies.away[e, other]
        ):
            half = 0.5 * spans(axes_of(bodies.rotation[e, other]), bodies.extent[e, other])
            half = half + wp.vec3(TOUCH, TOUCH, TOUCH)
            if within(base - bodies.position[e, other], -half, half):
                found[e, b] = True
                return
