"""Fires in rooms of other authors' experiments and correlations, whose numbers hazard_ms.validation.smoke_cases has."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace

import torch

from hazard_ms.hazards.fire.realistic import radiation, smoke, tenability
from hazard_ms.hazards.fire.realistic.twozone import leaves
from hazard_ms.hazards.fire.realistic.twozone.lining import GYPSUM, Lining
from hazard_ms.spec import Opening, Partition, Room
from hazard_ms.validation.experiments.smoke_room import INSULATED, METHANE, SLOT, Burner, burn, course, fire_at, rooms

FIBRE = Lining(0.09e-3, 200.0, 0.013)  # ceramic fibre board of Steckler's room: k rho c as FDS and CFAST take it
MARINITE = Lining(0.12e-3, 737 * 1.25, 0.0254)  # of the room of ICFMP's benchmark exercise 3
PANES = "window"  # openings without panes are windows whose panes are out
STEP = 0.75  # [s]


@dataclass(frozen=True)
class Compartment:
    """A room with a fire of constant power in its middle, or of one that grows to it."""

    size: tuple[float, float, float]  # [m]
    doors: tuple[Opening, ...]  # all open
    power: float  # [kW]
    lining: Lining = GYPSUM
    radiant: float = 0.35  # share of the heat that is radiated
    growth: float = math.inf  # [kW/s^2]
    partitions: tuple[Partition, ...] = ()
    at: tuple[float, float] | None = None  # where it burns [m]
    combustion: float = METHANE  # heat per fuel [kJ/kg]


@dataclass(frozen=True)
class Now:
    """The first room at one time."""

    power: float  # that has oxygen [kW]
    rise: float  # temperature of the layer above the outside [K]
    height: float  # lower face of the layer [m]
    pressure: float  # at the floor above the outside [Pa]


@functools.cache
def burnt(case: Compartment, times: tuple[float, ...]) -> dict[float, Now]:
    """A compartment at `times` [s], in rising order."""
    room = Room(case.size[:2], case.size[2], openings=case.doors, partitions=case.partitions)
    state, world = rooms(room, case.lining)
    for number, door in enumerate(case.doors):
        state.vents[0, number, 0] = door.width
    burner = Burner(case.power, case.size, radiant=case.radiant, combustion=case.combustion, step=STEP)
    fire = fire_at(*(case.at or (case.size[0] / 2, case.size[1] / 2)), burner)
    seen, now, power = {}, 0.0, 0.0
    for time in times:
        while now < time - 0.5 * STEP:
            grown = min(case.power, case.growth * (now + 0.5 * STEP) ** 2)
            power = burn(state, world, burner, fire._replace(power=torch.full_like(fire.power, grown)), STEP)
            now += STEP
        numbers = (float(v[0, 0]) for v in (state.zone_temperature, state.zone_height, state.zone_pressure))
        warmth, height, pressure = numbers
        seen[time] = Now(power, warmth - 20.0, height, pressure)
    return seen


def door(width: float, high: float, wall: str = "south", centre: float = 1.2, sill: float = 0.0) -> Opening:
    """An open door, or a hole with a `sill` [m], in an outer wall; sizes and place [m]."""
    return Opening(PANES, wall, centre, width, high, sill)


@functools.cache
def steckler(width: float, power: float, ambient: float) -> tuple[float, float]:
    """Steckler's room, 2.8 x 2.8 x 2.13 m, with a door of `width` x 1.83 m [m], after half an hour.

    Methane on a burner in the middle gives off `power` [kW] and radiates 0.2 of it. Returns the rise of the layer [K]
    above `ambient` [C], and the height of its lower face [m].
    """
    burner = Burner(power, (2.8, 2.8, 2.13), (width, 0.0, 1.83), FIBRE, 0.2, ambient, soot=0.0)
    seen = course(burner, (1800.0,))[1800.0]
    return seen.rise, seen.height


def two_rooms(power: float) -> float:
    """Rise of the layer [K] after 15 min in the first of Nielsen's two rooms of 3.6 x 2.4 x 2.4 m, door after door."""
    doors = (Opening("doorway", "partition_1", 1.2, 0.8, 2.0), door(0.8, 2.0, "east"))
    wall = (Partition("partition_1", "y", 3.65, 0.1),)
    case = Compartment((7.3, 2.4, 2.4), doors, power, partitions=wall, at=(1.8, 1.2))
    return burnt(case, (900.0,))[900.0].rise


def flashover(case: Compartment, rise: float = 580.0) -> float:
    """Least power [kW] of a fire whose layer is warmer by `rise` [K] after ten minutes, within 1 %."""
    low, high = 100.0, 4000.0
    while high > 1.01 * low:
        middle = math.sqrt(low * high)
        hot = burnt(replace(case, power=middle), (600.0,))[600.0].rise >= rise
        low, high = (low, middle) if hot else (middle, high)
    return high


def filled(seconds: float) -> float:
    """Lower face of the layer [m] in a closed hall of 15 x 10 x 5 m, 500 kW, after so many seconds."""
    return course(Burner(500.0, (15.0, 10.0, 5.0), SLOT, INSULATED, 0.3, step=0.25), (seconds,))[seconds].height


def jet(aside: float) -> float:
    """Rise [K] under a ceiling 3 m above 1,000 kW, `aside` [m] of the fire."""
    return float(smoke.jet_rise(torch.tensor([1000.0]), torch.tensor([aside]), torch.tensor([3.0])))


def helpless(part: int, share: float) -> float:
    """Minutes in which a gas, of which a `part` of gas.Gas is a `share` of the mass, makes people helpless."""
    gas = torch.zeros(6)
    gas[0], gas[part] = 1.0, share
    return 1 / 60 / float(tenability.toxic_rate(gas))


def behind_a_closed_door(power: float) -> float:
    """Pressure [Pa] of a fire of `power` [kW] in a room over that of the next, behind a closed door of 0.9 x 2.0 m."""
    doors = (Opening("door", "wall", 2.0, 0.9, 2.0), door(1.0, 2.0, "east", 2.0))
    room = Room((6.0, 4.0), openings=doors, partitions=(Partition("wall", "y", 3.0),))
    state, world = rooms(room, INSULATED)
    state.vents[0, 1, 0] = 1.0
    burner = Burner(power, radiant=0.0, step=0.25)
    burn(state, world, burner, fire_at(1.5, 2.0, burner), 5.0)
    return float(state.zone_pressure[0, 0] - state.zone_pressure[0, 1])


def burnt_through(warmth: float | None) -> float:
    """Time [s] after which a door between rooms burns through: under a black layer of so many [C], or the furnace."""
    room = Room(
        (6.0, 4.0), openings=(Opening("door", "wall", 2.0, 0.9, 2.0),), partitions=(Partition("wall", "y", 3.0),)
    )
    state, world = rooms(room)
    passed, cold = 0.0, torch.full((1, 2 * world.openings.count), 20.0)
    while not bool(world.openings.state.broken[0, 0]):
        now = 20.0 + 345.0 * math.log10(8.0 * passed / 60.0 + 1.0) if warmth is None else warmth
        flux = torch.full_like(cold, radiation.STEFAN * ((now + 273.15) ** 4 - 293.15**4))
        strain = leaves.strain(state, world, flux, torch.full_like(cold, now), 20.0, 1.0)
        world.openings.bear([strain], torch.ones(1, dtype=torch.bool), 1.0)
        passed += 1.0
    return passed
