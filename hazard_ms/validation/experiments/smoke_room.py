"""Burners in single rooms and in flats: the smoke of the realistic fire, whose numbers blaze_cases compares."""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import NamedTuple

import torch

from hazard_ms.hazards.base import begin
from hazard_ms.hazards.fire.realistic import kindling, radiation, smoke
from hazard_ms.hazards.fire.realistic.blaze import Blaze
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.fire.realistic.twozone.lining import GYPSUM, Lining
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening, Room
from hazard_ms.validation.experiments.fire_room import room_world

HALL = (21.66, 7.04, 3.82)  # room of N-7 and N-8 [m]
DWELLING = (6.8, 6.4, 2.6)  # room of the comparison with MQH and Beyler [m]
DOOR = (0.9, 0.0, 2.0)  # an open door: width, lower and upper end [m]
SLOT = (0.9, 0.0, 0.02)  # the gap under a closed door [m]
INSULATED = Lining(1e-9, 1e3, 0.1)  # walls that take no heat
PANEL = Lining(0.12e-3, 737 * 1.42, 0.05)  # gypsum panel of N-8 [docs/physics.md 2.4]; thick, since Beyler's walls are
TIMES = (30.0, 60.0, 120.0, 225.0, 600.0)  # [s]
FULL = 0.01  # share of the height below which a layer fills its room [ours]
PER_AREA = 500.0  # heat release of a burner per area [kW/m^2] [ours]
METHANE, WOOD = 50000.0, 11900.0  # heat per fuel of burners, and of wood [kJ/kg]
WOOD_SOOT = 0.015 / WOOD  # yield of a wood fire [kg/kJ] [docs/physics.md 3.1]


@dataclasses.dataclass(frozen=True)
class Burner:
    """A fire of constant power in the middle of a room."""

    power: float  # [kW]
    size: tuple[float, float, float] = DWELLING  # [m]
    vent: tuple[float, float, float] = DOOR  # [m]
    lining: Lining = GYPSUM
    radiant: float = 0.35  # share of the heat that is radiated
    ambient: float = 20.0  # [C]
    soot: float = WOOD_SOOT  # [kg/kJ]
    combustion: float = METHANE  # heat per fuel [kJ/kg]
    step: float = 0.75  # [s]


def rooms(room: Room, lining: Lining = GYPSUM) -> tuple[BlazeState, World]:
    """The smoke of `room` as an episode begins, and its world."""
    world = room_world(size=room.size)
    world = dataclasses.replace(world, specs=tuple(dataclasses.replace(s, room=room) for s in world.specs))
    state = begin(Blaze(), world)
    state.lining_conductivity[:], state.lining_capacity[:] = lining.conductivity, lining.capacity
    state.lining_thickness[:] = lining.thickness
    return state, world


def fire_at(x: float, y: float, burner: Burner) -> radiation.Fires:
    """The fire of `burner` at a place on the floor [m]."""
    width = math.sqrt(4.0 * burner.power / PER_AREA / math.pi)
    numbers = (torch.tensor([[v]]) for v in (burner.power, burner.radiant, width))
    return radiation.Fires(torch.tensor([[[x, y, 0.0]]]), *numbers)


def burn(state: BlazeState, world: World, burner: Burner, fire: radiation.Fires, seconds: float) -> float:
    """Let the fire burn for `seconds`; returns its heat release in the end [kW]."""
    yields = (
        fire.power.new_tensor([burner.soot, 0.0, 0.0, 0.0, 1.0 / burner.combustion])
        .expand(*fire.power.shape, -1)
        .contiguous()
    )
    power = fire.power
    for _ in range(round(seconds / burner.step)):
        power = smoke.advance(state, world, fire, yields, burner.ambient, burner.step)
    return float(power.sum())


class Seen(NamedTuple):
    """A room at one time."""

    rise: float  # temperature of the layer above the outside [K]
    height: float  # lower face of the layer [m]
    mean: float  # excess heat over the heat capacity of the room's air [K]
    share: float  # share of the fire that has oxygen


@functools.cache
def course(burner: Burner, times: tuple[float, ...] = TIMES) -> dict[float, Seen]:
    """The burner's room at `times` [s], in rising order."""
    length, width, high = burner.size
    door = Opening("door", "south", length / 2, burner.vent[0], burner.vent[2] - burner.vent[1], burner.vent[1])
    state, world = rooms(Room((length, width), high, openings=(door,)), burner.lining)
    state.vents[0, 0, 0] = burner.vent[0]
    kindling.fill_with_air(state, torch.arange(1), burner.ambient)
    fire, seen, before = fire_at(length / 2, width / 2, burner), {}, 0.0
    for now in times:
        burn(state, world, burner, fire, now - before)
        mean = float((state.zone_smoke + state.zone_air)[..., 1]) / (1.2 * length * width * high)
        seen[now] = Seen(
            float(state.zone_temperature) - burner.ambient, float(state.zone_height), mean, float(state.zone_share)
        )
        before = now
    return seen


def filling(seconds: float, lining: Lining = INSULATED, radiant: float = 0.0) -> float:
    """Depth of the layer [m] in the hall of N-7 and N-8 after so many seconds: 410 kW, a gap at the floor."""
    burner = Burner(410.0, HALL, SLOT, lining, radiant, ambient=22.0, step=0.05)
    return HALL[2] - course(burner, (10.0, 20.0, 30.0))[seconds].height


def open_room(case: tuple[float, float]) -> float:
    """Rise of the layer's temperature [K] in the dwelling's room with an open door, by power [kW] and time [s]."""
    return course(Burner(case[0]))[case[1]].rise


def closed_room(case: tuple[float, float]) -> float:
    """The same in a closed room with a gap under its door: the mean of the room, or the layer's where it fills it."""
    seen = course(Burner(case[0], vent=SLOT, lining=PANEL))[case[1]]
    return seen.rise if seen.height < FULL * DWELLING[2] else seen.mean
