"""Heat that people and robots bear: doses that add up over time, and thermal classes (torch).

people   dose per minute = 1 / (4.1e8 T^-3.61) + 1 / (4.2 q^-1.9), the second from 2.5 kW/m^2 on; 1 is unbearable (ISO
         13571)
robots   thermal classes of firefighters' electronics (NIST TN 1474): the air temperature [C] and flux [kW/m^2] that
         each allows
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.spec import rounding

# I, II, III; IV above [docs/physics.md 3.1; fluxes: NIST TN 1474]
CLASSES = ((100.0, 1.0), (160.0, 2.0), (260.0, 10.0))
RADIANT_FROM = 2.5  # flux from which it counts for the dose [kW/m^2] [docs/physics.md 3.1, 4.4]
UNBEARABLE = 1.0  # dose that people do not bear [-]
CLASS_OF_WARMTH = 60.0  # air temperature from which an exposure has a class [C] [ours]


def dose_rate(temperature: Tensor, flux: Tensor) -> Tensor:
    """Dose per second [1/s], [...], in air of `temperature` [C], [...], under `flux` [kW/m^2], [...]."""
    convected = rounding.power(temperature.clamp(min=0.0), 3.61) / 4.1e8
    radiated = torch.where(flux >= RADIANT_FROM, rounding.power(flux.clamp(min=0.0), 1.9) / 4.2, 0.0)
    return (convected + radiated) / 60.0


def thermal_class(temperature: Tensor, flux: Tensor) -> Tensor:
    """Thermal class, int64, [...], of an exposure to air of `temperature` [C] and `flux` [kW/m^2], [...].

    1 to 4 stand for the classes I to IV, 0 for none.
    """
    found = ((temperature >= CLASS_OF_WARMTH) | (flux >= CLASSES[0][1])).long()
    for number, (hot, bright) in enumerate(CLASSES, start=2):
        found = torch.where((temperature > hot) | (flux > bright), number, found)
    return found
