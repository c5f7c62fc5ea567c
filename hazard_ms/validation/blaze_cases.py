"""The realistic fire: cases N of physics.md 2.4 and the tables of 3.1, in tensors, and its laws as the hazard runs them."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator
from typing import Any

import torch
from torch import Tensor

from hazard_ms.hazards import burning, fuels, radiation, smoke, tenability
from hazard_ms.hazards.blaze import Blaze
from hazard_ms.hazards.blaze_state import BlazeState
from hazard_ms.hazards.fire import NORMAL
from hazard_ms.validation import correlations
from hazard_ms.validation.cases import Case, table
from hazard_ms.validation.fire_room import room_world
from hazard_ms.world import World

ROOM = (21.66, 7.04, 3.82)  # of N-7 and N-8 [m]
GYPSUM = 0.00012 * 737 * 1.42  # k rho c of its walls [kW^2 s/m^4 K^2]
HALL = (20.0, 20.0)  # floor of the rooms in which one fire burns [m]
PLAIN = Blaze(lapse=1.0, every=1)
T_SQUARED = {
    ("slow", fuels.SLOW): 600.0,
    ("medium", fuels.MEDIUM): 300.0,
    ("fast", fuels.FAST): 150.0,
    ("ultrafast", fuels.ULTRAFAST): 75.0,
}
CARPET_ACRYLIC, CARPET_NYLON = (0.42, 300.0, 10.0), (0.68, 412.0, 18.0)  # k rho c, ignition, critical flux [physics.md 3.1]
PLYWOOD, PARTICLEBOARD, FOAM, PMMA = (0.54, 390.0, 16.0), (0.93, 412.0, 18.0), (0.32, 390.0, 16.0), (0.73, 278.0, 9.0)
THICK = {  # material and flux: seconds to ignition
    **{("carpet acrylic", *CARPET_ACRYLIC, q): t for q, t in ((20, 64.7), (30, 28.7), (50, 10.3))},
    **{("carpet nylon/wool", *CARPET_NYLON, q): t for q, t in ((20, 205), (30, 91), (50, 33))},
    **{("plywood", *PLYWOOD, q): t for q, t in ((20, 145), (30, 65), (50, 23))},
    **{("particleboard", *PARTICLEBOARD, q): t for q, t in ((20, 281), (30, 125), (50, 45))},
    **{("flexible foam", *FOAM, q): t for q, t in ((20, 86), (30, 38), (50, 14))},
    **{("PMMA", *PMMA, q): t for q, t in ((20, 95), (30, 42), (50, 15))},
}
FED_MINUTES = {60.0: 156.0, 100.0: 24.7, 120.0: 12.8, 150.0: 5.7, 200.0: 2.0}  # air [C]
FED_SECONDS = {2.5: 44.0, 5.0: 11.8, 10.0: 3.2}  # flux [kW/m^2]
RADII = {(100.0, 10.0): 0.53, (100.0, 20.0): 0.37, (300.0, 16.0): 0.72, (1000.0, 10.0): 1.67, (3000.0, 20.0): 2.04}
PEAKS = {("upholstered_chair", 200): 2099.6, ("sofa", 400): 3447, ("wardrobe", 170): 4500, ("workstation", 550): 6710, ("tv", 720): 280}


def number(value: float) -> Tensor:
    """A tensor of one number."""
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
    return 22.0 + float(smoke.plume_rise(number(1245.0), 0.4, number(math.sqrt(4 * 1.075 / math.pi)), number(6.0), 22.0))


@functools.cache
def filling(dt: float = 0.05) -> dict[int, float]:
    """Depth of the layer [m] in the closed room of N-7 by second: 410 kW, nothing lost to walls."""
    walls = smoke.Walls(number(ROOM[0] * ROOM[1]), number(ROOM[2]), number(0.0))
    area = walls.area.clone()
    layer, made = smoke.Layer(*(torch.zeros(1) for _ in range(3))), {}
    for step in range(1, round(30 / dt) + 1):
        lost = smoke.WALLS * area * (smoke.temperature(layer, 22.0) - 22.0) * (layer.volume > smoke.THIN)  # given back: N-7 has none
        source = smoke.Source(number(410.0), 410.0 + lost, number(0.0), number(0.0))
        layer = smoke.fill(layer, walls, torch.zeros(1, 1, 3), source, 22.0, 1500.0, dt)
        made[round(step * dt * 1000)] = float(layer.volume / area)
    return {t: made[t * 1000] for t in (10, 20, 30)}


def time_to_megawatt(growth: float) -> float:
    """Seconds to 1055 kW, to 0.1 s."""
    age = torch.arange(0, 700, 0.1)
    return float(age[burning.t_squared(growth, age) >= 1055.0][0])


def ignition_time(kpc: float, ignition: float, critical: float, flux: float, dt: float = 0.1, sheet: float = 0.0) -> float:
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
    """Farthest distance [m] at which a fire of a power [kW] gives a critical flux [kW/m^2], level with the point source."""
    apart = torch.arange(0.1, 4.0, 0.001)
    return float(apart[radiation.point_source(torch.tensor(case[0]), 0.35, apart**2) >= case[1]][-1])


def released(category: str) -> float:
    """Energy [kJ] that a burning pillow or book of 1 kg gives off by the hazard's own curve."""
    state, _ = burn_room([(category, (5.0, 5.0, 0.0))])
    age = torch.linspace(0.0, float(state.burn_end[0, 0]), 200_001, dtype=torch.float64).float()
    course = burning.Course(*(v[0, :1].expand(age.shape) for v in state.course))
    return float(burning.release(course, age).double().mean() * state.burn_end[0, 0])


