"""How much of a turned box, upright cylinder or ellipsoid is under a sloping surface, and where the middle of that part is.

Boxes and cylinders (axis: the body's z) are cut into 3 x 3 columns along the axis that is steepest to the surface, at nodes that
integrate polynomials of degree 5 exactly over the cross-section: Gauss-Legendre for boxes; for a disc, and for a cylinder on its
side, Gauss-Chebyshev of the second kind across. Each column is immersed by the clipped share below the surface. Exact where the
surface cuts the sides only (wall-sided); else the volume is right to 0.1 % of the box on average, 2 % at worst (physics.md 4.1).
Ellipsoids are exact: they are spheres in coordinates divided by their half edges. Vectors: components first, see hazard_ms.hazards.drag.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.hazards.drag import to_world

BOX, CYLINDER, BALL = 0, 1, 2  # shapes of bodies
FILLS = (1.0, 0.7853982, 0.5235988)  # share of its box that a shape fills: 1, pi / 4, pi / 6

_THIN = 1e-6  # [m] keeps 0 / 0 away where there is no body
_SQUARE = 0.6**0.5  # outer nodes of Gauss and Legendre; their weights are 5, 8, 5 of 18
_ROUND = 0.5**0.5  # outer nodes of Gauss and Chebyshev, for the weight sqrt(1 - x^2); their weights are 1, 2, 1 of 4
_STEEPEST = 0.5 + 0.5 / _ROUND  # mean of 1 / length over the rows of a cylinder on its side


class Immersion(NamedTuple):
    """What is under water of each body."""

    fraction: Tensor  # of the shape's volume, 0 to 1, [...]
    arm: Tensor  # from the body's centre to the middle of the immersed part [m], world frame, [3, ...]; 0 for a dry body
    waterline: Tensor  # fraction gained per metre that the surface rises [1/m], [...]
    steepest: Tensor  # the most that `waterline` can be at this attitude [1/m], [...]


def immersion(height: Tensor, slope: Tensor, axes: Tensor, half: Tensor, shape: Tensor) -> Immersion:
    """What is under a plane surface.

    Args:
        height: Of the surface above the body's centre [m], [...].
        slope: Rise of the surface along x and y [-], [2, ...].
        axes: The body's axes, [3, 3, ...], see hazard_ms.hazards.drag.
        half: Half edges of the body's box [m], [3, ...].
        shape: BOX, CYLINDER or BALL, int64 [...].
    """
    upward = (axes[2] - slope[0] * axes[0] - slope[1] * axes[1]) * half  # how far above the surface each axis' end leads [m]
    reached, middle, waterline, steepest = _columns(height, upward, shape)
    fraction, centre, rising, widest = _ball(height, upward)
    ball = shape == BALL
    arm = to_world(axes, torch.where(ball, centre, middle) * half)
    return Immersion(torch.where(ball, fraction, reached), arm, torch.where(ball, rising, waterline), torch.where(ball, widest, steepest))


class _Grid(NamedTuple):
    """Three rows of three columns: rows lie along the first axis after the long one, columns along the second. In half edges."""

    u: Tensor  # where the outer rows are, [...]
    v: Tensor  # where the outer columns of each row are, [3, ...]
    length: Tensor  # of the middle column of each row, [3, ...]
    outer_length: Tensor  # of its outer columns, [3, ...]
    rows: tuple[Tensor, Tensor, Tensor]  # share of the cross-section of each row, [...]
    columns: tuple[Tensor, Tensor, Tensor]  # of each column of a row, [...]


def _grid(cylinder: Tensor, first: Tensor, second: Tensor) -> _Grid:
    """Of bodies of which axis 0 (`first`), 1 (`second`) or else 2 is the long one; all bool [...]."""
    round_rows, round_columns = cylinder & ~second, cylinder & second
    lying = cylinder & first
    row, column = torch.where(round_rows, 0.25, 5 / 18), torch.where(round_columns, 0.25, 5 / 18)
    length = _three(torch.ones_like(row), torch.where(lying, _ROUND, 1.0))
    return _Grid(
        torch.where(round_rows, _ROUND, _SQUARE),
        _three(torch.where(round_columns, _ROUND, _SQUARE), torch.where(round_rows & ~lying, _ROUND, 1.0)),
        length,
        length * torch.where(round_columns, _ROUND, 1.0),
        (row, 1 - 2 * row, row),
        (column, 1 - 2 * column, column),
    )


def _columns(height: Tensor, upward: Tensor, shape: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Fraction, middle in units of the half edges [3, ...], waterline and its bound, from 3 x 3 columns."""
    size = upward.abs()
    first = (size[0] >= size[1]) & (size[0] >= size[2])
    second = ~first & (size[1] >= size[2])
    cylinder = shape == CYLINDER
    grid = _grid(cylinder, first, second)
    long, one, two = (_turned(upward, first, second, k) for k in range(3))
    span = (2 * long.abs()).clamp(min=_THIN)
    tilt, middle_row = one * grid.u / span, height / span
    level = torch.stack([middle_row + tilt, middle_row, middle_row - tilt])
    lean = two / span * grid.v
    outer = grid.outer_length
    parts = (_column(level + lean, outer), _column(level, grid.length), _column(level - lean, outer))
    of_rows = [_mean(grid.columns, [part[k] for part in parts]) for k in range(3)]
    fraction, along, cut = (_mean(grid.rows, amount) for amount in of_rows)
    across = grid.rows[0] * grid.u * (of_rows[0][2] - of_rows[0][0])
    other = _mean(grid.rows, grid.columns[0] * grid.v * (parts[2][0] - parts[0][0]))
    ordered = torch.stack([torch.where(long < 0, -along, along), across, other]) / fraction.clamp(min=_THIN)
    steepest = torch.where(cylinder & (first | second), _STEEPEST, 1.0) / span
    return fraction, _in_place(ordered, first, second), cut / span, steepest


