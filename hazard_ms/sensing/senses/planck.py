"""Radiance and temperature of a black body at one wavelength, by Planck's law.

A radiometric camera is calibrated with black bodies, so their temperatures are exact whatever its band is. For mixtures
of warm and cold the band is taken as its middle: WAVELENGTH.
"""

from __future__ import annotations

import torch
from torch import Tensor

SECOND = 0.01438777  # second radiation constant hc/k [m K] [SI brochure, 9th edition]
WAVELENGTH = 10.0e-6  # middle of the band of microbolometers, 7.5 to 13 um [m]
KELVIN = 273.15  # absolute temperature of 0 C [K]
COLDEST = -200.0  # of a body that is looked at [C] [ours]


def radiance(temperature: Tensor) -> Tensor:
    """Radiance [-], [...], of black bodies of `temperature` [C], [...], in units of 2 h c^2 / wavelength^5."""
    return 1.0 / torch.expm1(SECOND / WAVELENGTH / (temperature.clamp(min=COLDEST) + KELVIN))


def temperature(radiance: Tensor) -> Tensor:
    """Temperature [C], [...], of a black body of such a `radiance` [-], [...], which is above 0."""
    return SECOND / WAVELENGTH / torch.log1p(1.0 / radiance) - KELVIN


def slope(warmth: float) -> float:
    """Change of `radiance` [1/K] with the temperature at `warmth` [C]."""
    kelvin = torch.tensor(warmth + KELVIN, dtype=torch.float64)
    x = SECOND / WAVELENGTH / kelvin
    return float(torch.exp(x) / torch.expm1(x) ** 2 * x / kelvin)
