"""The part of a turned box, upright cylinder or ellipsoid that is under a sloping surface, and its middle (Warp).

Boxes and cylinders (axis: the body's z) are cut into 3 x 3 columns along the axis that is steepest to the surface, at
nodes that integrate polynomials of degree 5 exactly over the cross-section: Gauss-Legendre for boxes; for a disc, and
for a cylinder on its side, Gauss-Chebyshev of the second kind across. Each column is immersed by the clipped share
below the surface. Exact where the surface cuts the sides only (wall-sided); else the volume is right to 0.1 % of the
box on average, 2 % at worst (docs/physics.md 4.1). Ellipsoids are exact: they are spheres in coordinates divided by
their half edges.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

BOX, CYLINDER, BALL = wp.constant(0), wp.constant(1), wp.constant(2)  # shapes of bodies
FILLS = (1.0, 0.7853982, 0.5235988)  # share of its box that a shape fills: 1, pi / 4, pi / 6

_THIN = wp.constant(1e-6)  # least span [m] and fraction [-], so that 0 / 0 cannot occur
_SQUARE = wp.constant(0.6**0.5)  # outer nodes of Gauss and Legendre; their weights are 5, 8, 5 of 18
# outer nodes of Gauss and Chebyshev, for the weight sqrt(1 - x^2); their weights are 1, 2, 1 of 4
_ROUND = wp.constant(0.5**0.5)
_FLAT_SHARE, _ROUND_SHARE = wp.constant(5.0 / 18.0), wp.constant(1.0 / 4.0)  # weights of outer nodes
_STEEPEST = wp.constant(0.5 + 0.5 / 0.5**0.5)  # mean of 1 / length over the rows of a cylinder on its side


@wp.struct
class Immersion:
    """The part of one body that is under water."""

    fraction: float  # of the shape's volume, 0 to 1
    arm: wp.vec3  # from the body's centre to the middle of the immersed part [m], world frame; 0 for a dry body
    waterline: float  # fraction gained per metre that the surface rises [1/m]
    steepest: float  # the most that `waterline` can be at this attitude [1/m]


@wp.func
def immersion(height: float, slope: wp.vec2, axes: wp.mat33, half: wp.vec3, shape: int) -> Immersion:
    """The part of a body that is under a plane surface.

    Args:
        height: Height of the surface above the body's centre [m].
        slope: Rise of the surface along x and y [-].
        axes: Axes of the body, see hazard_ms.simulation.kernels.boxes.
        half: Half edges of the body's box [m].
        shape: BOX, CYLINDER or BALL.
    """
    # how far above the surface each axis' end leads [m]
    upward = wp.cw_mul(wp.vec3(-slope[0], -slope[1], 1.0) * axes, half)
    if shape == BALL:
        return _ball(height, upward, axes, half)
    return _columns(height, upward, axes, half, shape == CYLINDER)


@wp.func
def _columns(height: float, upward: wp.vec3, axes: wp.mat33, half: wp.vec3, cylinder: bool) -> Immersion:
    """Immersion of 3 x 3 columns along the axis `long`; rows go along the next axis, their columns along the third."""
    long = _longest(upward)
    one, two = (long + 1) % 3, (long + 2) % 3
    round_rows, round_columns, lying = cylinder and long != 1, cylinder and long == 1, cylinder and long == 0
    row_place, row_share = _SQUARE, _FLAT_SHARE
    if round_rows:
        row_place, row_share = _ROUND, _ROUND_SHARE
    place, column_share = _SQUARE, _FLAT_SHARE
    if round_columns:
        place, column_share = _ROUND, _ROUND_SHARE
    span = wp.max(2.0 * wp.abs(upward[long]), _THIN)
    fraction, along, cut, of_rows, of_columns = float(0.0), float(0.0), float(0.0), float(0.0), float(0.0)
    for i in range(-1, 2):
        row, share = float(i) * row_place, 1.0 - 2.0 * row_share
        chord, deep = float(1.0), float(1.0)  # half lengths of the row and of its columns, in half edges
        if i != 0:
            share = row_share
            if lying:
                deep = _ROUND
            elif round_rows:
                chord = _ROUND
        for j in range(-1, 2):
            column, weight, length = float(j) * place * chord, share * (1.0 - 2.0 * column_share), deep
            if j != 0:
                weight = share * column_share
                if round_columns:
                    length = _ROUND
            depth = (height - upward[one] * row - upward[two] * column) / (span * length) + 0.5
            under = wp.clamp(depth, 0.0, 1.0)
            fraction += weight * under
            along += weight * length * under * (under - 1.0)
            of_rows += weight * under * row
            of_columns += weight * under * column
            if under == depth:
                cut += weight / length
    middle = wp.vec3()
    middle[long] = along * wp.sign(upward[long])
    middle[one] = of_rows
    middle[two] = of_columns
    found = Immersion()
    found.fraction = fraction
    found.arm = axes * wp.cw_mul(middle / wp.max(fraction, _THIN), half)
    found.waterline = cut / span
    found.steepest = 1.0 / span
    if cylinder and long != 2:
        found.steepest = _STEEPEST / span
    return found


@wp.func
def _longest(upward: wp.vec3) -> int:
    """The axis that leads farthest up or down."""
    x, y, z = wp.abs(upward[0]), wp.abs(upward[1]), wp.abs(upward[2])
    if x >= y and x >= z:
        return 0
    if z > y:
        return 2
    return 1


@wp.func
def _ball(height: float, upward: wp.vec3, axes: wp.mat33, half: wp.vec3) -> Immersion:
    """Immersion of an ellipsoid."""
    reach = wp.max(wp.length(upward), _THIN)
    t = wp.clamp(height / reach, -1.0, 1.0)
    outside = 1.0 - t * t
    cap = (3.0 - t * t) * t + 2.0  # 4 times the immersed fraction
    found = Immersion()
    found.fraction = cap / 4.0
    found.steepest = 0.75 / reach
    found.waterline = outside * found.steepest
    found.arm = axes * wp.cw_mul(upward * (-found.waterline * outside / wp.max(cap, _THIN)), half)
    return found
