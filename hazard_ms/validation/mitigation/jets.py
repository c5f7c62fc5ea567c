"""Extinguishers in a room with one burning block, whose numbers hazard_ms.validation.mitigation.fire_cases has."""

from __future__ import annotations

import math

import torch

from hazard_ms.hazards.base import begin
from hazard_ms.hazards.fire.fire_state import BURNING
from hazard_ms.hazards.fire.realistic.blaze import Blaze
from hazard_ms.simulation.jet import Jet, spray
from hazard_ms.simulation.mitigation.equipment import Equipment
from hazard_ms.simulation.walls import Walls
from hazard_ms.simulation.world import World
from hazard_ms.spec.extinguishers import CRIB, EXTINGUISHERS
from hazard_ms.validation.experiments.fire_room import room_world

FRAME = 1 / 30  # [s]
CRIBS = (5, 8, 13, 21, 27, 43, 55)  # lengths of the cribs of EN 3-7 [dm]
LONG = 300.0  # after which no more goes out [s] [ours]
ROW = torch.arange(1)


def rating(kind: str, charge: float) -> float:
    """The longest crib [dm] that `charge` [kg] of the extinguisher `kind` puts out, all of it on the crib."""
    seconds = charge / EXTINGUISHERS[kind].rate
    out = [length for length in CRIBS if put_out(kind, CRIB * length, seconds, Blaze())]
    return float(max(out, default=0))


def critical_rate() -> float:
    """Least flux of water [g/m^2 s] on a burning surface that puts it out in the end."""
    low, high = 8.0, 30.0  # surface [m^2]
    for _ in range(6):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if put_out("water", middle, LONG, Blaze()) else (low, middle)
    return 1000.0 * EXTINGUISHERS["water"].rate / math.sqrt(low * high)


def put_out(kind: str, surface: float, seconds: float, law: Blaze) -> bool:
    """Whether the extinguisher `kind` puts out a block with this burning `surface` [m^2] in so many `seconds`."""
    edge = math.sqrt(surface / 6.0)
    world = room_world([("cabinet", (4.0, 4.0, 0.0))], size=(8.0, 8.0), extent=(edge, edge, edge))
    state = begin(law, world)
    state.status[:], state.peak[:], state.growth[:], state.curve[:] = BURNING, 800.0, 100.0, -1
    state.burn_age[:], state.decline[:], state.burn_end[:] = 100.0, 1e6, 2e6
    state.roofed[:] = 0.0
    middle = torch.tensor([[4.0, 4.0, edge / 2]])
    jet = Jet.closed(1)
    world.jets = [jet]
    jet.open(ROW, kind, middle - torch.tensor([[2.5 if kind != "co2" else 1.5, 0.0, 0.0]]), middle)
    flows = round(seconds / (FRAME * law.time_scale))
    for frame in range(flows + law.every + 1):  # and until the fire is looked at next
        if frame == flows:
            jet.close(ROW)
        world.chance.tick()
        law.advance(state, world, FRAME)
        if int(state.status[0, 0]) != BURNING:
            return True
    return False


def discharge(kind: str) -> float:
    """Time [s] after which a new extinguisher `kind` is empty."""
    world: World = room_world([("fire_extinguisher", (4.0, 4.0, 0.0))])
    world.equipment = Equipment(world.specs, world.target, ("fire_extinguisher",))
    world.equipment.kinds[:] = list(EXTINGUISHERS).index(kind)
    world.equipment.state.charge[:] = EXTINGUISHERS[kind].charge
    world.held[:] = True
    jet = world.equipment.jet
    world.equipment.hands = [(jet, world.held)]
    jet.open(ROW, kind, torch.zeros(1, 3), torch.ones(1, 3))
    passed = 0
    while bool(jet.flowing[0]):
        world.equipment.advance(FRAME, 1.0)
        passed += 1
    return passed * FRAME


def throw(kind: str) -> float:
    """The distance that the jet of an extinguisher `kind` covers [m], to 1 cm."""
    jet = Jet.closed(1)
    jet.open(ROW, kind, torch.zeros(1, 3), torch.tensor([[1.0, 0.0, 0.0]]))
    far = torch.arange(1, 2001) * 0.01
    points = torch.stack([far, torch.zeros_like(far), torch.zeros_like(far)], -1)[None]
    return float(far[spray(jet, Walls.none(1), points)[0] > 0.0].max())
