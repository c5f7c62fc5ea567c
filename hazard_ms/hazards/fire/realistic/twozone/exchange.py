"""Flows through openings at the pressures of the rooms: smoke, air, and what both draw in behind one (Warp).

Smoke rises behind an opening into the layer, air sinks below it. Both draw in what they pass, as spill plumes do (Poreh
et al. 1998, as in CFAST 7), over the height z, of which air that falls through a layer mixes a quarter:

    m = 0.44 (T_a / T_h)^(2/3) (g rho_a^2 / (c T_a))^(1/3) Q^(1/3) w^(2/3) z,   Q = c m_0 (T_h - T_a)

First all flows out of a layer are added up, then each gets its share of it: no layer gives more than it has.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.hazards.fire.realistic.twozone import balance, gas, vents
from hazard_ms.hazards.fire.realistic.twozone.balance import Rooms
from hazard_ms.hazards.fire.realistic.twozone.gas import Gas
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

AIR, KELVIN, GRAVITY = (wp.constant(v) for v in (radiation.AIR, radiation.KELVIN, radiation.GRAVITY))
SPILL = 0.44  # coefficient of spill plumes [-] [M: Poreh]
LOWEST = 0.1  # height of the air that comes in, at least, over that of the room [-] [ours]
FALLING = 0.25  # share of it by which air mixes that falls through a layer [-] [M: CFAST]


@wp.func
def spill(flow: float, hot: float, cold: float, width: float, high: float) -> float:
    """Gas [kg/s] that a `flow` [kg/s] of `hot` gas draws in from `cold`, [C], or cold from hot.

    It rises, or falls, by `high` [m] behind an opening of a `width` [m].
    """
    found = float(0.0)
    if flow > 0.0 and high > 0.0 and hot > cold:
        low = cold + KELVIN
        dense = AIR / low
        third = wp.float32(1.0 / 3.0)
        heat = flow * (hot - cold)
        scale = wp.pow(GRAVITY * dense * dense / low * heat, third)
        found = SPILL * wp.pow(low / (hot + KELVIN) * width, 2.0 * third) * scale * high
    return found


@wp.func
def carry(
    e: int, a: int, from_smoke: bool, b: int, to_smoke: bool, rate: float, dt: float, count: bool,
    rooms: Rooms, work: wp.array3d(dtype=float), smoke: wp.array2d(dtype=Gas), air: wp.array2d(dtype=Gas),
):  # fmt: skip
    """Take `rate` [kg/s] out of a layer of room `a`, or of the outside, into one of room `b`; -1 is the outside.

    Where it is to `count`, it is only added to what the layer loses.
    """
    if rate <= 0.0:
        return
    if count:
        if a >= 0:
            column = balance.GONE
            if from_smoke:
                column = balance.LOST
            work[e, a, column] = work[e, a, column] + rate
        return
    if b < 0:
        return
    moved = Gas()
    if a < 0:
        moved[gas.MASS] = rate * dt
    elif from_smoke:
        share = rate * dt / wp.max(rooms.zone_smoke[e, a][gas.MASS] + dt * work[e, a, balance.LOST], 1.0e-9)
        moved = share * rooms.zone_smoke[e, a]
    else:
        share = rate * dt / wp.max(rooms.zone_air[e, a][gas.MASS] + dt * work[e, a, balance.GONE], 1.0e-9)
        moved = share * rooms.zone_air[e, a]
    if to_smoke:
        smoke[e, b] = smoke[e, b] + moved
    else:
        air[e, b] = air[e, b] + moved


@wp.func
def pour(
    e: int, a: int, b: int, opening: wp.vec4, here: vents.Side, there: vents.Side,
    hot: float, cold: float, under: float, dt: float, count: bool,
    rooms: Rooms, work: wp.array3d(dtype=float), smoke: wp.array2d(dtype=Gas), air: wp.array2d(dtype=Gas),
):  # fmt: skip
    """Carry what flows through an `opening` out of room `a`, `here`, into room `b`, `there`.

    [kg/s]: `hot` smoke, `cold` air, and of that what comes `under` the ceiling, into the layer.
    """
    carry(e, a, True, b, True, hot, dt, count, rooms, work, smoke, air)
    carry(e, a, False, b, False, cold, dt, count, rooms, work, smoke, air)
    if b >= 0:
        if count:
            work[e, b, balance.FRESH] = work[e, b, balance.FRESH] + cold
        warm, cool = rooms.zone_temperature[e, b], rooms.zone_low_temperature[e, b]
        rise = there.face - wp.max(here.face, opening[1])
        risen = spill(hot, AIR / here.density - KELVIN, cool, opening[0], rise)
        fall = wp.min(here.face, opening[2]) - wp.max(there.face, opening[1])
        fallen = FALLING * spill(under, warm, AIR / here.air - KELVIN, opening[0], fall)
        carry(e, b, False, b, True, risen, dt, count, rooms, work, smoke, air)
        carry(e, b, True, b, False, fallen, dt, count, rooms, work, smoke, air)


@wp.func
def exchange(
    e: int, outside: float, dt: float, rooms: Rooms,
    work: wp.array3d(dtype=float), smoke: wp.array2d(dtype=Gas), air: wp.array2d(dtype=Gas),
):  # fmt: skip
    """Find what the layers gain in `dt` [s], `smoke` and `air`, and lose; `outside` [kg/m^3] is the density there.

    Plumes take part: what they draw in leaves the air, and what fires make of it is theirs.
    """
    for r in range(rooms.zone_area.shape[1]):
        work[e, r, balance.LOST] = 0.0
        work[e, r, balance.GONE] = 0.0
        work[e, r, balance.FRESH] = 0.0
    for turn in range(2):
        count = turn == 0
        for r in range(rooms.zone_area.shape[1]):
            carry(e, r, False, r, True, work[e, r, balance.ENTRAINED], dt, count, rooms, work, smoke, air)
        for o in range(rooms.vents.shape[1]):
            vent = rooms.vents[e, o]
            if vent[0] > 0.0:
                a, b = int(rooms.vent_from[e, o]), int(rooms.vent_to[e, o])
                here = balance.side(e, a, rooms.zone_pressure[e, wp.max(a, 0)], outside, rooms)
                there = balance.side(e, b, rooms.zone_pressure[e, wp.max(b, 0)], outside, rooms)
                flow = vents.through(vent[0], vent[1], vent[2], here, there)
                pour(e, a, b, vent, here, there, flow.hot, flow.cold, flow.under, dt, count, rooms, work, smoke, air)
                pour(
                    e, b, a, vent, there, here, flow.hot_back, flow.cold_back, flow.under_back, dt, count,
                    rooms, work, smoke, air,
                )  # fmt: skip
    for r in range(rooms.zone_area.shape[1]):
        if rooms.zone_area[e, r] > 0.0:
            high = wp.max(rooms.zone_height[e, r], LOWEST * rooms.height[e])
            across = AIR / (rooms.zone_low_temperature[e, r] + KELVIN) * wp.sqrt(rooms.zone_area[e, r]) * high
            rooms.zone_draught[e, r] = work[e, r, balance.FRESH] / across
