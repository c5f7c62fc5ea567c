"""A number passes within its tolerance on both sides, and nowhere else."""

from __future__ import annotations

import math

import pytest

from hazard_ms.hazards.case import Case
from hazard_ms.validation.outcome import check


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("off", [-0.9, -0.11, -0.09, 0.0, 0.09, 0.11, 0.9])
def test_too_small_is_as_wrong_as_too_large(sign: float, off: float) -> None:
    """Ten per cent of two, or of minus two."""
    case = Case("X-1", "two", sign * 2.0, 0.1, lambda: sign * 2.0 + 2.0 * off)
    assert check(case).passed is (abs(off) < 0.1)


def test_minus_infinity_is_not_infinity() -> None:
    assert not check(Case("X-2", "never", math.inf, 0.5, lambda: -math.inf)).passed
