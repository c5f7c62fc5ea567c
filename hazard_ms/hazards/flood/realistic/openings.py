"""Water through openings: their laws, which of them stand open now, and how it presses on those that are closed.

    weir      0.4 b sqrt(2 g) H^1.5, less by Villemonte's factor once the water behind stands above the sill, too
    orifice   0.611 b a sqrt(2 g dH) at most, where the water stands above the opening

What is closed of a door has a gap under it, openings.GAP high over its width. The force on a leaf is that of water at
rest, rho g w / 2 (h_1^2 - h_2^2), heights above its lower edge and not above its upper one. The law is that of the
inlets (hazard_ms.hazards.flood.realistic.inlets), L-26 to L-28 and L-39 of docs/physics.md.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor

from hazard_ms.hazards.base import none_set
from hazard_ms.hazards.flood.realistic import inlets
from hazard_ms.hazards.flood.realistic.inundation_state import InundationState
from hazard_ms.simulation.kernels.launch import Launches
from hazard_ms.simulation.openings import GAP, Strain
from hazard_ms.simulation.world import World

# Gap under a flood board that a hand sets into its rails [m] [ours]; those that are tested leak 1 l/h per metre of seal
# [PAS 1188-1], a thousandth of it
LEAK = 0.0002


def discharge(
    before: Tensor, behind: Tensor, width: Tensor, height: Tensor, sill: Tensor, launches: Launches | None = None
) -> Tensor:
    """Discharge [m^3/s], [E, O], through O openings, from the water before each to that behind it; below 0 backwards.

    Args:
        before: Depth of the water on one side, above the floor [m], [E, O].
        behind: Depth on the other side [m], [E, O].
        width: Width that is open [m], [E, O]: 0 for none.
        height: Height that is open, above the sill [m], [E, O].
        sill: Height of the lower edge above the floor [m], [E, O].
        launches: Where the launch is recorded, for use in every frame.

    Raises:
        ValueError: If the shapes differ.
    """
    given = (before, behind, width, height, sill)
    if before.ndim != 2 or any(of.shape != before.shape for of in given):
        raise ValueError(f"depths and openings must have one shape [E, O], got {[list(of.shape) for of in given]}")
    made = torch.zeros_like(before, memory_format=torch.contiguous_format)
    known = Launches() if launches is None else launches
    known.run(inlets.leak, tuple(before.shape), *(of.contiguous() for of in given), made)
    return made


def set_heights(state: InundationState, world: World, outside: float = math.inf) -> None:
    """Write the heights that are open at inlets and in doors between rooms [m]: all of it, or the gap under a leaf.

    Flood boards hold back water that is no higher than they are; outdoors it stands `outside` [m] deep. All that is
    higher flows as if there were none.
    """
    held = _held(world, outside)
    height = _heights(world, state.inlet_opening, state.inlet_along, held)
    state.inlet_height.copy_(torch.where(state.inlet >= 0, height, 0.0))
    if not world.openings.inner:
        return
    height = _heights(world, state.leaf_opening, state.leaf_along, held)
    for side, sides in enumerate((state.open_x, state.open_y)):
        mine = (state.leaf >= 0) & (state.leaf_side == side)
        cell = torch.where(mine, state.leaf, 0)  # the first cell is one of the ring: closed
        sides.scatter_(1, cell, torch.where(mine, height, sides[:, :1]))


def _held(world: World, outside: float) -> Tensor | None:
    """Openings in which a flood board holds the water back, [E, O], bool; None where there are none."""
    if world.equipment is None or none_set(world.equipment.placed):
        return None
    plan = world.openings.plan
    level = world.fields["water"](plan.beside.flatten(1, 2)).unflatten(1, (-1, 2)).amax(-1)
    level = torch.where(plan.outside, outside, level)
    top = plan.sill + world.equipment.boards(world.extent[..., 2], world.openings.count)
    return (top > plan.sill) & (level <= top)


def _heights(world: World, opening: Tensor, along: Tensor, held: Tensor | None) -> Tensor:
    """Height that is open [m], [E, L], at places `along` the wall [m], [E, L], in the openings `opening`, [E, L].

    `held`: openings with boards, [E, O], which let only LEAK through.
    """
    plan, share = world.openings.plan, world.openings.share.gather(1, opening)
    width, high, sill, top = (of.gather(1, opening) for of in (plan.width, plan.high, plan.sill, plan.top))
    free = (share >= 1.0) | ((share > 0.0) & (along > high - share * width))
    leak = torch.where(plan.door.gather(1, opening), GAP, 0.0)
    open_ = torch.where(free, top - sill, torch.minimum(leak, top - sill))
    return open_ if held is None else torch.where(held.gather(1, opening), open_.clamp(max=LEAK), open_)


def press(level: Tensor, outside: float, world: World, weight: float) -> Strain:
    """Force [N] of water on openings, [E, O], between its levels [m], [E, O, 2], on both sides; `weight` is [N/m^3].

    Outdoors it stands `outside` [m] deep.
    """
    plan = world.openings.plan
    level = torch.stack([level[..., 0], torch.where(plan.outside, outside, level[..., 1])], -1)
    low, top = plan.sill[..., None], plan.top[..., None]
    high = level - low
    over = (level - top).clamp(min=0.0)
    under = 0.5 * (high.clamp(min=0.0).square() - over.square())  # of the pressure over the height
    force = weight * plan.width * (under[..., 0] - under[..., 1])
    return Strain(force, torch.zeros_like(force), torch.zeros_like(force, dtype=torch.bool))
