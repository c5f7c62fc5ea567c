"""Published correlations that the realistic fire does not use, to compare it with other authors' answers.

Sources: NIST FDS Correlation Guide (Target Heat Flux and HGL Temperature chapters). Plain
numbers, SI, kW, C.
"""

from __future__ import annotations

import math


def solid_flame(length: float, diameter: float, apart: float) -> float:
    """Flux [kW/m^2] at ground level, `apart` [m] from the axis of a cylindrical flame of `length` and `diameter` [m].

    The emissive power is 58 * 10^(-0.00823 D) kW/m^2: the guide prints -0.0823, its numbers need 0.00823
    (docs/physics.md N-2).
    """
    h, s = 2 * length / diameter, 2 * apart / diameter
    a, b = (h * h + s * s + 1) / (2 * s), (1 + s * s) / (2 * s)
    root = math.atan(math.sqrt((a + 1) * (s - 1) / ((a - 1) * (s + 1))))
    other = math.atan(math.sqrt((b + 1) * (s - 1) / ((b - 1) * (s + 1))))
    level = (b - 1 / s) / (math.pi * math.sqrt(b * b - 1)) * other - (a - 1 / s) / (
        math.pi * math.sqrt(a * a - 1)
    ) * root
    upright = (math.atan(h / math.sqrt(s * s - 1)) - h * math.atan(math.sqrt((s - 1) / (s + 1)))) / (math.pi * s)
    upright += a * h / (math.pi * s * math.sqrt(a * a - 1)) * root
    return 58 * 10 ** (-0.00823 * diameter) * math.hypot(level, upright)


def beyler(power: float, size: tuple[float, float, float], lining: float, seconds: float) -> float:
    """Rise of the layer's temperature [K] in a closed room of `size` [m] with a fire of `power` [kW].

    `lining` is k rho c of its walls [kW^2 s/m^4 K^2].
    """
    length, width, high = size
    surface = 2 * (length * width + length * high + width * high)
    mass = 1.2 * length * width * high
    first, second = 2 * 0.4 * math.sqrt(lining) * surface / mass, power / mass
    root = math.sqrt(seconds)
    return 2 * second / first**2 * (first * root - 1 + math.exp(-first * root))


def mqh(
    power: float, size: tuple[float, float, float], door: tuple[float, float], lining: tuple[float, ...], seconds: float
) -> float:
    """Rise of the layer's temperature [K] in a room of `size` [m] with an open `door`, its width and height [m].

    `lining` is conductivity [kW/m K], density [kg/m^3], heat capacity [kJ/kg K] and thickness [m] of the walls.
    """
    length, width, high = size
    conductivity, density, heat, thickness = lining
    surface = 2 * (length * width + length * high + width * high)
    through = density * heat / conductivity * (thickness / 2) ** 2  # time after which heat passes the wall [s]
    soaking = math.sqrt(conductivity * density * heat / seconds)
    passing = soaking if seconds < through else conductivity / thickness
    opening = door[0] * door[1] * math.sqrt(door[1])
    return float(6.85 * (power**2 / (opening * passing * surface)) ** (1 / 3))
