"""Kernels of hazard_ms.hazards.wind.shelter, one thread per cell of a map (Warp).

The wake of an obstacle of height H at the distance x behind it, for air at the height z [Taylor & Salmon 1993, A model
for the correction of surface wind data for sheltering by upwind obstacles; for a long fence it is that of Perera 1981]:

    loss of wind / wind at H = 12.19 C (H / x) eta exp(-0.67 eta^1.5) s
    eta = (z / H) (ln((H + z0) / z0) / (2 k^2) H / x)^(1 / (n + 2)),   n = 1 / 7

s is the share of a Gaussian of the deviation H sqrt(x / H) / 2 across the wind that the obstacle's width covers. C is
0.8 for fences, less for blunt blocks.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.wind.air import CELL
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

STRENGTH = wp.constant(9.75 / 0.8)  # of a wake [-] [Taylor & Salmon 1993; Perera 1981]
SPREAD = wp.constant(0.5)  # deviation of a wake across the wind, in sqrt(x H) [Taylor & Salmon 1993]
GROWTH = wp.constant(1.0 / (2.0 + 1.0 / 7.0))  # exponent of the height of a wake [Taylor & Salmon 1993]
TWICE_KARMAN_SQUARED = wp.constant(2.0 * 0.4**2)
ROUGHNESS = wp.constant(0.03)  # of open ground [m] [docs/physics.md 3.3]
# Height at which the loss is worked out, in heights of the obstacle: below, the small changes that the theory is made
# for end at the ground itself [ours]
LEVEL = wp.constant(0.25)
LOWER = wp.constant(0.5)  # what is lower than this share of an obstacle does not make it wider [ours]


@wp.func
def over_roughness(height: float) -> float:
    """Logarithm of a height [m] in roughness lengths: the wind there in units of 2.5 friction velocities."""
    return wp.log((height + ROUGHNESS) / ROUGHNESS)


@wp.func
def deficit(distance: float, height: float, coefficient: float, left: float, right: float) -> float:
    """Share of the wind that is lost near the ground, `distance` [m] behind an obstacle of `height` [m].

    `coefficient` is its C [-]; its ends are `left` and `right` of the line upwind [m].
    """
    far = distance / height
    eta = LEVEL * wp.pow(over_roughness(height) / (TWICE_KARMAN_SQUARED * far), GROWTH)
    wide = wp.sqrt(2.0 * far) * SPREAD * height
    covered = 0.5 * (wp.erf(left / wide) + wp.erf(right / wide))
    there = over_roughness(height) / over_roughness(LEVEL * height)
    return STRENGTH * coefficient / far * eta * wp.exp(-0.67 * eta * wp.sqrt(eta)) * covered * there


@wp.func
def aside(heading: wp.vec2, x: int, y: int) -> float:
    """Place of a cell across the wind [m], to the left of its `heading`."""
    return CELL * (heading[0] * float(y) - heading[1] * float(x))


@wp.kernel
def widen(
    heading: wp.array(dtype=wp.vec2),
    height: wp.array3d(dtype=float),
    right: wp.array3d(dtype=float),
    left: wp.array3d(dtype=float),
    new_right: wp.array3d(dtype=float),
    new_left: wp.array3d(dtype=float),
):
    """Write the ends of each obstacle across the wind [m], as far as they are known to the cells around each cell."""
    n, y, x = wp.tid()
    here = height[n, y, x]
    lowest, highest = float(right[n, y, x]), float(left[n, y, x])
    if here > 0.0:
        lowest = wp.min(lowest, aside(heading[n], x, y))
        highest = wp.max(highest, aside(heading[n], x, y))
        for k in range(9):
            j, i = y + k / 3 - 1, x + k % 3 - 1
            if j >= 0 and j < height.shape[1] and i >= 0 and i < height.shape[2]:
                if height[n, j, i] > LOWER * here:
                    lowest = wp.min(lowest, right[n, j, i])
                    highest = wp.max(highest, left[n, j, i])
    new_right[n, y, x] = lowest
    new_left[n, y, x] = highest


@wp.kernel
def lee(
    most: float,
    heading: wp.array(dtype=wp.vec2),
    height: wp.array3d(dtype=float),
    solidity: wp.array3d(dtype=float),
    coefficient: wp.array3d(dtype=float),
    right: wp.array3d(dtype=float),
    left: wp.array3d(dtype=float),
    loss: wp.array3d(dtype=float),
    cause: wp.array3d(dtype=float),
):
    """Write the deepest loss of wind [-] at each cell, and the height of what causes it [m]: one ray upwind.

    A solid obstacle takes at `most` this share of the wind.
    """
    n, y, x = wp.tid()
    worst, high = float(0.0), float(0.0)
    half = 0.5 * CELL
    for step in range(1, height.shape[1] + height.shape[2]):
        i = int(wp.rint(float(x) - float(step) * heading[n][0]))
        j = int(wp.rint(float(y) - float(step) * heading[n][1]))
        if i >= 0 and i < height.shape[2] and j >= 0 and j < height.shape[1] and height[n, j, i] > 0.0:
            here = aside(heading[n], x, y)
            to_left = wp.max(left[n, j, i] - here + half, 0.0)
            to_right = wp.max(here - right[n, j, i] + half, 0.0)
            new = deficit(CELL * float(step), height[n, j, i], coefficient[n, j, i], to_left, to_right)
            new = wp.min(new, most * solidity[n, j, i])
            if new > worst:
                worst = new
                high = height[n, j, i]
    loss[n, y, x] = worst
    cause[n, y, x] = high