def burn_room(
    bodies: list[tuple[str, tuple[float, float, float]]], blaze: Blaze = PLAIN, copies: int = 1, **room: Any
) -> tuple[BlazeState, World]:
    """A hall with `bodies` in it, and its fire as it begins."""
    floor = room.pop("floor", "tile")
    world = room_world(bodies, room.pop("fires", ()), size=HALL, copies=copies, extent=(0.2, 0.15, 0.04), **room)
    specs = tuple(dataclasses.replace(s, room=dataclasses.replace(s.room, floor=floor, height=20.0)) for s in world.specs)
    world = dataclasses.replace(world, specs=specs)
    state = BlazeState.allocate({"E": copies, "B": world.num_bodies, **blaze.sizes(world)}, world.device)
    blaze.reset(state, world, torch.arange(copies))
    return state, world


def neighbour(apart: float, dt: float = 0.5) -> float:
    """Seconds until a book burns `apart` [m] from one waste basket of 100 kW on tiles; infinite if not within 600 s."""
    state, world = burn_room([("book", (10.0 + apart, 10.0, 0.0))], fires=[(10.0, 10.0)])
    for step in range(1, round(600 / dt) + 1):
        world.chance.tick()
        PLAIN.advance(state, world, dt)
        if int(state.status[0, 0]) != NORMAL:
            return step * dt
    return math.inf


@functools.cache
def front(runs: int = 16, seconds: float = 800.0, dt: float = 4.0) -> float:
    """Speed [m/s] of the edge of a fire on an open wooden floor: that of a circle of the burning area, from 300 s on."""
    blaze = Blaze(lapse=1.0, every=1, horizon=seconds)
    state, world = burn_room([], blaze, runs, floor="wood", fires=[(10.0, 10.0)])
    seen = {}
    for step in range(1, round(seconds / dt) + 1):
        world.chance.tick()
        blaze._spread(state, world, dt)
        cells = (state.flame_cell >= 0).sum(1).double().mean()
        seen[step * dt] = math.sqrt(float(cells) * 0.22**2 / math.pi)
    return (seen[seconds] - seen[300.0]) / (seconds - 300.0)


def dose(temperature: float, flux: float) -> float:
    """Per second."""
    return float(tenability.dose_rate(number(temperature), number(flux)))


