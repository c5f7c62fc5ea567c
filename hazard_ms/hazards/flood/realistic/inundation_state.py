"""The evolving state of water that flows over a floor."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.hazards.base import quantity
from hazard_ms.hazards.flood.flood_state import FloodState


@dataclass
class InundationState(FloodState):
    """State of a flood on a grid of N cells (`hazard_ms.hazards.flood.realistic.floor_plan`), with I cells at inlets.

    L sides of cells are in doors between rooms.

    A cell's `x` quantities are those of its western side, its `y` quantities those of its southern side. `level` is the
    mean height of the surface where there is water, `surface_slope` 0; what tells the path of the water is not used.
    """

    bed: Tensor = quantity("E N", "m", "height of the floor, or of the furniture that stands on it", low=0.0)
    open_x: Tensor = quantity("E N", "m", "height up to which water can pass the side; 0: a wall", low=0.0)
    open_y: Tensor = quantity("E N", "m", "height up to which water can pass the side; 0: a wall", low=0.0)
    depth: Tensor = quantity("E N", "m", "depth of the water", low=0.0)
    depth_rest: Tensor = quantity("E N", "m", "what rounding has left out of the depth")
    velocity_x: Tensor = quantity("E N", "m/s", "speed of the water through the side, eastwards")
    velocity_y: Tensor = quantity("E N", "m/s", "speed of the water through the side, northwards")
    discharge_x: Tensor = quantity("E N", "m^2/s", "water through the side per width, eastwards")
    discharge_y: Tensor = quantity("E N", "m^2/s", "water through the side per width, northwards")
    surface: Tensor = quantity("E N", "m", "height of the surface; -1 where there is none", fill=-1.0)
    inlet: Tensor = quantity(
        "E I", "", "cells that water comes into; -1: none", dtype="int", fill=-1, low=-1, high="depth"
    )
    inlet_side: Tensor = quantity("E I", "", "from where: 0 west, 1 east, 2 south, 3 north", dtype="int", low=0, high=3)
    inlet_beside: Tensor = quantity("E I", "", "cells whose level the inflow meets", dtype="int", low=0, high="depth")
    inlet_width: Tensor = quantity("E I", "m", "width of the opening before the cell", low=0.0)
    inlet_height: Tensor = quantity("E I", "m", "height that is open before the cell", low=0.0)
    inlet_opening: Tensor = quantity("E I", "", "number of the opening before the cell", dtype="int", low=0)
    inlet_along: Tensor = quantity("E I", "m", "place of the cell along the wall", low=0.0)
    leaf: Tensor = quantity(
        "E L", "", "cells with a side in a door between rooms; -1: none", dtype="int", fill=-1, low=-1, high="depth"
    )
    leaf_side: Tensor = quantity("E L", "", "that side: 0 west, 1 south", dtype="int", low=0, high=1)
    leaf_opening: Tensor = quantity("E L", "", "number of the door", dtype="int", low=0)
    leaf_along: Tensor = quantity("E L", "m", "place of the side along the wall", low=0.0)
    friction: Tensor = quantity("E", "m^(1/3)", "friction of the floor: g n^2 of Manning's n", low=0.0)
    inflow: Tensor = quantity("E", "m^3", "water that has come in, less what has left")
    inflow_rest: Tensor = quantity("E", "m^3", "what rounding has left out of it")
    signal: Tensor = quantity("E", "m/s", "speed of the fastest wave", low=0.0)
    ahead: Tensor = quantity("E", "s", "time by which the water is ahead: less than a step of its own", low=0.0)
    dammed: Tensor = quantity("E I", "", "share of the opening that floating furniture covers", low=0.0, high=1.0)
    door: Tensor = quantity(
        "E DOORS", "", "cells with an inner doorway on a side; -1: none", dtype="int", fill=-1, low=-1, high="depth"
    )
    door_side: Tensor = quantity("E DOORS", "", "which side: 0 west, 2 south", dtype="int", low=0, high=3)
    door_height: Tensor = quantity("E DOORS", "m", "height of the opening there", low=0.0)
    door_dammed: Tensor = quantity("E DOORS", "", "share of it that floating furniture covers", low=0.0, high=1.0)
    ground_of: Tensor = quantity(
        "E N", "", "the thing that is the ground of a cell; -1: none", dtype="int", fill=-1, low=-1, high="B"
    )
    float_depth: Tensor = quantity(
        "E B",
        "m",
        "depth of water in which furniture leaves the floor; infinite for what stays",
        fill=torch.inf,
        low=0.0,
    )
    afloat: Tensor = quantity("E B", "", "furniture that has left the floor", dtype="bool")
    displaced: Tensor = quantity("E", "m^3", "water in the place of furniture that has left the floor", low=0.0)
    lies: Tensor = quantity("E A", "", "a robot lies in the water", dtype="bool")
    lain: Tensor = quantity("E A", "s", "time since a robot fell, 0 where it stands", low=0.0)
