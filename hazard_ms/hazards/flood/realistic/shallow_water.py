"""Shallow water on a grid of cells: mass and momentum of a depth-averaged flow (Warp, one thread per environment).

    dh/dt + div(h u) = 0
    du/dt + (u . grad) u + g grad(z + h) + g n^2 |u| u / h^(4/3) = 0          z: ground, n: Manning's (.floors)

The scheme is the momentum-conserving one of Stelling and Duinmeijer, A staggered conservative scheme for every Froude
number in rapidly varied shallow water flows, Int. J. Numer. Meth. Fluids 43, 2003: depths in cells, velocities on their
sides, depths on sides taken from upstream, momentum carried by the mean discharge of neighbouring sides, first
velocities and then depths. Where the flow speeds up along its way its energy head is carried in place of its momentum,
as the paper has it for contractions, which keeps fronts on dry ground fast. Water at rest stays at rest. Steps of
ground are seen from the higher side. Cells give no more than they hold. Sums of depth are compensated (Kahan).

A step is as long as the fastest wave allows; the water is ahead of the frame by less than one. Order: 1. Limits: no
turbulence, bodies do not act back.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.flood.realistic.basin import (
    FASTEST,
    FENCE,
    FILM,
    GRAVITY,
    SAFE,
    SIDE,
    Basin,
    note,
    per_cube_root,
)
from hazard_ms.hazards.flood.realistic.inlets import hold_back, let_in, orifice
from hazard_ms.simulation.kernels.launch import OPTIONS
from hazard_ms.simulation.kernels.rows import at, put

wp.set_module_options(OPTIONS)

STILL = wp.constant(5e-7)  # difference of levels that is rounding [m]


@wp.func
def pushed(
    e: int,
    c: int,
    along: int,
    across: int,
    ratio: float,
    friction: float,
    own: wp.array2d(dtype=float),
    other: wp.array2d(dtype=float),
    carried: wp.array2d(dtype=float),
    beside: wp.array2d(dtype=float),
    height: wp.array2d(dtype=float),
    bed: wp.array2d(dtype=float),
    depth: wp.array2d(dtype=float),
) -> float:
    """New velocity [m/s] through the side of cell `c` towards the cell before it.

    `own` and `carried`: velocity [m/s] and discharge [m^2/s] along that axis, on which neighbours are `along` numbers
    apart; `other` and `beside`: those of the other axis, `across`; `height`: of the opening [m]; `friction`: g n^2
    [m^(1/3)]; `ratio`: time over length of the step [s/m].
    """
    b = c - along
    if wp.max(at(depth, e, b), at(depth, e, c)) <= 0.0:
        return 0.0
    ground = wp.max(at(bed, e, b), at(bed, e, c))
    low = wp.max(at(bed, e, b) - ground + at(depth, e, b), 0.0)
    high = wp.max(at(bed, e, c) - ground + at(depth, e, c), 0.0)
    if wp.max(low, high) < FILM:
        return 0.0
    deep = 0.5 * (low + high)
    if wp.min(low, high) <= 0.0:  # at a front, all of the mass is on one side
        deep = wp.max(low, high)
    u, before, after, share = at(own, e, c), at(own, e, c - along), at(own, e, c + along), 0.5 * ratio / deep
    rise = high - low
    if wp.abs(rise) < STILL:
        rise = float(0.0)
    # what comes in over the mass between the middles of the two cells; of deep cells only what is above the step
    over_b, over_c = share, share
    if at(bed, e, b) < ground:
        over_b = share * low / wp.max(at(depth, e, b), FILM)
    if at(bed, e, c) < ground:
        over_c = share * high / wp.max(at(depth, e, c), FILM)
    west = over_b * wp.max(at(carried, e, b) + at(carried, e, c), 0.0)
    if u > before and u + before > 0.0:  # it speeds up: half the difference of the squares, of the energy head
        west = 0.5 * ratio * (u + before)
    east = -over_c * wp.min(at(carried, e, c) + at(carried, e, c + along), 0.0)
    if u < after and u + after < 0.0:
        east = -0.5 * ratio * (u + after)
    south = wp.max(over_b * at(beside, e, b) + over_c * at(beside, e, c), 0.0)
    north = -wp.min(over_b * at(beside, e, b + across) + over_c * at(beside, e, c + across), 0.0)
    come = west * (u - before) + east * (u - after)
    come += south * (u - at(own, e, c - across)) + north * (u - at(own, e, c + across))
    whole = west + east + south + north
    if whole > 1.0:
        come = come / whole
    slip = 0.25 * (at(other, e, b) + at(other, e, c) + at(other, e, b + across) + at(other, e, c + across))
    over = low  # depth of what runs over the floor: that upstream, as of the discharge
    if u < 0.0:
        over = high
    if over < FILM:
        over = deep
    held = ratio * SIDE * friction * wp.sqrt(u * u + slip * slip) * per_cube_root(over)  # implicit, by Manning
    new = wp.clamp((u - come - ratio * GRAVITY * rise) * over / (over + held), -FASTEST / ratio, FASTEST / ratio)
    clear = at(height, e, c) - ground
    if new > 0.0 and low > clear:  # the opening is under water
        new = wp.min(new, orifice(clear, low - high) / low)
    if new < 0.0 and high > clear:
        new = wp.max(new, -orifice(clear, high - low) / high)
    return new


@wp.func
def taken(e: int, c: int, along: int, u: float, bed: wp.array2d(dtype=float), depth: wp.array2d(dtype=float)) -> float:
    """Discharge [m^2/s] through the side of cell `c` towards the cell before it, at the velocity `u` [m/s]."""
    if u == 0.0:
        return 0.0
    b = c - along
    ground = wp.max(at(bed, e, b), at(bed, e, c))
    if u > 0.0:
        return u * wp.max(at(bed, e, b) + at(depth, e, b) - ground, 0.0)
    return u * wp.max(at(bed, e, c) + at(depth, e, c) - ground, 0.0)


@wp.func
def limit(e: int, c: int, pitch: int, ratio: float, basin: Basin):
    """Let a cell lose no more than it holds."""
    held = at(basin.depth, e, c)
    if held <= 0.0:  # nothing leaves it
        return
    west, east = at(basin.discharge_x, e, c), at(basin.discharge_x, e, c + pitch)
    south, north = at(basin.discharge_y, e, c), at(basin.discharge_y, e, c + 1)
    lost = ratio * (wp.max(east, 0.0) - wp.min(west, 0.0) + wp.max(north, 0.0) - wp.min(south, 0.0))
    if lost > held:
        share = held / lost
        if east > 0.0:
            put(basin.discharge_x, e, c + pitch, east * share)
        if west < 0.0:
            put(basin.discharge_x, e, c, west * share)
        if north > 0.0:
            put(basin.discharge_y, e, c + 1, north * share)
        if south < 0.0:
            put(basin.discharge_y, e, c, south * share)


@wp.func
def fill(e: int, c: int, pitch: int, ratio: float, basin: Basin):
    """Add what comes into a cell, less what leaves it, to its depth."""
    gain = at(basin.discharge_x, e, c) - at(basin.discharge_x, e, c + pitch)
    gain = ratio * (gain + at(basin.discharge_y, e, c) - at(basin.discharge_y, e, c + 1))
    if gain != 0.0 and at(basin.bed, e, c) < FENCE:  # not behind an opening of a smaller scene of the batch
        before = at(basin.depth, e, c)
        part = gain + at(basin.depth_rest, e, c)
        after = wp.max(before + part, 0.0)
        put(basin.depth_rest, e, c, part - (after - before))
        put(basin.depth, e, c, after)


@wp.kernel
def flow(
    dt: float,
    outside: float,
    rows: int,
    columns: int,
    basin: Basin,
    new_x: wp.array2d(dtype=float),
    new_y: wp.array2d(dtype=float),
):
    """Advance the water to `dt` [s] from now or beyond by less than a step, if it is not there.

    `outside`: its depth outside the openings [m]; cells: `rows` by `columns`.
    """
    e = wp.tid()
    pitch = columns + 2
    left = dt - basin.ahead[e]
    if left <= 0.0:
        basin.ahead[e] = -left
        return
    step = SAFE * SIDE / wp.max(basin.signal[e], SAFE * SIDE / dt)
    steps = int(wp.ceil(left / step))
    basin.ahead[e] = wp.max(float(steps) * step - left, 0.0)
    ratio = step / SIDE
    came = wp.float64(0.0)
    for _k in range(steps):
        for i in range(1, rows + 1):
            for j in range(1, columns + 1):
                c = i * pitch + j
                west, south = float(0.0), float(0.0)
                if at(basin.open_x, e, c) > 0.0:
                    west = pushed(
                        e,
                        c,
                        pitch,
                        1,
                        ratio,
                        basin.friction[e],
                        basin.velocity_x,
                        basin.velocity_y,
                        basin.discharge_x,
                        basin.discharge_y,
                        basin.open_x,
                        basin.bed,
                        basin.depth,
                    )
                if at(basin.open_y, e, c) > 0.0:
                    south = pushed(
                        e,
                        c,
                        1,
                        pitch,
                        ratio,
                        basin.friction[e],
                        basin.velocity_y,
                        basin.velocity_x,
                        basin.discharge_y,
                        basin.discharge_x,
                        basin.open_y,
                        basin.bed,
                        basin.depth,
                    )
                put(new_x, e, c, west)
                put(new_y, e, c, south)
        for i in range(1, rows + 1):
            for j in range(1, columns + 1):
                c = i * pitch + j
                west, south = at(new_x, e, c), at(new_y, e, c)
                if west != 0.0 or at(basin.velocity_x, e, c) != 0.0:
                    put(basin.velocity_x, e, c, west)
                    put(basin.discharge_x, e, c, taken(e, c, pitch, west, basin.bed, basin.depth))
                if south != 0.0 or at(basin.velocity_y, e, c) != 0.0:
                    put(basin.velocity_y, e, c, south)
                    put(basin.discharge_y, e, c, taken(e, c, 1, south, basin.bed, basin.depth))
        hold_back(e, pitch, basin)
        came += wp.float64(let_in(e, step, outside, pitch, basin))
        for i in range(1, rows + 1):
            for j in range(1, columns + 1):
                limit(e, i * pitch + j, pitch, ratio, basin)
        for i in range(1, rows + 1):
            for j in range(1, columns + 1):
                fill(e, i * pitch + j, pitch, ratio, basin)
    part = float(came) + basin.inflow_rest[e]
    total = basin.inflow[e] + part
    basin.inflow_rest[e] = part - (total - basin.inflow[e])
    basin.inflow[e] = total
    note(e, rows, columns, outside, basin)


def wave(depth: float) -> float:
    """Speed by which the waves of both axes pass cells in water of `depth` [m] [m/s]."""
    return (2.0 * 9.81 * depth) ** 0.5
