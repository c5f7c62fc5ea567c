"""Water on a realistic fire, where another hazard provides it as a field: shares, not a switch (torch).

    under water   u = (level - base) / height of the thing, 0 to 1
    wet           w, the share of its surface with a film of water: as much as was ever under water, until it dries
    drying        dw/dt = -q / (FILM LATENT) above the water, q the flux on it; TOUCH_FLUX in its own flames
    burning       a thing gives off 1 - w of its heat; below STARVED it goes out, for good
    heating       a thing that is wet all over is no hotter than boiling water, so it ignites once a part is dry

The fires with which a scene begins stand for things (`Severity.fire_height`), which burn above the water. Fire on the
floor goes out under WET of water, and does not come back there. Limits: wet surfaces dry from above, and only by heat.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.hazards.base import none_set
from hazard_ms.hazards.fire import floor
from hazard_ms.hazards.fire.coupling import BOILING, NEVER, WET
from hazard_ms.hazards.fire.fire_state import ALL_USED, BURNING
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.fire.realistic.burners import CELL_RELEASE
from hazard_ms.hazards.fire.realistic.touching import TOUCH_FLUX
from hazard_ms.simulation.world import World

FILM = 0.25  # water that clings to a wet surface, a quarter of a millimetre [kg/m^2] [ours]
LATENT = 2_592.0  # heat that takes water from 20 C to steam of 100 C: 335 + 2,257 [kJ/kg] [M: IAPWS steam tables]
STARVED = 0.05  # share of its heat below which a fire cannot keep itself alight [ours]
SOAKED = 0.999  # wet share from which a thing is wet all over


def soak(state: BlazeState, world: World) -> None:
    """Wet what is under water now, and put out what is drowned. Does nothing where no hazard provides water."""
    if "water" not in world.fields:
        return
    level = world.fields["water"]
    bodies = world.num_bodies
    base = world.base_of(world.position, world.rotation, world.extent)
    depth = level(torch.cat([base, state.flame_place], 1)) - torch.cat([base, state.flame_place], 1)[..., 2]
    within_reach = world.exists & ~world.held & ~world.safe
    height = 2.0 * floor.half_spans(world.rotation, world.extent)[..., 2].clamp(min=WET / 2.0)
    under = torch.where(within_reach, (depth[:, :bodies] / height).clamp(0.0, 1.0), 0.0)
    state.under_water.copy_(under)
    state.wet.copy_(torch.maximum(state.wet, under))
    state.status.add_(((state.status == BURNING) & (state.wet > 1.0 - STARVED)).long())  # burning -> burnt
    _cool(state)
    _drown(state, depth[:, bodies:])


def _drown(state: BlazeState, depth: Tensor) -> None:
    """Let the flames on the floor burn above the water over it, `depth` [m], [E, F], or put them out."""
    first = state.flame_peak > CELL_RELEASE
    above = 1.0 - depth / torch.where(first, state.first_height[:, None], WET)
    state.flame_dry.copy_(torch.where(first, above.clamp(0.0, 1.0), (above > 0.0).float()))
    drowned = (state.flame_cell >= 0) & (state.flame_dry < STARVED)
    if none_set(drowned):
        return
    state.flame_birth.masked_fill_(drowned, NEVER)
    state.flame_used.masked_fill_(drowned, ALL_USED)


def dry(state: BlazeState, flux: Tensor, step: float) -> None:
    """Dry what is wet for `step` seconds of fire under `flux` [kW/m^2], [E, B], or under its own flames."""
    if none_set(state.wet > 0):
        return
    heat = torch.where(state.status == BURNING, TOUCH_FLUX, flux)
    state.wet.copy_(torch.maximum(state.wet - heat * (step / (FILM * LATENT)), state.under_water))
    _cool(state)


def _cool(state: BlazeState) -> None:
    """Keep what is wet all over from being hotter than boiling water."""
    cooled = torch.where(state.wet >= SOAKED, state.temperature.clamp(max=BOILING), state.temperature)
    state.temperature.copy_(cooled)
