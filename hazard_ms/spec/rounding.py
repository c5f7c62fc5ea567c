"""Functions of single-precision tensors, computed in double precision and then rounded.

Torch leaves exp, log, sqrt, sin, cos and acos on a CPU to a library that computes them in another way on each
generation of processors: they differ in the last bit, also sqrt. In double precision that bit is far below what single
precision keeps, so that the rounded result is the same on all processors, for any size of the batch: for sqrt always,
for the others but for about one number in 2**28. Double-precision tensors are computed as torch does.
"""

from __future__ import annotations

from torch import Tensor


def power(base: Tensor, exponent: float) -> Tensor:
    """`base` to the power of `exponent`, [...], in any unit; NaN where the root of a number below 0 is meant."""
    return (base.double() ** exponent).to(base.dtype)


def exp(value: Tensor) -> Tensor:
    """Euler's number to the power of `value`, [...] [-]."""
    return value.double().exp().to(value.dtype)


def log(value: Tensor) -> Tensor:
    """The natural logarithm of `value`, [...] [-]."""
    return value.double().log().to(value.dtype)


def sqrt(value: Tensor) -> Tensor:
    """The square root of `value`, [...] [-]."""
    return value.double().sqrt().to(value.dtype)


def cos(angle: Tensor) -> Tensor:
    """The cosine of `angle`, [...] [rad]."""
    return angle.double().cos().to(angle.dtype)


def sin(angle: Tensor) -> Tensor:
    """The sine of `angle`, [...] [rad]."""
    return angle.double().sin().to(angle.dtype)


def acos(cosine: Tensor) -> Tensor:
    """The angle of a `cosine`, [...] [rad]."""
    return cosine.double().acos().to(cosine.dtype)
