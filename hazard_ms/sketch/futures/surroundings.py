"""The doors, tools and walls of a running episode, as measures about its hazard meet them."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.simulation.jet import KINDS
from hazard_ms.simulation.mitigation import hinges
from hazard_ms.simulation.walls import blocked
from hazard_ms.simulation.world import World
from hazard_ms.sketch.recording import Running
from hazard_ms.spec import SceneSpec
from hazard_ms.spec.extinguishers import EXTINGUISHERS

Array = NDArray[np.float64]


class Home(Running, Protocol):
    """The part of a running environment that measures need; `hazard_ms.env.HazardEnv` has it."""

    @property
    def control_timestep(self) -> float:
        """Duration of a frame [s]."""


def inner_doors(world: World) -> dict[int, Array]:
    """The unbroken doors in the inner walls of the first environment: their middles [m], [2], by number along O."""
    openings = world.openings
    plan, broken = openings.plan, openings.state.broken
    there = (plan.door & ~plan.outside & plan.exists & ~broken)[0]
    middles = plan.beside[0, :, :, :2].mean(1).cpu().numpy().astype(np.float64)
    return {number: middles[number] for number in there.nonzero()[:, 0].tolist()}


def across(spec: SceneSpec, number: int) -> Array:
    """The unit vector, [2], at right angles to the wall of the inner door `number`, into one of its rooms."""
    return hinges.hinge(spec.room, spec.room.openings[number])[2]


def inlets_of(world: World) -> dict[int, Array]:
    """The openings of the first environment that water comes in through and no board stands in, as `inner_doors`."""
    plan, tools = world.openings.plan, world.equipment
    taken = set() if tools is None else set(tools.state.stands_in[0].tolist())
    middles = plan.beside[0, :, :, :2].mean(1).cpu().numpy().astype(np.float64)
    return {n: middles[n] for n in (plan.inlet & plan.door)[0].nonzero()[:, 0].tolist() if n not in taken}


def free_boards(world: World, row: int = 0) -> list[int]:
    """The indices along B of the flood boards of an environment that stand in no opening."""
    tools = world.equipment
    return [] if tools is None else (tools.board & ~tools.placed)[row].nonzero()[:, 0].tolist()


def charge_of(base: Home, index: int) -> float:
    """The frames that the extinguisher `index` along B still lasts; 0 for other things."""
    tools = base.world.equipment
    number = -1 if tools is None else int(tools.kinds[0, index])
    if tools is None or number < 0:
        return 0.0
    left = float(tools.state.charge[0, index]) / EXTINGUISHERS[KINDS[number]].rate
    return left / float(base.control_timestep)


def hidden(world: World, places: Array, aim: Array) -> NDArray[np.bool_]:
    """Whether a wall lies between each of `places` [m], [P, 3], and `aim` [m], [3], in the first environment: [P]."""
    ends = (torch.as_tensor(p[None], dtype=torch.float32, device=world.device) for p in (places, aim[None]))
    return np.asarray(blocked(world.walls, *ends)[0, :, 0].cpu().numpy())
