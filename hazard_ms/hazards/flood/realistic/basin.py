"""The grid of a flood in kernels, the surface of its water, and what a place in it feels (Warp)."""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.flood.realistic.floor_plan import BEYOND, CELL
from hazard_ms.simulation.kernels.launch import OPTIONS
from hazard_ms.simulation.kernels.rows import at, put

wp.set_module_options(OPTIONS)

GRAVITY = wp.constant(9.81)  # [m/s^2]
SIDE = wp.constant(CELL)
DRY = wp.constant(1e-4)  # depth below which water is not seen [m] [ours]
FILM = wp.constant(1e-5)  # depth below which water does not flow [m] [ours]
SAFE = wp.constant(0.8)  # share of a cell that the fastest wave may pass in a step; short waves grow from 0.9 on [ours]
FASTEST = wp.constant(0.6)  # share of a cell that water may pass in a step [ours]
GROWTH = wp.constant(1.25)  # by which it may be faster in the next frame without being held back [ours]
NOWHERE = wp.constant(-1.0)  # surface where there is no water [m]
FENCE = wp.constant(0.5 * BEYOND)  # ground that is higher is not floor [m]
WAVES = wp.constant(2.0**0.5)  # waves of both axes add up
TINY = wp.constant(1e-6)  # least weight, so that 0 / 0 cannot occur


@wp.struct
class Basin:
    """The fields of InundationState with the same names."""

    bed: wp.array2d(dtype=float)
    open_x: wp.array2d(dtype=float)
    open_y: wp.array2d(dtype=float)
    depth: wp.array2d(dtype=float)
    depth_rest: wp.array2d(dtype=float)
    velocity_x: wp.array2d(dtype=float)
    velocity_y: wp.array2d(dtype=float)
    discharge_x: wp.array2d(dtype=float)
    discharge_y: wp.array2d(dtype=float)
    surface: wp.array2d(dtype=float)
    inlet: wp.array2d(dtype=wp.int64)
    inlet_side: wp.array2d(dtype=wp.int64)
    inlet_beside: wp.array2d(dtype=wp.int64)
    inlet_width: wp.array2d(dtype=float)
    inlet_height: wp.array2d(dtype=float)
    dammed: wp.array2d(dtype=float)
    door: wp.array2d(dtype=wp.int64)
    door_side: wp.array2d(dtype=wp.int64)
    door_height: wp.array2d(dtype=float)
    door_dammed: wp.array2d(dtype=float)
    friction: wp.array(dtype=float)
    inflow: wp.array(dtype=float)
    inflow_rest: wp.array(dtype=float)
    signal: wp.array(dtype=float)
    ahead: wp.array(dtype=float)
    level: wp.array(dtype=float)


@wp.struct
class Here:
    """The water at one place."""

    level: float  # height of its surface [m], NOWHERE where it is dry
    slope: wp.vec2  # rise of the surface along x and y [-]
    velocity: wp.vec2  # mean over its depth [m/s]


@wp.func
def here(e: int, x: float, y: float, rows: int, columns: int, basin: Basin) -> Here:
    """The water at the place `x`, `y` [m]: surface and velocity between the middles and the sides of cells."""
    found = Here()
    pitch = columns + 2
    u, v = x / SIDE, y / SIDE
    i = wp.clamp(int(wp.floor(u)), 0, rows - 1)
    j = wp.clamp(int(wp.floor(v)), 0, columns - 1)
    c = (i + 1) * pitch + j + 1
    # the cell's own surface, and those of the neighbours on the side of the place
    right = wp.clamp(u - float(i), 0.0, 1.0)
    up = wp.clamp(v - float(j), 0.0, 1.0)
    along, beside = pitch, 1
    if right < 0.5:
        along = -pitch
    if up < 0.5:
        beside = -1
    toward_x, toward_y = wp.abs(right - 0.5), wp.abs(up - 0.5)
    level, weight = float(0.0), float(0.0)
    for k in range(4):
        other, share = c, (1.0 - toward_x) * (1.0 - toward_y)
        if k == 1:
            other, share = c + along, toward_x * (1.0 - toward_y)
        if k == 2:
            other, share = c + beside, (1.0 - toward_x) * toward_y
        if k == 3:
            other, share = c + along + beside, toward_x * toward_y
        if basin.surface[e, other] > 0.0:
            level += share * basin.surface[e, other]
            weight += share
    found.level = NOWHERE
    if weight < TINY:
        return found
    found.level = level / weight
    found.slope = wp.vec2(rise(e, c, pitch, basin), rise(e, c, 1, basin))
    if basin.depth[e, c] >= DRY:
        found.velocity = wp.vec2(
            basin.velocity_x[e, c] * (1.0 - right) + basin.velocity_x[e, c + pitch] * right,
            basin.velocity_y[e, c] * (1.0 - up) + basin.velocity_y[e, c + 1] * up,
        )
    return found


@wp.func
def rise(e: int, c: int, along: int, basin: Basin) -> float:
    """Slope of the surface at a cell towards where neighbours are `along` numbers apart; 0 beside dry ones [-]."""
    before, after = basin.surface[e, c - along], basin.surface[e, c + along]
    if before <= 0.0 or after <= 0.0:
        return 0.0
    return (after - before) / (2.0 * SIDE)


@wp.func_native(
    "union { float number; unsigned int bits; } guess; guess.number = value;"
    " guess.bits = 0x54a2fa8cu - guess.bits / 3u; float y = guess.number;"
    " y = y * (1.33333334f - 0.333333333f * value * y * y * y);"  # Newton's steps
    " return y * (1.33333334f - 0.333333333f * value * y * y * y);"
)
def per_cube_root(value: float) -> float:
    """One over the cube root of a positive number, within 1e-5; wp.pow takes several times as long."""
    ...


@wp.func
def note(e: int, rows: int, columns: int, outside: float, basin: Basin):
    """Write the surface, its mean height, and the speed of the fastest wave.

    Within furniture that water does not stand above, it stands as high as around it, one cell farther each frame.
    """
    pitch = columns + 2
    fastest, total, wet = WAVES * wp.sqrt(GRAVITY * outside), float(0.0), float(0.0)
    for i in range(1, rows + 1):
        for j in range(1, columns + 1):
            c = i * pitch + j
            deep = at(basin.depth, e, c)
            if deep >= DRY:
                put(basin.surface, e, c, at(basin.bed, e, c) + deep)
                total += at(basin.surface, e, c)
                wet += 1.0
                speed = wp.max(wp.abs(at(basin.velocity_x, e, c)), wp.abs(at(basin.velocity_y, e, c)))
                wave = speed + WAVES * wp.sqrt(GRAVITY * deep)
                fastest = wp.max(fastest, wp.max(speed * (GROWTH * SAFE / FASTEST), wave))
            elif at(basin.bed, e, c) > 0.0 and at(basin.bed, e, c) < FENCE:
                around, count = float(0.0), float(0.0)
                for k in range(4):
                    other = c + pitch
                    if k == 1:
                        other = c - pitch
                    if k == 2:
                        other = c + 1
                    if k == 3:
                        other = c - 1
                    if at(basin.surface, e, other) > 0.0:
                        around += at(basin.surface, e, other)
                        count += 1.0
                if count > 0.0:
                    put(basin.surface, e, c, wp.min(around / count, at(basin.bed, e, c)))
            else:
                put(basin.surface, e, c, NOWHERE)
    basin.signal[e] = fastest
    basin.level[e] = total / wp.max(wet, 1.0)
