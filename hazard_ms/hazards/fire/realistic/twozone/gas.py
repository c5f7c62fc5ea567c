"""Parts of a layer of gas, and its temperature and volume (Warp).

A layer has a mass m and an excess heat E: its temperature is T_0 + E / (c m), its volume m T / 353. c is the mean heat
capacity of air between both, 1 + 0.0001 (T - T_0) kJ/kg K. It also has soot, carbon monoxide and hydrogen cyanide, and
lacks oxygen against as much air: what burns becomes gas, too. All of these go along with a share of its mass.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.fire.realistic import radiation
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

PARTS = 6  # of Gas
MASS, ENERGY, SOOT, LACK, MONOXIDE, CYANIDE = (wp.constant(k) for k in range(PARTS))  # kg, kJ, kg, kg, kg, kg
Gas = wp.types.vector(length=PARTS, dtype=float)

OXYGEN = 0.232  # mass fraction of oxygen in air [-]
SWELLING = 1.0e-4  # mean heat capacity of air per rise of its temperature, from 1 on [kJ/kg K^2] [M: Incropera]
LEAST_LAYER = wp.constant(1e-3)  # mass from which a layer has a temperature [kg] [ours]
AIR, KELVIN = wp.constant(radiation.AIR), wp.constant(radiation.KELVIN)


@wp.func
def rise(gas: Gas) -> float:
    """Rise [K] of a layer's temperature above the outside's."""
    found = float(0.0)
    if gas[MASS] > LEAST_LAYER:
        heat = gas[ENERGY] / gas[MASS]
        found = 2.0 * heat / (1.0 + wp.sqrt(wp.max(1.0 + 4.0 * SWELLING * heat, 0.0)))
    return found


@wp.func
def temperature(gas: Gas, room: float) -> float:
    """Temperature [C] of a layer in a room of `room` [C]."""
    return room + rise(gas)


@wp.func
def volume(gas: Gas, room: float) -> float:
    """Volume [m^3] of a layer in a room of `room` [C]."""
    return gas[MASS] * (room + KELVIN + rise(gas)) / AIR


@wp.func
def swelling(gas: Gas) -> float:
    """Volume [m^3/kJ] that a layer gains with heat."""
    return 1.0 / (AIR * (1.0 + 2.0 * SWELLING * rise(gas)))


@wp.func
def oxygen(gas: Gas) -> float:
    """Mass fraction of oxygen in a layer [-]."""
    rich = OXYGEN
    if gas[MASS] > LEAST_LAYER:
        rich = OXYGEN - gas[LACK] / gas[MASS]
    return rich


@wp.func
def drawn(rate: float, mass: float, dt: float) -> float:
    """Flow [kg/s] out of a layer of `mass` [kg] that would be `rate` [kg/s] of an endless one: no more than it has.

    Over `dt` [s] it is that of exp(-t) to the first order.
    """
    return rate * mass / wp.max(mass + dt * rate, 1.0e-9)
