"""Heat that people and robots bear: doses that add up over time, and thermal classes (torch).

people   dose per minute = 1 / (4.1e8 T^-3.61) + 1 / (4.2 q^-1.9), the second from 2.5 kW/m^2 on; 1 is unbearable (ISO
         13571)
poison   dose per minute = (CO / 35,000 + HCN^2.36 / 1.2e6) exp(CO2 / 5 from 2 % on) + lack of oxygen, ppm and percent
         of the volume (ISO 13571), the last below 13 %: 1 / exp(8.13 - 0.54 (20.9 - O2)) (Purser); 1: helpless
robots   thermal classes of firefighters' electronics (NIST TN 1474): the air temperature [C] and flux [kW/m^2] that
         each allows
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.simulation.world import World
from hazard_ms.spec import rounding

CHEST = 1.0  # height at which the agent feels heat and smoke [m] [ours]
# I, II, III; IV above [docs/physics.md 3.1; fluxes: NIST TN 1474]
CLASSES = ((100.0, 1.0), (160.0, 2.0), (260.0, 10.0))
RADIANT_FROM = 2.5  # flux from which it counts for the dose [kW/m^2] [docs/physics.md 3.1, 4.4]
UNBEARABLE = 1.0  # dose that people do not bear [-]
CLASS_OF_WARMTH = 60.0  # air temperature from which an exposure has a class [C] [ours]

# Mass of a mole [kg/kmol]: of air, carbon monoxide, hydrogen cyanide, oxygen, which fills OXYGEN of the volume [%]
AIR, MONOXIDE, CYANIDE, DIOXYGEN, OXYGEN = 28.96, 28.01, 27.03, 32.0, 20.9
DIOXIDE = 0.8  # carbon dioxide made per oxygen used up, by volume: of wood 1, of plastics 0.7 [-] [M: SFPE]
_MOLES = ((3, DIOXYGEN), (4, MONOXIDE), (5, CYANIDE))  # columns of a gas, and of what
BREATHLESS = 13.0  # oxygen below which its lack counts [% by volume] [docs/physics.md 3.1: ISO 13571]


def chest(world: World) -> Tensor:
    """Place where the agent feels heat [m], [E, 1, 3], world frame."""
    return _raised(world.agent_position[:, None])


def chests(world: World) -> Tensor:
    """Places where all A robots feel heat [m], [E, A, 3], world frame."""
    return _raised(world.crew.places)


def _raised(places: Tensor) -> Tensor:
    high = places.clone()
    high[..., 2] += CHEST
    return high


def toxic_rate(gas: Tensor) -> Tensor:
    """Dose per second [1/s], [...], of a `gas`, [..., PARTS]: mass, heat, soot, lack of oxygen, CO and HCN [kg, kJ]."""
    mass = gas[..., 0].clamp(min=1e-3)
    lack, monoxide, cyanide = (gas[..., k].clamp(min=0.0) * (AIR / m) / mass for k, m in _MOLES)
    minute = monoxide * (1e6 / 35_000.0) + rounding.power(cyanide * 1e6, 2.36) / 1.2e6
    dioxide = 100.0 * DIOXIDE * lack
    minute = minute * torch.where(dioxide > 2.0, rounding.exp(dioxide.clamp(max=50.0) / 5.0), 1.0)
    left = (OXYGEN - 100.0 * lack).clamp(min=0.0)
    starved = torch.where(left < BREATHLESS, rounding.exp(0.54 * (OXYGEN - left) - 8.13), 0.0)
    return (minute + starved) / 60.0


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
