"""Air that fires draw into the smoke above them (Warp).

    m = 0.21 (g / 353)^(1/3) rho Q^(1/3) z^(5/3)     Zukoski's plume, as in ASET (NIST)
    m (1 + 5/6 0.6 U / (0.11 w))                     in a draught of U m/s across a plume that rises with w (Hoult)
    m = 0.0056 Q_c z / L                             in flames, z < L, if it is more (Heskestad)

L is the length of the flames, see radiation.flame_length (Heskestad), Q_c the convected part of Q. w is that of a point
source, 5/6 / 0.11 (0.9 0.11 F / pi)^(1/3) z^(-1/3), F = g Q / 353. All fires of a room feed one plume.
"""

from __future__ import annotations

import math

import warp as wp

from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

ZUKOSKI = 0.21  # coefficient of entrainment [-] [docs/physics.md 3.1]
# Air drawn in per Q^(1/3) z^(5/3) [kg/s kW^(1/3) m^(5/3)]
PER_POWER = ZUKOSKI * (radiation.GRAVITY / radiation.AIR) ** (1.0 / 3.0) * radiation.AIR / 293.15
IN_FLAMES = 0.0056  # air drawn in by flames, per convected heat and share of their length [kg/kJ] [M: Heskestad]
# Length of flames: per Q^0.4 [m/kW^0.4], less per diameter [-]: the numbers of radiation.flame_length in air of 20 C
LENGTH = 3.7 / (radiation.AIR_DENSITY * 293.15 * math.sqrt(radiation.GRAVITY)) ** 0.4
WIDTH = 1.02
PER_AREA = 4.0 / math.pi  # square of a diameter over its area [-]


ACROSS, ALONG = 0.6, 0.11  # coefficients of entrainment, of a draught and of what rises [-] [M: Hoult]
# Speed of a plume per Q^(1/3) z^(-1/3) [m^(4/3)/s kW^(1/3)]
SPEED = 5.0 / (6.0 * ALONG) * (0.9 * ALONG * radiation.GRAVITY / radiation.AIR / math.pi) ** (1.0 / 3.0)


@wp.func
def flame_length(power: float, diameter: float) -> float:
    """Mean length of flames [m] of a fire of `power` [kW] and `diameter` [m]; below 0 where there are none."""
    return LENGTH * power**0.4 - WIDTH * diameter


@wp.func
def entrained(power: float, convected: float, area: float, rise: float, draught: float) -> float:
    """Air [kg/s] that fires draw in up to `rise` [m] above their base.

    They give off `power`, of which `convected` is not radiated [kW], on an `area` [m^2] in all, in a `draught` [m/s].
    """
    drawn = float(0.0)
    if power > 0.0 and rise > 0.0:
        third = power ** (1.0 / 3.0)
        speed = SPEED * third / rise ** (1.0 / 3.0)
        drawn = PER_POWER * third * rise ** (5.0 / 3.0) * (1.0 + 5.0 / 6.0 * ACROSS * draught / (ALONG * speed))
        length = flame_length(power, wp.sqrt(PER_AREA * area))
        if length > 0.0:
            drawn = wp.max(drawn, IN_FLAMES * convected * wp.min(rise / length, 1.0))
    return drawn