def _in_place(ordered: Tensor, first: Tensor, second: Tensor) -> Tensor:
    """What stands for the long axis and the two after it, as x, y and z of the body, [3, ...]."""
    along, across, other = ordered
    return torch.stack(
        [_choose(first, second, *three) for three in ((along, other, across), (across, along, other), (other, across, along))]
    )


def _choose(first: Tensor, second: Tensor, a: Tensor, b: Tensor, c: Tensor) -> Tensor:
    """`a` where axis 0 is the long one, `b` where axis 1 is, else `c`, [...]."""
    return torch.where(first, a, torch.where(second, b, c))


def _three(middle: Tensor, factor: Tensor) -> Tensor:
    """What is `middle` in the middle row and `factor` times that in the outer ones, [3, ...]."""
    outer = middle * factor
    return torch.stack([outer, middle, outer])


def _mean(weights: tuple[Tensor, Tensor, Tensor], amounts: Sequence[Tensor] | Tensor) -> Tensor:
    """Of three amounts, each [...], by weight."""
    return weights[0] * amounts[0] + weights[1] * amounts[1] + weights[2] * amounts[2]


def _column(level: Tensor, length: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Of columns: the immersed share, that times how far its middle is down the column, and the share gained per rise of `level`."""
    depth = level / length + 0.5
    immersed = depth.clamp(0, 1)
    return immersed, immersed * (immersed - 1) * length, (immersed == depth) / length


def _turned(three: Tensor, first: Tensor, second: Tensor, k: int) -> Tensor:
    """The component `k` places after the long axis, cyclically, [...]."""
    return _choose(first, second, three[k], three[(1 + k) % 3], three[(2 + k) % 3])


def _ball(height: Tensor, upward: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """As `_columns`, of ellipsoids."""
    reach = (upward[0] * upward[0] + upward[1] * upward[1] + upward[2] * upward[2]).sqrt().clamp(min=_THIN)
    t = (height / reach).clamp(-1, 1)
    outside = 1 - t * t
    cap = 2 + 3 * t - t * t * t  # 4 times the immersed fraction
    centre = -0.75 * outside * outside / cap.clamp(min=_THIN) * (upward / reach)
    return cap / 4, centre, 0.75 * outside / reach, 0.75 / reach
