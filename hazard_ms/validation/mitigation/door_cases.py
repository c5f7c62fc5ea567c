"""Cases of doors that are opened, shut and held, E-6 to E-9 of docs/physics.md 2.7."""

from __future__ import annotations

import math
from collections.abc import Iterator

import torch

from hazard_ms.hazards.case import Case, table
from hazard_ms.hazards.flood.realistic import openings
from hazard_ms.simulation.mitigation import hinges
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Opening, Partition, Room, SceneSpec
from hazard_ms.validation.experiments.fire_room import FAR

INCH_OF_WATER, INCH = 249.1, 0.0254  # [Pa], [m]
CLOSER, MOST = 26.7, 133.4  # force of the closer, and at most at the handle [N]: 6 and 30 lbf
# Pressure over a door 7 ft high at which it takes 30 lbf to open it against a closer of 6 lbf, by its width [in]: in
# inches of water [NFPA 92, table A.4.4.2.2]
NFPA_92 = {32: 0.45, 36: 0.40, 40: 0.37, 44: 0.34, 48: 0.31}
DOOR = Opening("door", "middle", 2.0, 0.9, 2.05)
# rho g w h^2 / 2, w 0.9 m
REST = {0.1: 44.1, 0.3: 397.3, 0.5: 1103.6}
# 22.2 N + rho g w h^2 / 2 0.45 m / 0.83 m
HANDLE = {0.1: 46.1, 0.3: 237.6, 0.5: 620.5}
# weir 0.4 b sqrt(2 g) h^1.5 with b = 0.9 (1 - cos) [m], 0.5 m of water, by the angle [degrees]
AJAR = {30: 0.0755, 60: 0.2819, 90: 0.5638}


def world() -> World:
    """Two rooms with a door of 0.9 m between them."""
    room = Room((6.0, 4.0), openings=(DOOR,), partitions=(Partition("middle", "y", 3.0),))
    pan = Body("pan_0", "pan", "none", (1.0, 1.0, 0.0))
    spec = SceneSpec("test/door", room, (), (pan,), (), (), AgentStart(FAR))
    return World.of((spec,), [[(0.1, 0.1, 0.1)]], [[1.0]])


def pressure(inches: int) -> float:
    """Pressure [inches of water] over a door of this width [in] that takes MOST to open against CLOSER."""
    width = inches * INCH
    low, high = 0.0, 1e4  # [N]
    for _ in range(60):
        middle = 0.5 * (low + high)
        more = hinges.handle_force(middle, width) - hinges.handle_force(0.0, width) > MOST - CLOSER
        low, high = (low, middle) if more else (middle, high)
    return low / (width * 84 * INCH) / INCH_OF_WATER


def press(depth: float) -> float:
    """Force [N] of water `depth` [m] deep on one side of the door, as the flood lets it act."""
    made = world()
    level = torch.zeros(1, made.openings.count, 2)
    level[0, 0, 0] = depth
    return float(openings.press(level, 0.0, made, 1000.0 * 9.81).force[0, 0])


def pull(depth: float) -> float:
    """Force [N] at the handle of the door with water `depth` [m] deep on the side into which it opens."""
    return hinges.handle_force(press(depth), DOOR.width)


def ajar(degrees: int) -> float:
    """Discharge [m^3/s] from 0.5 m of water into a dry room, through the door turned by so many `degrees`."""
    made = world()
    made.openings.set_open(torch.arange(1), 0, hinges.share(math.radians(degrees)))
    one = torch.ones_like(made.openings.width)
    return float(openings.discharge(0.5 * one, 0.0 * one, made.openings.width, 2.05 * one, 0.0 * one)[0, 0])


def cases() -> Iterator[Case]:
    """All cases of this module."""
    yield from table(
        "E-6", "pressure that holds a door {} in wide shut (NFPA 92)", NFPA_92, 0.03, pressure, unit="in H2O"
    )
    yield from table("E-7", "force of water {} m deep on a door", REST, 0.01, press, unit="N")
    yield from table("E-8", "force on its handle to open a door into water {} m deep", HANDLE, 0.01, pull, unit="N")
    yield from table("E-9", "discharge through a door turned by {} degrees", AJAR, 0.02, ajar, unit="m3/s")
