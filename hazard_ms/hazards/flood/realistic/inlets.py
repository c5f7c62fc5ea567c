"""Water that comes in through openings, from a depth outside of them that stays (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.flood.realistic.basin import GRAVITY, SIDE, Basin
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

WEIR = wp.constant(0.4 * (2.0 * 9.81) ** 0.5)  # discharge per width of a free weir over head^1.5 [m^0.5/s] [L-28]
ORIFICE = wp.constant(0.611)  # contraction by sharp edges, pi / (pi + 2) [Kirchhoff 1869]
HALVINGS = wp.constant(16)  # of the range in which the depth inside is looked for
DROWNING = wp.constant(0.385)  # exponent for submerged weirs [Villemonte 1947]


@wp.func
def weir(outside: float, inside: float) -> float:
    """Discharge per width [m^2/s] into water `inside` [m] deep from water `outside` [m], Villemonte's if submerged."""
    if outside <= inside:
        return 0.0
    free = WEIR * outside * wp.sqrt(outside)
    if inside <= 0.0:
        return free
    part = inside / outside
    return free * wp.pow(1.0 - part * wp.sqrt(part), DROWNING)


@wp.func
def orifice(height: float, fall: float) -> float:
    """Discharge per width [m^2/s] through an opening `height` [m] high under water, whose level falls by `fall` [m]."""
    return ORIFICE * wp.max(height, 0.0) * wp.sqrt(2.0 * GRAVITY * wp.max(fall, 0.0))


@wp.func
def through(outside: float, inside: float, clear: float) -> float:
    """Discharge per width [m^2/s] inwards through an opening `clear` [m] high between water of these depths [m]."""
    q = weir(outside, inside) - weir(inside, outside)
    if wp.max(outside, inside) > clear:
        most = orifice(clear, wp.abs(outside - inside))
        q = wp.clamp(q, -most, most)
    return q


@wp.kernel
def leak(
    before: wp.array2d(dtype=float),
    behind: wp.array2d(dtype=float),
    width: wp.array2d(dtype=float),
    height: wp.array2d(dtype=float),
    sill: wp.array2d(dtype=float),
    discharge: wp.array2d(dtype=float),
):
    """Write the discharge [m^3/s] through openings [m] from water of the depth `before` to that `behind` [m]."""
    e, k = wp.tid()
    low = sill[e, k]
    q = through(wp.max(before[e, k] - low, 0.0), wp.max(behind[e, k] - low, 0.0), height[e, k])
    discharge[e, k] = q * width[e, k]


@wp.func
def left_open(width: float, dammed: float) -> float:
    """Width [m] of an opening of `width` [m] that floating furniture leaves; `dammed`: the share that it covers."""
    return width * (1.0 - dammed)


@wp.func
def hold_back(e: int, pitch: int, basin: Basin):
    """Let no more through inner doorways than a weir or orifice as wide as furniture in them leaves."""
    for k in range(basin.door.shape[1]):
        c = int(basin.door[e, k])
        if c >= 0 and basin.door_dammed[e, k] > 0.0:
            before = c - pitch
            if basin.door_side[e, k] == wp.int64(2):
                before = c - 1
            q = through(basin.depth[e, before], basin.depth[e, c], basin.door_height[e, k])
            most = left_open(wp.abs(q), basin.door_dammed[e, k])
            if basin.door_side[e, k] == wp.int64(2):
                basin.discharge_y[e, c] = wp.clamp(basin.discharge_y[e, c], -most, most)
            else:
                basin.discharge_x[e, c] = wp.clamp(basin.discharge_x[e, c], -most, most)


@wp.func
def let_in(e: int, dt: float, outside: float, pitch: int, basin: Basin) -> float:
    """Set velocities and discharges at the inlets; returns what comes in, less what leaves, during `dt` [m^3].

    What comes in is that of a weir before the water beside the opening, where the room's own level presses: the cells
    of the opening hold the jet. They are filled no higher than the water stands outside. What leaves is that at their
    depth after `dt`, since it changes without limit where both depths are alike.
    """
    volume, ratio = float(0.0), dt / SIDE
    for k in range(basin.inlet.shape[1]):
        c = int(basin.inlet[e, k])
        if c >= 0:
            head = wp.max(outside - basin.bed[e, c], 0.0)
            clear = wp.max(basin.inlet_height[e, k] - basin.bed[e, c], 0.0)
            share = left_open(basin.inlet_width[e, k], basin.dammed[e, k]) / SIDE
            side = int(basin.inlet_side[e, k])
            sign, at = float(1.0), c
            if side == 1 or side == 3:
                sign = float(-1.0)
            if side == 1:
                at = c + pitch
            if side == 3:
                at = c + 1
            if side < 2:
                basin.discharge_x[e, at] = 0.0
            else:
                basin.discharge_y[e, at] = 0.0
            others = basin.discharge_x[e, c] - basin.discharge_x[e, c + pitch]
            others += basin.discharge_y[e, c] - basin.discharge_y[e, c + 1]
            before = basin.depth[e, c] + ratio * others
            beside = int(basin.inlet_beside[e, k])
            tail = wp.max(basin.bed[e, beside] + basin.depth[e, beside] - basin.bed[e, c], 0.0)
            q = through(head, wp.min(tail, head), clear)
            inside = before + ratio * share * q
            if before > head:
                inside = drained(before, head, clear, ratio * share)
                q = through(head, inside, clear)
            elif inside > head:
                inside = head
                q = (head - before) / (ratio * share)
            deep = wp.max(wp.pow(q * q / GRAVITY, 1.0 / 3.0), inside)  # the critical depth, or that inside
            if clear < head and wp.abs(q) < weir(head, tail):
                deep = ORIFICE * clear  # of the jet
            q *= share
            speed = float(0.0)
            if q != 0.0:
                speed = q / deep
            if side < 2:
                basin.velocity_x[e, at] = sign * speed
                basin.discharge_x[e, at] = sign * q
            else:
                basin.velocity_y[e, at] = sign * speed
                basin.discharge_y[e, at] = sign * q
            volume += q * SIDE * dt
    return volume


@wp.func
def drained(before: float, outside: float, clear: float, ratio: float) -> float:
    """Depth [m] of a cell after a step in which it runs off outwards, from `before` [m]; `ratio` [s/m] of the step."""
    low, high = outside, before
    for _k in range(HALVINGS):
        middle = 0.5 * (low + high)
        if before + ratio * through(outside, middle, clear) > middle:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