def of_guide() -> Iterator[Case]:
    """The numbers of NIST's guide."""
    yield from table("N-1", "point-source flux at {} m", {0.5: 6.01, 0.75: 3.65, 1.0: 2.33}, 0.01, point_flux, unit="kW/m2")
    yield from table("N-2", "solid-flame flux at {} m (cross-check)", {0.5: 11.18, 0.75: 6.90, 1.0: 4.69}, 0.01, burner_flux, unit="kW/m2")
    yield Case("N-4", "Heskestad plume at 6 m", 133.78, 0.01, plume, "C")
    yield Case("N-5", "McCaffrey plume at 6 m (cross-check)", 153.21, 0.01, lambda: correlations.mccaffrey(1245.0, 6.0, 22.0), "C")
    yield from table("N-7", "depth of the smoke layer after {} s", {10: 0.35, 20: 0.65, 30: 0.93}, 0.02, lambda t: filling()[t], unit="m")
    yamana = {10: 0.276, 20: 0.526, 30: 0.753}  # published with two digits: .28, .53, .75

    def depth(seconds: float) -> float:
        return ROOM[2] - correlations.yamana_tanaka(410.0, ROOM, GYPSUM, 22.0, seconds)

    yield from table("N-8", "Yamana and Tanaka's layer after {} s (cross-check)", yamana, 0.01, depth, unit="m")
    yield Case("N-9", "dose of heat at 100 C", 0.00068, 0.01, lambda: float(tenability.dose_rate(number(100.0), number(0.0))), "1/s")
    yield from table("N-10", "time to 1055 kW of a {0[0]} t2 fire", T_SQUARED, 0.01, lambda key: time_to_megawatt(key[1]), unit="s")


def of_data() -> Iterator[Case]:
    """Tables of ignition, tenability and heat release; and the hazard in a hall."""
    yield from table("3.1", "thick ignition {0[0]} at {0[4]} kW/m2", THICK, 0.03, lambda c: ignition_time(*c[1:]), unit="s")
    yield Case("3.1", "thin ignition: curtain at 20 kW/m2", 6.4, 0.02, lambda: ignition_time(0.0, 348.0, 10.0, 20.0, sheet=0.39), "s")
    yield Case("3.1", "acrylic carpet 2 % below its critical flux", math.inf, 0, lambda: ignition_time(*CARPET_ACRYLIC, 9.8), "s")
    yield from table("3.1", "ignition radius of (kW, kW/m2) {}", RADII, 0.015, radius, unit="m")
    yield from table("3.1", "unbearable in air of {} C", FED_MINUTES, 0.02, lambda t: 1 / 60 / dose(t, 0.0), unit="min")
    yield from table("3.1", "unbearable under {} kW/m2", FED_SECONDS, 0.02, lambda q: 1 / dose(0.0, q), unit="s")
    names = list(fuels.CURVES)
    rows = {(names.index(n), t): q for (n, t), q in PEAKS.items()}
    yield from table(
        "3.1", "peak of the curve (row, s) {}", rows, 1e-4, lambda c: float(burning.measured(torch.tensor([c[0]]), number(c[1]))), unit="kW"
    )
    yield Case("3.1", "energy of a polyester pillow", 4400.0, 0.005, lambda: released("throw_pillow"), "kJ")
    yield Case("3.1", "energy of 1 kg of paper", 13000.0, 0.005, lambda: released("book"), "kJ")
    yield Case("4.3", "speed of a fire's edge over a wooden floor", 3.9e-3, 0.1, front, "m/s", slow=True)
    yield Case("4.3", "a book 0.30 m from a waste basket burns", 1.0, 0, lambda: float(neighbour(0.30) < 600), slow=True)
    yield Case("4.3", "a book 0.60 m from it never does", math.inf, 0, lambda: neighbour(0.60), slow=True)


def cases() -> Iterator[Case]:
    """All of them."""
    yield from of_guide()
    yield from of_data()
