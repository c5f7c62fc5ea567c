"""The evolving state of a flood."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.hazards.base import State, quantity


@dataclass
class FloodState(State):
    """State of a flood with W partitions and D doorways.

    What does not change over an episode is kept as it was worked out at its start. The last seven fields are those of
    hazard_ms.hazards.flood.flow_paths.FlowPaths.
    """

    time: Tensor = quantity("E", "s", "time since the start of the episode")
    level: Tensor = quantity("E", "m", "height of the surface at the source wall")
    surface_slope: Tensor = quantity("E", "", "descent of the surface along the path of the water, a tangent")
    fraction: Tensor = quantity("E B", "", "share of every thing's volume that is under water")
    under: Tensor = quantity("E B", "s", "how long every thing has been under water enough to be damaged")
    soaked: Tensor = quantity("E B", "", "share of its pores that are full of water")
    volume: Tensor = quantity("E B", "m^3", "volume of water that a dry, wholly immersed thing displaces")
    shape: Tensor = quantity(
        "E B", "", "its shape in water: 0 box, 1 upright cylinder, 2 ellipsoid", dtype="int", low=0, high=2
    )
    drag_coefficient: Tensor = quantity("E B", "", "its drag coefficient")
    pores: Tensor = quantity("E B", "", "share of its volume that water takes in the end")
    soaking_time: Tensor = quantity("E B", "s", "time until 1 / e of its pores are left dry", fill=1.0)
    submersion_limit: Tensor = quantity(
        "E B", "s", "time under water that damages it; infinite for what is waterproof", fill=torch.inf
    )
    flow: Tensor = quantity("E 2", "", "direction in which water leaves the source wall")
    origin_length: Tensor = quantity("E", "m", "path length at the room's origin, were there no partitions")
    partition: Tensor = quantity("E W 2", "m", "partitions: the axis that they cross (0 x, 1 y), and where")
    source_part: Tensor = quantity("E 2", "", "bits of the parts along the source wall: which, and values", dtype="int")
    doorway: Tensor = quantity("E D 4", "m", "doorways: low x, y, high x, y")
    doorway_distance: Tensor = quantity("E D", "m", "path length of the water to doorways")
    doorway_part: Tensor = quantity(
        "E D 2", "", "doorways: a part beside it, and the bit in which the other differs", dtype="int"
    )
