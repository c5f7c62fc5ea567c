"""Openings as smoke sees them, and what it does to what closes them: pressure, and fire that burns through (torch).

The net force on a leaf is the pressure on one side less that on the other, over its height (the laws of .vents). A leaf
burns as in the furnace of ISO 834, T = 20 + 345 log10(8 t + 1), t in minutes: after a furnace time t it ages by

    dt_furnace / dt = q / q_furnace(t),   q = flux of fires and layer + h (T_gas - T_0) on its hotter face

so that a leaf under the standard curve ages by a second a second, and one under twice the heat twice as fast. Below the
flux that ignites wood it does not age. The hotter face is read near the top, where layers and flames are. Limits: heat
counts as if the leaf were cold; a leaf is gone at once.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor

from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.fire.realistic.radiation import AIR, CONVECTION, GRAVITY, KELVIN, STEFAN
from hazard_ms.hazards.fire.realistic.twozone.balance import FAR
from hazard_ms.simulation.openings import Strain
from hazard_ms.simulation.world import World
from hazard_ms.spec import rounding

CHARS = 12.5  # least flux that ignites wood with a flame beside it [kW/m^2] [M: SFPE]
FIRST = 60.0  # furnace time below which the furnace counts as hot as then: 349 C [s] [ours]
HIGH = 0.9  # share of a leaf's height at which its heat is read [ours]


def furnace(seconds: Tensor) -> Tensor:
    """Heat [kW/m^2], [...], on a cold face in the furnace of ISO 834 after so many seconds, [...]; from FIRST on."""
    warmth = 345.0 / math.log(10.0) * rounding.log(8.0 / 60.0 * seconds.clamp(min=FIRST) + 1.0)
    cold = 20.0 + KELVIN
    return STEFAN * ((warmth + cold) ** 4 - cold**4) + CONVECTION * warmth


def ageing(heat: Tensor, spent: Tensor) -> Tensor:
    """Standard fire per time [s/s], [...], of leaves under `heat` [kW/m^2] that bore `spent` [s] of it, [...]."""
    return torch.where(heat < CHARS, 0.0, heat / furnace(spent))


def faces(world: World) -> Tensor:
    """Points [m], [E, P, 3], world frame, at which the heat on openings is read: O first sides, then O second ones."""
    plan = world.openings.plan
    points = plan.beside.transpose(1, 2).clone()  # [E, 2, O, 3]
    points[..., 2] += (plan.sill + HIGH * (plan.top - plan.sill))[:, None]
    return points.flatten(1, 2)


def vents(world: World, fallen: Tensor | None = None) -> Tensor:
    """Openings for smoke, as `vents` of BlazeState: width, lower and upper end, width without panes [m], [E, O, 4].

    What is under water on either side passes none. `fallen` [E, O] are panes that heat has broken already.
    """
    plan, width = world.openings.plan, world.openings.width
    if fallen is not None:
        width = torch.where(fallen & plan.window, plan.width, width)
    low = plan.sill
    if "water" in world.fields:
        level = world.fields["water"](plan.beside.flatten(1, 2)).unflatten(1, (-1, 2)).amax(-1)
        low = torch.minimum(torch.maximum(low, level), plan.top)
    return torch.stack([width, low, plan.top, torch.where(plan.window, plan.width, width)], -1)


def fallen(state: BlazeState, world: World) -> Tensor:
    """Windows whose panes the smoke has broken, [E, O], bool."""
    plan = world.openings.plan
    return (state.vents[..., 0] >= plan.width) & plan.window


def strain(state: BlazeState, world: World, flux: Tensor, gas: Tensor, room: float, time_scale: float) -> Strain:
    """Force [N] and heat of smoke on openings, [E, O] each, in a scene of `room` [C].

    `flux` [kW/m^2] and `gas` [C], [E, 2 O], are those at `faces`; fire is `time_scale` times as fast as the episode.
    """
    plan, held = world.openings.plan, world.openings.state.hold
    heat = (flux + CONVECTION * (gas - room)).unflatten(1, (2, -1)).amax(1)
    spent = torch.where(plan.resistance.isfinite(), plan.resistance - held, 0.0)
    aged = torch.where(plan.door, time_scale * ageing(heat, spent), 0.0)
    low, top, dense = state.vents[..., 1], state.vents[..., 2], AIR / (room + KELVIN)
    outside = torch.zeros_like(low)
    first, second = (
        torch.where(number < 0, _push(outside, FAR, dense, dense, low, top), _of_room(state, number, low, top))
        for number in (state.vent_from, state.vent_to)
    )
    return Strain(plan.width * (first - second), aged, fallen(state, world))


def _of_room(state: BlazeState, number: Tensor, low: Tensor, top: Tensor) -> Tensor:
    """Pressure of the rooms `number`, [E, O], over height [N/m], [E, O]."""
    names = ("pressure", "height", "temperature", "low_temperature")
    pressure, face, hot, cool = (getattr(state, f"zone_{name}").gather(1, number.clamp(min=0)) for name in names)
    return _push(pressure, face, AIR / (hot + KELVIN), AIR / (cool + KELVIN), low, top)


def _push(
    pressure: Tensor, face: Tensor | float, hot: Tensor | float, cool: Tensor | float, low: Tensor, top: Tensor
) -> Tensor:
    """Integral of `vents.head` from `low` to `top` [m]: pressure over height [N/m], [E, O]."""
    face = torch.as_tensor(face, dtype=low.dtype, device=low.device)

    def weight(z: Tensor) -> Tensor:
        under, over = torch.minimum(z, face), (z - face).clamp(min=0.0)
        return cool * (0.5 * under.square() + face * over) + 0.5 * hot * over.square()

    return pressure * (top - low) - GRAVITY * (weight(top) - weight(low))
