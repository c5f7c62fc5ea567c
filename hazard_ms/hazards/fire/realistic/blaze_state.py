"""The state of a realistic fire."""

from __future__ import annotations

from dataclasses import dataclass

from torch import Tensor

from hazard_ms.hazards.base import quantity
from hazard_ms.hazards.fire.fire_state import FireState
from hazard_ms.hazards.fire.realistic import burning, radiation
from hazard_ms.hazards.fire.realistic.fuels import CURVES

HEATED = (  # names of the quantities that an update of heat changes
    *("temperature", "status", "burn_age", "burn_updates", "agent_temperature", "agent_dose", "heat_release"),
    *("smoke_volume", "smoke_energy", "smoke_mass", "smoke_height", "smoke_temperature", "smoke_density"),
)


@dataclass
class BlazeState(FireState):
    """State of a realistic fire: that of FireState, and more, with O gaps in the outer walls.

    `burn_updates` counts intervals of blaze.UPDATE.
    """

    burn_age: Tensor = quantity("E B", "s", "time since ignition")
    inertia: Tensor = quantity("E B", "kW^2 s/m^4 K^2", "k rho c of a thick solid")
    sheet: Tensor = quantity("E B", "kJ/m^2 K", "heat capacity of a thin solid")
    critical: Tensor = quantity("E B", "kW/m^2", "least flux that ignites it", fill=1.0)
    ignition: Tensor = quantity("E B", "C", "ignition temperature of its material", fill=1000.0)
    growth: Tensor = quantity("E B", "kW/s^2", "growth of its heat release")
    peak: Tensor = quantity("E B", "kW", "peak of its heat release")
    decline: Tensor = quantity("E B", "s", "time from ignition to its decline")
    burn_end: Tensor = quantity("E B", "s", "time from ignition until it is burnt", fill=1.0)
    curve: Tensor = quantity(
        "E B", "", "row of its measured curve; -1 for none", dtype="int", fill=-1, low=-1, high=len(CURVES) - 1
    )
    soot_yield: Tensor = quantity("E B", "kg/kJ", "soot per heat")
    flame_age: Tensor = quantity("E F", "s", "time since the flame appeared")
    flame_peak: Tensor = quantity("E F", "kW", "heat release of the flame once grown", low=0.0)
    floor_speed: Tensor = quantity("E", "m/s", "speed at which fire spreads over the floor")
    height: Tensor = quantity("E", "m", "height of the room", fill=2.6, low=0.0)
    vents: Tensor = quantity("E O 3", "m", "gaps: width, lower and upper end")
    roofed: Tensor = quantity("E", "", "1 under a ceiling, 0 in the open, where smoke does not gather", fill=1.0)
    heat_release: Tensor = quantity("E", "kW", "heat release of all that burns")
    smoke_volume: Tensor = quantity("E", "m^3", "volume of the layer")
    smoke_energy: Tensor = quantity("E", "kJ", "excess heat of the layer")
    smoke_mass: Tensor = quantity("E", "kg", "soot in the layer")
    smoke_height: Tensor = quantity("E", "m", "lower face of the layer above the floor", fill=2.6, low=0.0)
    smoke_temperature: Tensor = quantity("E", "C", "temperature of the layer", fill=20.0)
    smoke_density: Tensor = quantity("E", "1/m", "extinction of light in the layer: one sees about 3 / it", low=0.0)
    agent_dose: Tensor = quantity("E", "", "heat that the agent has borne; 1 is too much for people")

    @property
    def course(self) -> burning.Course:
        """Heat release of every thing."""
        return burning.Course(self.growth, self.peak, self.decline, self.burn_end, self.curve)

    @property
    def solid(self) -> radiation.Solid:
        """Surface of every thing."""
        return radiation.Solid(self.ignition, self.critical, self.inertia, self.sheet)
