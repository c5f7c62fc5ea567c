"""Air that fires draw into the smoke above them (Warp).

    m = 0.21 (g / 353)^(1/3) rho Q^(1/3) z^(5/3)     Zukoski's plume, as in ASET (NIST)
    m = 0.0056 Q_c z / L                             in flames, z < L, if it is more (Heskestad)

L is the length of the flames, 0.235 Q^0.4 - 1.02 D (Heskestad), Q_c the convected part of Q. All fires of a room feed
one plume.
"""

from __future__ import annotations

import math

import warp as wp

from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

ZUKOSKI = 0.21  # coefficient of entrainment [-] [docs/physics.md 3.1]
# Air drawn in per Q^(1/3) z^(5/3) [kg/s kW^(1/3) m^(5/3)]
PER_POWER = ZUKOSKI * (radiation.GRAVITY / radiation.AIR) ** (1.0 / 3.0) * radiation.AIR / 293.15
IN_FLAMES = 0.0056  # air drawn in by flames, per convected heat and share of their length [kg/kJ] [M: Heskestad]
LENGTH, WIDTH = 0.235, 1.02  # length of flames: per Q^0.4, and less per diameter [docs/physics.md 3.1: Heskestad]
PER_AREA = 4.0 / math.pi  # square of a diameter over its area [-]


@wp.func
def entrained(power: float, convected: float, area: float, rise: float) -> float:
    """Air [kg/s] that fires draw in up to `rise` [m] above their base.

    They give off `power`, of which `convected` is not radiated [kW], on an `area` [m^2] in all.
    """
    drawn = float(0.0)
    if power > 0.0 and rise > 0.0:
        drawn = PER_POWER * power ** (1.0 / 3.0) * rise ** (5.0 / 3.0)
        length = LENGTH * power**0.4 - WIDTH * wp.sqrt(PER_AREA * area)
        if length > 0.0:
            drawn = wp.max(drawn, IN_FLAMES * convected * wp.min(rise / length, 1.0))
    return drawn
