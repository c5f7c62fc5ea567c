"""Water that comes in through openings, from a depth outside of them that stays (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.flood.realistic.basin import GRAVITY, SIDE, Basin
from hazard_ms.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

WEIR = wp.constant(0.4 * (2.0 * 9.81) ** 0.5)  # discharge per width of a free weir over head^1.5 [m^0.5/s] [L-28]
DROWNING = wp.constant(0.385)  # exponent for submerged weirs [Villemonte 1947]


@wp.func
def weir(outside: float, inside: float) -> float:
    """Discharge per width [m^2/s] into water `inside` [m] deep from water `outside` [m], Villemonte's if submerged."""
    if outside <= inside:
        return 0.0
    free = WEIR * outside * wp.sqrt(outside)
    if inside <= 0.0:
        return free
    return free * wp.pow(1.0 - wp.pow(inside / outside, 1.5), DROWNING)


@wp.func
def let_in(e: int, dt: float, outside: float, pitch: int, basin: Basin) -> float:
    """Set velocities and discharges at the inlets; returns what comes in, less what leaves, during `dt` [m^3]."""
    volume = float(0.0)
    for k in range(basin.inlet.shape[1]):
        c = int(basin.inlet[e, k])
        if c >= 0:
            inside = basin.depth[e, c]
            head = wp.max(outside - basin.bed[e, c], 0.0)
            q = (weir(head, inside) - weir(inside, head)) * basin.inlet_width[e, k] / SIDE
            speed = float(0.0)
            if q != 0.0:  # at the critical depth, or the depth inside
                speed = q / wp.max(wp.pow(q * q / GRAVITY, 1.0 / 3.0), inside)
            side = int(basin.inlet_side[e, k])
            sign = float(1.0)
            at = c
            if side == 1 or side == 3:
                sign = float(-1.0)
            if side == 1:
                at = c + pitch
            if side == 3:
                at = c + 1
            if side < 2:
                basin.velocity_x[e, at] = sign * speed
                basin.discharge_x[e, at] = sign * q
            else:
                basin.velocity_y[e, at] = sign * speed
                basin.discharge_y[e, at] = sign * q
            volume += q * SIDE * dt
    return volume
