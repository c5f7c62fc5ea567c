"""Variation of the wind in time (torch).

Less wind near the ground and in a lee: hazard_ms.hazards.wind.air; variation from thing to thing:
hazard_ms.hazards.wind.kernels.

Gust        an Ornstein-Uhlenbeck process of unit variance, advanced exactly: g' = c g + sqrt(1 - c^2) n,
            c = exp(-dt / T), n normal. Its distribution does not depend on dt. Below 0.3 Hz as good as a von Karman
            spectrum (docs/physics.md 3.3).
Turbulence  r, a new random vector per frame (paper: of fixed length; original: normal). A force F r that is held for a
            frame of dt makes a random walk whose variance grows with dt times time: r is scaled by
            sqrt(0.01 s / dt), so that it does not.
"""

from __future__ import annotations

import math

from torch import Tensor

ORIGINAL_FRAME = 0.01  # frame for which the strengths of turbulence are given [s] [docs/physics.md 0.1]


def gust(now: Tensor, dt: float, time: float, normal: Tensor) -> Tensor:
    """Gusts [standard deviations], [...], `dt` seconds after `now`, [...], with a correlation time of `time` [s].

    `normal` are independent standard normal numbers, [...].
    """
    kept = math.exp(-dt / time)
    return kept * now + math.sqrt(1.0 - kept**2) * normal


def per_frame(dt: float) -> float:
    """Factor on a random force that is held for `dt` seconds instead of one frame of the original."""
    return math.sqrt(ORIGINAL_FRAME / dt)
