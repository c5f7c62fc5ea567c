"""Water through openings between places of known depth: gaps of closed doors, broken doors, windows.

    weir      0.4 b sqrt(2 g) H^1.5, less by Villemonte's factor once the water behind stands above the sill, too
    orifice   0.611 b a sqrt(2 g dH) at most, where the water stands above the opening

The law is that of the inlets (hazard_ms.hazards.flood.realistic.inlets), L-26 to L-28 and L-39 of docs/physics.md.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.hazards.flood.realistic import inlets
from hazard_ms.kernels.launch import Launches


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
