"""Heat and products of the fires of a room, by the oxygen that their plume draws in (Warp).

Heat is at most 13.1 MJ per kg of oxygen. What is drawn in is air from below the layer, and where flames reach into the
layer, from it, too. Carbon monoxide is what a material makes with enough air, or more as fuel over air says, phi =
demanded over possible heat: y = 0.22 / 180 atan(10 (phi - 1.25)) + 0.11 per fuel, angle in degrees (Gottuk and
Lattimer, layers above 900 K). Hydrogen cyanide goes from its yield with enough air, phi 0.5, to that without, phi 1.5.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.fire.realistic.twozone import balance, gas, plumes
from hazard_ms.hazards.fire.realistic.twozone.balance import Rooms
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

PER_OXYGEN = 13100.0  # heat per oxygen used up [kJ/kg] [M: Huggett]
LEAST_OXYGEN = 0.166  # mass fraction of oxygen below which nothing burns: 15 % by volume [-] [M: CFAST]
LAST_OXYGEN = 0.01  # span above it in which a fire in the air goes out [-] [ours]
DEGREES = wp.constant(57.29578)  # of a radian
LEAN_AIR, POOR_AIR = (
    wp.constant(0.5),
    wp.constant(1.5),
)  # fuel over air of well and badly ventilated fires [-] [M: Purser]


@wp.func
def monoxide(hunger: float) -> float:
    """Carbon monoxide per fuel [kg/kg] of a room with `hunger`, fuel over air [-]; 0 where there is none."""
    made = float(0.0)
    if hunger > 0.0:
        made = 0.22 / 180.0 * DEGREES * wp.atan(10.0 * (hunger - 1.25)) + 0.11
    return wp.max(made, 0.0)


@wp.func
def burn(e: int, r: int, dt: float, rooms: Rooms, work: wp.array3d(dtype=float)):
    """Find how much of the room's fires has oxygen, and the air that they draw in."""
    power, convected, area = work[e, r, balance.POWER], work[e, r, balance.CONVECTED], work[e, r, balance.AREA]
    share, hunger = float(1.0), float(0.0)
    work[e, r, balance.ENTRAINED] = 0.0
    if power > 0.0 and rooms.roofed[e] > 0.0:
        smoke, air = rooms.zone_smoke[e, r], rooms.zone_air[e, r]
        base = work[e, r, balance.BASE] / power
        fresh = plumes.entrained(power, convected, area, rooms.zone_height[e, r] - base, rooms.zone_draught[e, r])
        whole = plumes.entrained(power, convected, area, rooms.height[e] - base, rooms.zone_draught[e, r])
        work[e, r, balance.ENTRAINED] = fresh
        inner = gas.drawn(wp.max(whole - fresh, 0.0), smoke[gas.MASS], dt)
        pure, foul = gas.oxygen(air), gas.oxygen(smoke)
        lit = wp.clamp((pure - LEAST_OXYGEN) / LAST_OXYGEN, 0.0, 1.0)
        oxygen = lit * pure * gas.drawn(fresh, air[gas.MASS], dt) + wp.max(foul - LEAST_OXYGEN, 0.0) * inner
        hunger = power / wp.max(PER_OXYGEN * oxygen, 1.0e-6 * power)
        share = wp.min(1.0, 1.0 / hunger)
    rooms.zone_share[e, r] = share
    work[e, r, balance.HUNGER] = hunger


@wp.func
def products(e: int, r: int, dt: float, rooms: Rooms, work: wp.array3d(dtype=float)) -> gas.Gas:
    """Gas, soot, lack of oxygen and poisons that the fires of a room add to its layer in `dt` [s]."""
    made = gas.Gas()
    power, share, hunger = work[e, r, balance.POWER], rooms.zone_share[e, r], work[e, r, balance.HUNGER]
    if power > 0.0:
        poor = wp.clamp((hunger - LEAN_AIR) / (POOR_AIR - LEAN_AIR), 0.0, 1.0)
        lean, rich = work[e, r, balance.LEAN], work[e, r, balance.RICH]
        made[gas.SOOT] = dt * share * work[e, r, balance.SOOT]
        fuel = share * work[e, r, balance.FUEL]
        made[gas.MASS] = dt * fuel
        made[gas.LACK] = dt * (share * power / PER_OXYGEN + gas.OXYGEN * fuel)
        made[gas.MONOXIDE] = dt * wp.max(share * work[e, r, balance.MONOXIDE], fuel * monoxide(hunger))
        made[gas.CYANIDE] = dt * share * (lean + poor * (rich - lean))
    return made
