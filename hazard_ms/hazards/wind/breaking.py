"""Energies of blows by which things break (torch).

Electronics    that of a fall from 1 m [IEC 60068-2-31: free fall of hand-held equipment]
Bottles        30 J, a full bottle of beer under a falling steel ball [Bolliger et al. 2009]
Crockery       1.5 J, a mug of 0.3 kg that falls from 0.5 m [ours]

All else stays whole.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.hazards.flood.soaking import ELECTRONIC
from hazard_ms.simulation.world import World
from hazard_ms.spec.catalogue import CATEGORIES

DROP = 1.0  # height of a fall that electronics bear [m]
GRAVITY = 9.81  # [m/s^2]
CROCKERY = ("plate", "mug", "vase", "wine_glass")
ENERGIES = {"bottle": 30.0, **dict.fromkeys(CROCKERY, 1.5)}  # [J]
NEVER = 1e9  # [J]


def endurance(world: World) -> Tensor:
    """Largest energy of a blow that each thing bears [J], [E, B]."""
    table = torch.tensor([ENERGIES.get(name, NEVER) for name in CATEGORIES], device=world.device)
    falls = torch.tensor([name in ELECTRONIC for name in CATEGORIES], device=world.device)
    kind = world.category.clamp(min=0)
    return torch.where(falls[kind], DROP * GRAVITY * world.mass, table[kind])


def at_the_agent(world: World, reach: float) -> Tensor:
    """Things that touch the agent, or nearly do, [E, B], bool: none is `reach` [m] away from it."""
    robot = world.robot
    apart = (world.position[..., :2] - world.agent_position[:, None, :2]).norm(dim=-1)
    near = apart < robot.radius + 0.5 * world.extent.norm(dim=-1) + reach
    return near & (world.position[..., 2] < 2.0 * robot.drag_height)
