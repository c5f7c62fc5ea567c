"""Extinguishers on a realistic fire: films of water or powder, and gas that smothers (torch).

    covered    dc/dt = r min(1, a / s) A / (4 S f): share of the burning surface S with a film; f: mass that covers a
               square metre, r: flux across the jet, s: its cross-section, a = S/4: what S shows on the average from
               one side (Cauchy), A = 4 a; on the floor r by the cosine of its angle to the floor's normal
    surface    S = the thing's surface, as far as it burns: by its release now over its peak
    water      boils away under TOUCH_FLUX of the fire's own flames, so less than q / LATENT does not help: 11.6 g/m^2 s
    powder     melts to a coat that stays
    gas        no heat while the flux is above `smothers`; it burns on afterwards
    out        as in `.wetting`: below STARVED of its heat, for good

The jet runs on the fire's clock (`Blaze.time_scale`), so that an extinguisher puts out what it is rated for: its charge
lasts as many seconds of fire as its data sheet says. Limits: steam and smoke
take no heat from jets, floors that do not burn yet are not wetted, a thing is hit as a whole or not at all.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.hazards.base import none_set
from hazard_ms.hazards.fire.coupling import NEVER
from hazard_ms.hazards.fire.fire_state import ALL_USED, BURNING, lit
from hazard_ms.hazards.fire.realistic import fuels, wetting
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.fire.realistic.burners import CELL_RELEASE
from hazard_ms.hazards.fire.realistic.radiation import Fires
from hazard_ms.hazards.fire.realistic.touching import TOUCH_FLUX
from hazard_ms.simulation.jet import Jet, spot, spray
from hazard_ms.simulation.world import World

LEAST = 0.05  # share of its surface that burns at least where a thing burns [ours]
SIDES = 4.0  # surface of a convex body over what it shows on the average from one side [Cauchy 1832]


def fight(state: BlazeState, world: World, fires: Fires, step: float) -> Fires:
    """Cover what the jets reach for `step` seconds of fire; returns the fires with what heat is left.

    Without extinguishers in the world nothing changes.
    """
    if not world.jets:
        return fires
    things = state.status.shape[1]
    boil = lit(state, world.frame) * (TOUCH_FLUX * step / (wetting.FILM * wetting.LATENT))
    state.flame_wet.copy_((state.flame_wet - boil).clamp(min=0.0))
    points = torch.cat([world.position, fires.place[:, things:]], 1)
    burns_on = torch.ones_like(fires.power, dtype=torch.bool)
    for jet in world.jets:
        flux = spray(jet, world.walls, points)
        film, boils = jet.number("film")[:, None], jet.number("boils")[:, None] > 0
        covered = _covered(state, world, fires, jet, points, flux) * (step / film.clamp(min=1e-6)) * (film > 0)
        for part, wet, coated in (
            (covered[:, :things], state.wet, state.coated),
            (covered[:, things:], state.flame_wet, state.flame_coated),
        ):
            wet.copy_((wet + part * boils).clamp(max=1.0))
            coated.copy_((coated + part * ~boils).clamp(max=1.0))
        burns_on &= flux < jet.number("smothers")[:, None]
    bare = torch.cat([1.0 - state.coated, (1.0 - state.flame_wet) * (1.0 - state.flame_coated)], 1)
    return fires._replace(power=fires.power * bare * burns_on)


def _covered(state: BlazeState, world: World, fires: Fires, jet: Jet, points: Tensor, flux: Tensor) -> Tensor:
    """Flux on the burning surface, [E, B + F], where `flux` [kg/m^2 s] of a jet arrives at `points`, [E, B + F, 3]."""
    things = state.status.shape[1]
    x, y, z = world.extent.unbind(-1)
    whole = fires.power[:, :things] / (1.0 - state.wet).clamp(min=wetting.STARVED)  # release of a dry one
    burns = torch.where(state.status == BURNING, whole / state.peak.clamp(min=1e-6), 1.0)
    surface = 2.0 * (x * y + y * z + z * x) * burns.clamp(LEAST, 1.0)
    flames = fires.power[:, things:].clamp(min=CELL_RELEASE) / fuels.AS_GOODS
    shown = torch.cat([surface, flames], 1).clamp(min=1e-6) / SIDES
    area, _ = spot(jet, points)
    from_one_side = flux * (area / shown).clamp(max=1.0) / SIDES
    way = points - jet.place[:, None]
    down = (-way[..., 2] / way.norm(dim=-1).clamp(min=1e-6)).clamp(min=0.0)
    on_floor = torch.zeros_like(flux, dtype=torch.bool)
    on_floor[:, things:] = state.flame_peak <= CELL_RELEASE
    return torch.where(on_floor, flux * down, from_one_side)


def go_out(state: BlazeState, world: World) -> None:
    """Put out, for good, what has next to no bare surface left. Does nothing without extinguishers."""
    if not world.jets:
        return
    starved = (1.0 - state.wet) * (1.0 - state.coated) < wetting.STARVED
    state.status.add_(((state.status == BURNING) & starved).long())  # burning -> burnt
    left = (1.0 - state.flame_wet) * (1.0 - state.flame_coated)
    out = lit(state, world.frame) & (left < wetting.STARVED)
    if none_set(out):
        return
    state.flame_birth.masked_fill_(out, NEVER)
    state.flame_used.masked_fill_(out, ALL_USED)
