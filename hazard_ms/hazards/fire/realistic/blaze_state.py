"""The state of a realistic fire."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.hazards.base import quantity
from hazard_ms.hazards.fire.fire_state import FireState
from hazard_ms.hazards.fire.realistic import burning, radiation
from hazard_ms.hazards.fire.realistic.fuels import CURVES
from hazard_ms.hazards.fire.realistic.twozone.gas import PARTS
from hazard_ms.hazards.fire.realistic.twozone.lining import CELLS
from hazard_ms.hazards.fire.realistic.twozone.zones import YIELDS

HEATED = (  # names of the quantities that an update of heat changes
    *("temperature", "status", "burn_age", "burn_updates", "agent_temperature", "agent_dose", "heat_release"),
    *(
        "smoke_height",
        "smoke_temperature",
        "smoke_density",
        "smoke_low_density",
        "vents",
        "zone_smoke",
        "zone_air",
        "zone_wall",
    ),
    *("zone_upper", "zone_lower", "zone_pressure", "zone_height", "zone_temperature", "zone_low_temperature"),
    *("zone_density", "zone_low_density", "zone_emissivity", "zone_share", "zone_draught"),
    *("floor_temperature", "agent_toxic_dose", "wet", "coated", "flame_wet", "flame_coated"),
)


@dataclass
class BlazeState(FireState):
    """State of a realistic fire: that of FireState, and more, with O openings, R rooms and A robots.

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
    yields: Tensor = quantity(f"E B {YIELDS}", "kg/kJ", "soot, CO, HCN with air and without, and fuel per heat")
    flame_age: Tensor = quantity("E F", "s", "time since the flame appeared")
    under_water: Tensor = quantity("E B", "", "share of its height that is under water now", low=0.0, high=1.0)
    wet: Tensor = quantity("E B", "", "share of its surface that is wet", low=0.0, high=1.0)
    coated: Tensor = quantity("E B", "", "share of its surface under powder", low=0.0, high=1.0)
    flame_wet: Tensor = quantity("E F", "", "share of what burns there that is wet", low=0.0, high=1.0)
    flame_coated: Tensor = quantity("E F", "", "the same under powder", low=0.0, high=1.0)
    flame_dry: Tensor = quantity("E F", "", "share of the flame that is above water", fill=1.0, low=0.0, high=1.0)
    first_height: Tensor = quantity("E", "m", "height of what burns first", fill=1.0, low=0.0)
    flame_peak: Tensor = quantity("E F", "kW", "heat release of the flame once grown", low=0.0)
    floor_ignition: Tensor = quantity("E", "C", "ignition temperature of the floor", fill=1000.0)
    floor_critical: Tensor = quantity("E", "kW/m^2", "least flux that ignites it", fill=1.0)
    floor_inertia: Tensor = quantity("E", "kW^2 s/m^4 K^2", "its k rho c; 0: it does not burn", low=0.0)
    floor_temperature: Tensor = quantity("E S K K", "C", "temperature of its cells", fill=20.0)
    height: Tensor = quantity("E", "m", "height of the room", fill=2.6, low=0.0)
    vents: Tensor = quantity("E O 4", "m", "openings: width, lower and upper end, width without panes")
    vent_from: Tensor = quantity("E O", "", "number of the room on one side", dtype="int", low=0, high="zone_area")
    vent_to: Tensor = quantity(
        "E O", "", "number of the room on the other side; -1 for the outside", "int", -1, -1, "zone_area"
    )
    roofed: Tensor = quantity("E", "", "1 under a ceiling, 0 in the open, where smoke does not gather", fill=1.0)
    lining_conductivity: Tensor = quantity("E", "kW/m K", "conductivity of walls and ceiling", fill=1e-3)
    lining_capacity: Tensor = quantity("E", "kJ/m^3 K", "their heat capacity", fill=1e3)
    lining_thickness: Tensor = quantity("E", "m", "their thickness", fill=0.1)
    zone_columns: Tensor = quantity("E", "", "number of rooms side by side along x", "int", fill=1, low=1)
    zone_end_x: Tensor = quantity("E R", "m", "where each column of rooms ends along x", fill=torch.inf)
    zone_end_y: Tensor = quantity("E R", "m", "where each row of rooms ends along y", fill=torch.inf)
    zone_area: Tensor = quantity("E R", "m^2", "area of the floor; 0 for no room", low=0.0)
    zone_edge: Tensor = quantity("E R", "m", "circumference of the room")
    zone_smoke: Tensor = quantity(
        f"E R {PARTS}", "", "the layer: mass [kg], excess heat [kJ], soot, lack of oxygen against air, CO, HCN [kg]"
    )
    zone_air: Tensor = quantity(f"E R {PARTS}", "", "the same of the air below it")
    zone_wall: Tensor = quantity("E R", "m^2", "ceiling and walls that it covers", low=0.0)
    zone_upper: Tensor = quantity(f"E R {CELLS}", "C", "temperature in the depth of what it covers", fill=20.0)
    zone_lower: Tensor = quantity(f"E R {CELLS}", "C", "the same of the floor and the walls below it", fill=20.0)
    zone_pressure: Tensor = quantity("E R", "Pa", "pressure at the floor above the outside")
    zone_height: Tensor = quantity("E R", "m", "lower face of the layer above the floor", fill=2.6, low=0.0)
    zone_temperature: Tensor = quantity("E R", "C", "temperature of the layer", fill=20.0)
    zone_low_temperature: Tensor = quantity("E R", "C", "temperature of the air below it", fill=20.0)
    zone_density: Tensor = quantity("E R", "1/m", "extinction of light in the layer", low=0.0)
    zone_low_density: Tensor = quantity("E R", "1/m", "extinction of light in the air below it", low=0.0)
    zone_emissivity: Tensor = quantity("E R", "", "emissivity of the layer", low=0.0, high=1.0)
    zone_share: Tensor = quantity("E R", "", "share of the fires that has oxygen", fill=1.0, low=0.0, high=1.0)
    zone_draught: Tensor = quantity("E R", "m/s", "speed of the air that openings let in, over the room's width")
    heat_release: Tensor = quantity("E", "kW", "heat release of all that burns")
    smoke_height: Tensor = quantity("E A", "m", "lower face of the layer in a robot's room", fill=2.6, low=0.0)
    smoke_temperature: Tensor = quantity("E A", "C", "temperature of that layer", fill=20.0)
    smoke_density: Tensor = quantity("E A", "1/m", "extinction of light in it: one sees about 3 / it", low=0.0)
    smoke_low_density: Tensor = quantity("E A", "1/m", "extinction of light in the air below it", low=0.0)
    agent_dose: Tensor = quantity("E A", "", "heat that a robot has borne; 1 is too much for people")
    agent_toxic_dose: Tensor = quantity("E A", "", "poison that it has breathed; 1 makes people helpless", low=0.0)

    @property
    def ceiling(self) -> Tensor:
        """Height at which flames and plumes meet a ceiling [m], [E]; infinite in the open."""
        return torch.where(self.roofed > 0, self.height, torch.inf)

    @property
    def course(self) -> burning.Course:
        """Heat release of every thing."""
        return burning.Course(self.growth, self.peak, self.decline, self.burn_end, self.curve)

    @property
    def solid(self) -> radiation.Solid:
        """Surface of every thing."""
        return radiation.Solid(self.ignition, self.critical, self.inertia, self.sheet)
