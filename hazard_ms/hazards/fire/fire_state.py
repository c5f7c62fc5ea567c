"""The state of a fire in every preset: the part that pictures, records and agents read."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.hazards.base import State, quantity

NORMAL, BURNING, BURNT = 0, 1, 2  # values of FireState.status
ALL_USED = 15  # of FireState.flame_used: fire has spread in all four directions
STRIDE = 4  # sources that torch adds up side by side


@dataclass
class FireState(State):
    """State of a fire with A robots, S lattices of K x K floor cells, F flames on the floor in order of ignition."""

    temperature: Tensor = quantity("E B", "C", "temperature of every thing", fill=20.0)
    status: Tensor = quantity("E B", "", "0 normal, 1 burning, 2 burnt", dtype="int", low=NORMAL, high=BURNT)
    burn_updates: Tensor = quantity("E B", "", "heat updates since ignition", dtype="int", low=0)
    threshold: Tensor = quantity("E B", "C", "ignition temperature; infinite for what cannot burn", fill=torch.inf)
    agent_temperature: Tensor = quantity("E A", "C", "temperature of every robot", fill=20.0)
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


def some_flames(state: FireState) -> int:
    """Number of places of the roster, from its beginning, that hold all flames; all of them on a GPU.

    STRIDE - 1 empty ones stay, since torch adds up sources in STRIDE rows, and the last few apart: what is left out
    then changes no bit.
    """
    length = state.flame_cell.shape[1]
    if state.flame_cell.device.type != "cpu":
        return length
    used = int((state.flame_cell >= 0).sum(1).max())
    return min(used + STRIDE - 1, length)


def lit(state: FireState, frame: Tensor, count: int | None = None) -> Tensor:
    """Whether each of the first `count` flames of the roster, all by default, burns at `frame`, [E]: [E, F], bool."""
    return (state.flame_cell[:, :count] >= 0) & (state.flame_birth[:, :count] <= frame[:, None])
