"""The state of a fire in every preset: the part that pictures, records and agents read."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.hazards.base import State, quantity

NORMAL, BURNING, BURNT = 0, 1, 2  # values of FireState.status
ALL_USED = 15  # of FireState.flame_used: fire has spread in all four directions


@dataclass
class FireState(State):
    """State of a fire with S lattices of K x K floor cells and F flames on the floor, in the order of ignition."""

    temperature: Tensor = quantity("E B", "C", "temperature of every thing", fill=20.0)
    status: Tensor = quantity("E B", "", "0 normal, 1 burning, 2 burnt", dtype="int", low=NORMAL, high=BURNT)
    burn_updates: Tensor = quantity("E B", "", "heat updates since ignition", dtype="int", low=0)
    threshold: Tensor = quantity("E B", "C", "ignition temperature; infinite for what cannot burn", fill=torch.inf)
    agent_temperature: Tensor = quantity("E", "C", "temperature of the agent", fill=20.0)
    anchor: Tensor = quantity("E S 2", "m", "where the first flame of each lattice is")
    free: Tensor = quantity("E S K K", "", "floor cells that can burn", dtype="bool")
    flame_cell: Tensor = quantity(
        "E F",
        "",
        "number of the burning cell; -1 where there is no flame yet",
        dtype="int",
        fill=-1,
        low=-1,
        high="free",
    )
    flame_place: Tensor = quantity("E F 3", "m", "where the flame is")
    flame_birth: Tensor = quantity("E F", "frame", "when the flame appears", dtype="int", fill=-1)
    flame_last: Tensor = quantity(
        "E F", "frame", "the flame's last success in spreading, or its birth", dtype="int", fill=-1
    )
    flame_used: Tensor = quantity("E F", "", "directions used up, one bit each", dtype="int", low=0, high=ALL_USED)
