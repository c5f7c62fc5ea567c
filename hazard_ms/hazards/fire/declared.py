"""The level and the threat that both fires declare to pictures, films and agents."""

from __future__ import annotations

from typing import Any

from hazard_ms.spec import Level, Quantity

ABSOLUTE_ZERO = -273.15  # [°C] SI brochure, 9th edition
TEMPERATURE = Level("temperature", "°C", 20.0, 600.0, "inferno", (255, 138, 61), least=ABSOLUTE_ZERO)

TELLS = {  # both fires
    "agent_temperature": Quantity("temperature of the agent, or of the air that it stands in", "°C", ABSOLUTE_ZERO),
    "agent_overheated": Quantity("it is hotter than the agent bears", low=0.0, high=1.0),
    "agent_in_fire": Quantity("it stands where the fire would destroy it", low=0.0, high=1.0),
}
TELLS_OF_BLAZE = {
    **TELLS,
    "agent_flux": Quantity("radiation on its chest", "kW/m^2", 0.0),
    "agent_dose": Quantity("heat borne so far; 1 is unbearable for people", "", 0.0),
    "agent_thermal_class": Quantity("thermal class I to IV of its exposure, 0 for none", "", 0.0, 4.0),
    "agent_toxic_dose": Quantity("poison breathed so far; 1 makes people helpless", "", 0.0),
    "agent_visibility": Quantity("how far it sees through the smoke at its chest", "m", 0.0, 100.0),
    "agent_in_smoke": Quantity("the smoke reaches down to its chest", low=0.0, high=1.0),
}


def ignites(target: Any, level: float) -> bool:
    """Whether a `target` of the catalogue's properties burns at the temperature `level` [C]."""
    return bool(target.flammable) and level >= target.ignition_temperature
