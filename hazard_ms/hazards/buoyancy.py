"""How much of a turned box, upright cylinder or ellipsoid is under a sloping surface, and where the middle of that part is.

Boxes and cylinders (axis: the body's z) are cut into 3 x 3 columns along the axis that is steepest to the surface, at nodes that
integrate polynomials of degree 5 exactly over the cross-section: Gauss-Legendre for boxes; for a disc, and for a cylinder on its
side, Gauss-Chebyshev of the second kind across. Each column is immersed by the clipped share below the surface. Exact where the
surface cuts the sides only (wall-sided); else the volume is right to 0.1 % of the box on average, 2 % at worst (physics.md 4.1).
Ellipsoids are exact: they are spheres in coordinates divided by their half edges. Vectors: components first, see hazard_ms.hazards.drag.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.hazards.base import nobody
from hazard_ms.hazards.drag import to_world

BOX, CYLINDER, BALL = 0, 1, 2  # shapes of bodies
FILLS = (1.0, 0.7853982, 0.5235988)  # share of its box that a shape fills: 1, pi / 4, pi / 6

_BLOCK = 2**12  # bodies worked on at a time on a CPU: they stay in its cache
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
    if height.is_cuda or height.numel() <= _BLOCK:
        return _immersion(height, slope, axes, half, shape)
    some = max(1, _BLOCK * len(height) // height.numel())
    parts = zip(height.split(some), slope.split(some, 1), axes.split(some, 2), half.split(some, 1), shape.split(some), strict=True)
    fraction, arm, waterline, steepest = zip(*(_immersion(*part) for part in parts), strict=True)
    return Immersion(torch.cat(fraction), torch.cat(arm, 1), torch.cat(waterline), torch.cat(steepest))


def _immersion(height: Tensor, slope: Tensor, axes: Tensor, half: Tensor, shape: Tensor) -> Immersion:
    """`immersion` of all bodies at once."""
    (x, y, z), (east, north) = axes.unbind(), slope.unbind()
    upward = (z - east * x).sub_(north * y).mul_(half)  # how far above the surface each axis' end leads [m]
    fraction, middle, waterline, steepest = _columns(height, upward, shape == CYLINDER)
    ball = shape == BALL
    if not nobody(ball & (fraction > 0)):  # columns of its box reach lower than a ball: where they are dry, so is it
        reached, centre, rising, widest = _ball(height, upward)
        fraction, middle = torch.where(ball, reached, fraction), torch.where(ball, centre, middle)
        waterline, steepest = torch.where(ball, rising, waterline), torch.where(ball, widest, steepest)
    return Immersion(fraction, to_world(axes, middle * half), waterline, steepest)


class _Tables(NamedTuple):
    """What 3 x 3 columns are like, by the long axis of a body (0, 1, 2) and 3 more for cylinders; in half edges.

    Rows lie along the first axis after the long one, columns along the second.
    """

    numbers: Tensor  # rows' place; columns' place in each row; columns' 1 / length, [9]; weights of the three amounts, [27]; [6, 40]
    turn: Tensor  # the long axis and the two after it, int64, [3, 6]


@functools.lru_cache(maxsize=8)
def _tables(device: torch.device) -> _Tables:
    """The same at every call, so made once per device."""
    made = [_numbers(long, cylinder) for cylinder in (False, True) for long in range(3)]
    turn = [[(long + k) % 3 for _ in range(2) for long in range(3)] for k in range(3)]
    return _Tables(torch.tensor(made, device=device), torch.tensor(turn, device=device))


def _numbers(long: int, cylinder: bool) -> list[float]:
    """A row of `_Tables.numbers`."""
    round_rows, round_columns, lying = cylinder and long != 1, cylinder and long == 1, cylinder and long == 0
    row, column = (1 / 4 if round_rows else 5 / 18), (1 / 4 if round_columns else 5 / 18)
    outer_row, outer_column = (1.0, _ROUND if round_rows and not lying else 1.0), (1.0, _ROUND if round_columns else 1.0)
    ends, sides = (1.0, _ROUND if lying else 1.0), (1, 0, 1)  # which are outer ones
    length = [ends[r] * outer_column[c] for c in sides for r in sides]
    share = [(row if r else 1 - 2 * row) * (column if c else 1 - 2 * column) for c in sides for r in sides]
    place = [(_ROUND if round_columns else _SQUARE) * outer_row[r] for r in sides]
    weights = [*share, *(w * s for w, s in zip(share, length, strict=True)), *(w / s for w, s in zip(share, length, strict=True))]
    return [_ROUND if round_rows else _SQUARE, *place, *(1 / s for s in length), *weights]


def _columns(height: Tensor, upward: Tensor, cylinder: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Fraction, middle in units of the half edges [3, ...], waterline and its bound, from 3 x 3 columns."""
    tables = _tables(height.device)
    x, y, z = upward.abs().unbind()
    kind = ((x < torch.maximum(y, z)) * ((z > y) + 1)).add_(cylinder, alpha=3)
    turn = tables.turn[:, kind]
    long, one, two = upward.gather(0, turn).unbind()
    numbers = tables.numbers.index_select(0, kind.flatten()).T.contiguous().unflatten(1, kind.shape)
    row, place, closeness, weights = numbers.split((1, 3, 9, 27))
    span = long.abs().mul_(2).clamp_(min=_THIN)
    tilt, lean = one * row[0], two * place
    level = torch.stack([height + tilt, height, height - tilt])
    depth = torch.stack([level + lean, level, level - lean]).div_(span).mul_(closeness.unflatten(0, (3, 3))).add_(0.5)
    immersed = depth.clamp(0, 1)
    amounts = torch.stack([immersed, (immersed - 1).mul_(immersed), (immersed == depth).to(depth.dtype)])
    first, middle, last = amounts.mul_(weights.unflatten(0, (3, 3, 3))).unbind(1)
    of_rows = (first + middle).add_(last)
    r0, r1, r2 = of_rows.unbind(1)
    fraction, along, cut = (r0 + r1).add_(r2).unbind()
    s0, s1, s2 = (last[0] - first[0]).mul_(place).unbind()
    ordered = torch.stack([along * long.sign(), (r2[0] - r0[0]).mul_(row[0]), (s0 + s1).add_(s2)]).div_(fraction.clamp(min=_THIN))
    steepest = torch.where(cylinder & (kind < 5), _STEEPEST, 1.0) / span
    return fraction, torch.empty_like(ordered).scatter_(0, turn, ordered), cut / span, steepest


def _ball(height: Tensor, upward: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """As `_columns`, of ellipsoids."""
    x, y, z = (upward * upward).unbind()
    reach = (x + y).add_(z).sqrt_().clamp_(min=_THIN)
    t = (height / reach).clamp_(-1, 1)
    square = t * t
    outside = 1 - square
    cap = (3 - square).mul_(t).add_(2)  # 4 times the immersed fraction
    widest = 0.75 / reach
    rising = outside * widest
    return cap / 4, upward * (rising * outside).div_(cap.clamp(min=_THIN)).neg_(), rising, widest
