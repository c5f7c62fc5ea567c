"""Experiments with the realistic fire and its laws, whose results hazard_ms.validation.blaze_cases compares."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import torch
from torch import Tensor

from hazard_ms.hazards.base import begin
from hazard_ms.hazards.fire import spread
from hazard_ms.hazards.fire.fire import BURNING, NORMAL
from hazard_ms.hazards.fire.realistic import burning, radiation, smoke, tenability
from hazard_ms.hazards.fire.realistic import front as edge
from hazard_ms.hazards.fire.realistic.blaze import Blaze
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.simulation.world import World
from hazard_ms.validation import correlations
from hazard_ms.validation.experiments.fire_room import room_world

HALL = (20.0, 20.0)  # floor of the rooms in which one fire burns [m]
# fires begin with a large waste basket: heat release [kW] [docs/physics.md 3.1], diameter of the base [m] [ours]
PLAIN = Blaze(time_scale=1.0, every=1, first_release=100.0, first_base=0.3)


def number(value: float) -> Tensor:
    """A tensor of one `value`, any unit [-], shape [1]."""
    return torch.tensor([float(value)])


def point_flux(apart: float) -> float:
    """Flux [kW/m^2] on a target at floor level, facing a 100 kW burner of 0.3 x 0.3 m, `apart` [m] from it."""
    length = radiation.flame_length(number(100.0), number(math.sqrt(4 * 0.09 / math.pi)))
    square = apart**2 + (length / 3) ** 2
    return float(radiation.point_source(number(100.0), 0.35, square, apart / square.sqrt()))


def burner_flux(apart: float) -> float:
    """Flux from the same burner by the solid flame, with the flame length of the code."""
    wide = math.sqrt(4 * 0.09 / math.pi)
    return correlations.solid_flame(float(radiation.flame_length(number(100.0), number(wide))), wide, apart)


def plume() -> float:
    """Temperature [C] on the axis of Heskestad's plume of N-4."""
    return 22.0 + float(
        smoke.plume_rise(number(1245.0), 0.4, number(math.sqrt(4 * 1.075 / math.pi)), number(6.0), 22.0)
    )


def time_to_megawatt(growth: float) -> float:
    """Seconds to 1055 kW, to 0.1 s."""
    age = torch.arange(0, 700, 0.1)
    return float(age[burning.t_squared(growth, age) >= 1055.0][0])


def ignition_time(
    kpc: float, ignition: float, critical: float, flux: float, dt: float = 0.1, sheet: float = 0.0
) -> float:
    """Seconds to ignition of a surface at 20 C under a constant `flux`; infinite if not within 500 s."""
    solid = radiation.Solid(number(ignition), number(critical), number(kpc), number(sheet))
    temperature, steps = number(20.0), 0
    while float(temperature) < ignition:
        temperature = radiation.warm(temperature, number(flux), solid, 20.0, dt)
        steps += 1
        if steps * dt > 500.0:
            return math.inf
    return steps * dt


def radius(case: tuple[float, float]) -> float:
    """Farthest distance [m] at which a fire of a power [kW] gives a critical flux [kW/m^2], level with its point."""
    apart = torch.arange(0.1, 4.0, 0.001)
    return float(apart[radiation.point_source(torch.tensor(case[0]), 0.35, apart**2) >= case[1]][-1])


def released(category: str) -> float:
    """Energy [kJ] that a burning pillow or book of 1 kg gives off by the hazard's own curve."""
    state, _ = burn_room([(category, (5.0, 5.0, 0.0))])
    age = torch.linspace(0.0, float(state.burn_end[0, 0]), 200_001, dtype=torch.float64).float()
    course = burning.Course(*(v[0, :1].expand(age.shape) for v in state.course))
    return float(burning.release(course, age).double().mean() * state.burn_end[0, 0])


def peak(category: str, dt: float = 5.0) -> float:
    """Largest heat release [kW] of a thing that burns alone in a hall, within 450 s, by the hazard's own account."""
    state, world = burn_room([(category, (10.0, 10.0, 0.0))])
    state.status[:], most = BURNING, 0.0
    for _ in range(round(450.0 / dt)):
        world.chance.tick()
        PLAIN.advance(state, world, dt)
        most = max(most, float(state.heat_release))
    return most


def burn_room(
    bodies: list[tuple[str, tuple[float, float, float]]], blaze: Blaze = PLAIN, copies: int = 1, **room: Any
) -> tuple[BlazeState, World]:
    """A hall with `bodies` in it, and its fire as it begins."""
    floor = room.pop("floor", "tile")
    world = room_world(bodies, room.pop("fires", ()), size=HALL, copies=copies, extent=(0.2, 0.15, 0.04), **room)
    specs = tuple(
        dataclasses.replace(s, room=dataclasses.replace(s.room, floor=floor, height=20.0)) for s in world.specs
    )
    world = dataclasses.replace(world, specs=specs)
    return begin(blaze, world), world


def neighbour(apart: float, dt: float = 0.5) -> float:
    """Seconds until a book burns `apart` [m] from one waste basket of 100 kW on tiles; infinite if not within 600 s."""
    state, world = burn_room([("book", (10.0 + apart, 10.0, 0.0))], fires=[(10.0, 10.0)])
    for step in range(1, round(600 / dt) + 1):
        world.chance.tick()
        PLAIN.advance(state, world, dt)
        if int(state.status[0, 0]) != NORMAL:
            return step * dt
    return math.inf


def floor_megawatt(floor: str, horizon: float, dt: float = 2.0) -> float:
    """Seconds until a fire on an open `floor`, lit by a waste basket, gives off 1,055 kW; within `horizon` [s]."""
    blaze = dataclasses.replace(PLAIN, horizon=horizon)
    state, world = burn_room([], blaze, floor=floor, fires=[(10.0, 10.0)])
    before = 0.0
    for step in range(1, round(horizon / dt) + 1):
        world.chance.tick()
        blaze.advance(state, world, dt)
        now = float(state.heat_release)
        if now >= 1055.0:
            return dt * (step - (now - 1055.0) / (now - before))
        before = now
    return math.inf


def cell_ignition(case: tuple[str, float], dt: float = 0.25) -> float:
    """Seconds until a cell of a floor burns under a flux [kW/m^2] from 3 m above it; infinite if not in 400 s."""
    floor, flux = case
    state, world = burn_room([], floor=floor, fires=[(10.0, 10.0)])
    power = flux * 4.0 * math.pi * 3.0**2 / 0.35
    numbers = (torch.tensor([[v]]) for v in (power, 0.35, 100.0))  # so wide that its flames have no length
    lamp = radiation.Fires(torch.tensor([[[10.0 + spread.STEP, 10.0, 3.0]]]), *numbers)
    for step in range(1, round(400.0 / dt) + 1):
        edge.warm(state, world, lamp, 20.0, dt)
        edge.advance(state, world)
        if int((state.flame_cell >= 0).sum()) > 1:
            return step * dt
    return math.inf


def dose(temperature: float, flux: float) -> float:
    """Dose of heat per second [1/s] in air of `temperature` [C] under `flux` [kW/m^2]."""
    return float(tenability.dose_rate(number(temperature), number(flux)))
