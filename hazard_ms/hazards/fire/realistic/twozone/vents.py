"""Flow through doors, windows and gaps by the difference of pressure over their height (Warp).

    dp(z) = P_a(z) - P_b(z),   P(z) = p - g (rho_air min(z, z_l) + rho_layer (z - z_l)+)
    m = C w integral sqrt(2 rho |dp|) dz,   rho that of the gas which flows

p are pressures at the floor above the air outside, z_l the lower faces of the layers on both sides. dp is
linear between the faces, so the integral is exact. The rooms of a flat stand in a row; a room's pressure is the one at
which all volumes balance, `sum of flows = heat / 353`: bisection on the first room's, from which the others follow.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

COEFFICIENT = 0.7  # flow coefficient of openings [-] [docs/physics.md 3.1]
GRAVITY = wp.constant(radiation.GRAVITY)
HIGHEST = 150.0  # square root of the largest pressure in a room [Pa^0.5] [ours]
APART = 30.0  # the same between two rooms [Pa^0.5] [ours]
HALVINGS = 26  # of the interval of a bisection, to 1e-5 Pa^0.5 [ours]


@wp.struct
class Side:
    """The gas on one side of an opening."""

    pressure: float  # at the floor, above the outside [Pa]
    face: float  # lower face of the layer above the floor [m]
    density: float  # of the layer [kg/m^3]
    air: float  # density of the air below it [kg/m^3]


@wp.struct
class Flow:
    """The flow through an opening [kg/s], from the first side to the second, and back: of layers, and of air.

    `under` is the air that comes into the layer of the other side.
    """

    hot: float
    cold: float
    under: float
    hot_back: float
    cold_back: float
    under_back: float


@wp.func
def head(side: Side, z: float) -> float:
    """Pressure [Pa] at the height `z` [m], above that of the air outside at the floor."""
    return side.pressure - GRAVITY * (side.air * wp.min(z, side.face) + side.density * wp.max(z - side.face, 0.0))


@wp.func
def mean_root(p: float, q: float) -> float:
    """Mean of the square root of a pressure that goes from `p` to `q` [Pa] in a straight line, both at least 0."""
    a = wp.sqrt(p)
    b = wp.sqrt(q)
    return 2.0 / 3.0 * (p + a * b + q) / wp.max(a + b, 1.0e-9)


@wp.func
def slab(low: float, high: float, a: Side, b: Side) -> wp.vec2:
    """Integrals of sqrt|dp| [Pa^0.5 m] from `low` to `high` [m], where dp drives outwards and inwards."""
    below = head(a, low) - head(b, low)
    above = head(a, high) - head(b, high)
    tall = wp.max(high - low, 0.0)
    if below >= 0.0 and above >= 0.0:
        return wp.vec2(tall * mean_root(below, above), 0.0)
    if below <= 0.0 and above <= 0.0:
        return wp.vec2(0.0, tall * mean_root(-below, -above))
    share = below / (below - above)
    first = tall * share * mean_root(wp.abs(below), 0.0)
    last = tall * (1.0 - share) * mean_root(0.0, wp.abs(above))
    if below > 0.0:
        return wp.vec2(first, last)
    return wp.vec2(last, first)


@wp.func
def through(width: float, sill: float, top: float, a: Side, b: Side) -> Flow:
    """Find the flow through an opening of `width`, from `sill` to `top` [m], between the sides `a` and `b`."""
    flow = Flow()
    scale = COEFFICIENT * width * wp.sqrt(2.0)
    first = wp.clamp(wp.min(a.face, b.face), sill, top)
    last = wp.clamp(wp.max(a.face, b.face), sill, top)
    for k in range(3):
        low = sill
        high = first
        if k == 1:
            low = first
            high = last
        if k == 2:
            low = last
            high = top
        if high > low:
            passed = scale * slab(low, high, a, b)
            middle = 0.5 * (low + high)
            if middle > a.face:
                flow.hot = flow.hot + passed[0] * wp.sqrt(a.density)
            else:
                flow.cold = flow.cold + passed[0] * wp.sqrt(a.air)
                if middle > b.face:
                    flow.under = flow.under + passed[0] * wp.sqrt(a.air)
            if middle > b.face:
                flow.hot_back = flow.hot_back + passed[1] * wp.sqrt(b.density)
            else:
                flow.cold_back = flow.cold_back + passed[1] * wp.sqrt(b.air)
                if middle > a.face:
                    flow.under_back = flow.under_back + passed[1] * wp.sqrt(b.air)
    return flow


@wp.func
def volume(flow: Flow, a: Side, b: Side) -> float:
    """Volume [m^3/s] that a room loses through an opening, that which comes back taken off."""
    return flow.hot / a.density + flow.cold / a.air - flow.hot_back / b.density - flow.cold_back / b.air
