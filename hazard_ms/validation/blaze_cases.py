"""Cases of the realistic fire: N of docs/physics.md 2.4, the tables of 3.1, and the hazard in a hall."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator

from hazard_ms.hazards.case import Case, table
from hazard_ms.hazards.fire.realistic import fuels, tenability
from hazard_ms.validation import correlations
from hazard_ms.validation.experiments import smoke_room
from hazard_ms.validation.experiments.blaze import (
    burner_flux,
    cell_ignition,
    dose,
    floor_megawatt,
    ignition_time,
    neighbour,
    number,
    peak,
    plume,
    point_flux,
    radius,
    released,
    time_to_megawatt,
)

PANEL = 0.00012 * 737 * 1.42  # k rho c of the walls of N-8 [kW^2 s/m^4 K^2]
BOARD = (0.17e-3, 960.0, 1.1, 0.016)  # gypsum board: conductivity, density, heat capacity, thickness
POWERS = (100.0, 300.0, 1000.0)  # [kW]
# Times and powers at which a closed room still has the oxygen that Beyler's formula takes for granted [s]
CLOSED = {100.0: (30.0, 60.0, 120.0, 225.0, 600.0), 300.0: (30.0, 60.0, 120.0, 225.0), 1000.0: (30.0,)}
T_SQUARED = {
    ("slow", fuels.SLOW): 600.0,
    ("medium", fuels.MEDIUM): 300.0,
    ("fast", fuels.FAST): 150.0,
    ("ultrafast", fuels.ULTRAFAST): 75.0,
}
# k rho c, ignition, critical flux [docs/physics.md 3.1]
CARPET_ACRYLIC, CARPET_NYLON = (0.42, 300.0, 10.0), (0.68, 412.0, 18.0)
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
CELLS = {  # floor and flux: seconds to ignition, as in THICK
    **{("carpet", 20.0): 64.7, ("carpet", 30.0): 28.7, ("carpet", 9.8): math.inf},
    **{("wood", 20.0): 145.0, ("wood", 30.0): 65.0, ("wood", 15.7): math.inf, ("tile", 60.0): math.inf},
}
# Floors that burn as t^2 fires do [s]: NFPA 204's times to 1,055 kW; fires over wood grow medium, over carpet fast
GROWTH = {"grass": 600.0, "wood": 300.0, "carpet": 150.0}
PEAKS = {"sofa": 3447.0, "armchair": 2099.6, "cabinet": 4500.0}  # [kW] CFAST's fire library


def of_guide() -> Iterator[Case]:
    """Cases from NIST's guide."""
    yield from table(
        "N-1", "point-source flux at {} m", {0.5: 6.01, 0.75: 3.65, 1.0: 2.33}, 0.01, point_flux, unit="kW/m2"
    )
    yield from table(
        "N-2",
        "solid-flame flux at {} m (cross-check)",
        {0.5: 11.18, 0.75: 6.90, 1.0: 4.69},
        0.01,
        burner_flux,
        unit="kW/m2",
    )
    yield Case("N-4", "Heskestad plume at 6 m", 133.78, 0.01, plume, "C")
    yield Case("N-5", "McCaffrey plume at 6 m", 153.21, 0.15, plume, "C")
    yield from table(
        "N-7",
        "depth of the smoke layer after {} s",
        {10: 0.35, 20: 0.65, 30: 0.93},
        0.02,
        smoke_room.filling,
        unit="m",
    )
    yield from table(
        "N-8",
        "depth of the smoke layer under panels after {} s (Yamana and Tanaka)",
        {10: 0.28, 20: 0.53, 30: 0.75},
        0.15,
        lambda t: smoke_room.filling(t, smoke_room.PANEL, 0.35),
        unit="m",
    )
    yield Case(
        "N-9",
        "dose of heat at 100 C",
        0.00068,
        0.01,
        lambda: float(tenability.dose_rate(number(100.0), number(0.0))),
        "1/s",
    )
    yield from table(
        "N-10", "time to 1055 kW, {0[0]} t2 fire", T_SQUARED, 0.01, lambda key: time_to_megawatt(key[1]), unit="s"
    )


def of_rooms() -> Iterator[Case]:
    """Layers in a room of 6.8 x 6.4 x 2.6 m against correlations of other authors, which no hazard knows."""
    size, door = smoke_room.DWELLING, smoke_room.DOOR
    for power in POWERS:
        rises = {(power, t): correlations.mqh(power, size, (door[0], door[2]), BOARD, t) for t in smoke_room.TIMES[:-1]}
        yield from table(
            "4.3", "MQH, door open, (kW, s) {}", rises, 0.15, smoke_room.open_room, unit="K", slow=power < 300
        )
        # from 398 s on MQH takes the board as one that heat passes: a jump of 26 %
        late = {(power, 600.0): correlations.mqh(power, size, (door[0], door[2]), BOARD, 600.0)}
        yield from table("4.3", "MQH, door open, (kW, s) {}", late, 0.2, smoke_room.open_room, unit="K", slow=True)
        rises = {(power, t): correlations.beyler(power, size, PANEL, t) for t in CLOSED[power]}
        yield from table(
            "4.3", "Beyler, closed, (kW, s) {}", rises, 0.15, smoke_room.closed_room, unit="K", slow=power < 300
        )


def of_data() -> Iterator[Case]:
    """Cases from tables of ignition, tenability and heat release, and of the hazard in a hall."""
    yield from table(
        "3.1", "thick ignition {0[0]} at {0[4]} kW/m2", THICK, 0.03, lambda c: ignition_time(*c[1:]), unit="s"
    )
    yield Case(
        "3.1",
        "thin ignition: curtain at 20 kW/m2",
        6.4,
        0.02,
        lambda: ignition_time(0.0, 348.0, 10.0, 20.0, sheet=0.39),
        "s",
    )
    yield Case(
        "3.1",
        "acrylic carpet 2 % below its critical flux",
        math.inf,
        0,
        lambda: ignition_time(*CARPET_ACRYLIC, 9.8),
        "s",
    )
    yield from table("3.1", "ignition radius of (kW, kW/m2) {}", RADII, 0.015, radius, unit="m")
    yield from table(
        "3.1", "time until air of {} C incapacitates", FED_MINUTES, 0.02, lambda t: 1 / 60 / dose(t, 0.0), unit="min"
    )
    yield from table(
        "3.1", "time until radiation of {} kW/m2 incapacitates", FED_SECONDS, 0.02, lambda q: 1 / dose(0.0, q), unit="s"
    )
    yield from table("3.1", "largest heat release of a burning {}", PEAKS, 0.01, peak, unit="kW")
    yield Case("3.1", "energy of a polyester pillow", 4400.0, 0.005, lambda: released("throw_pillow"), "kJ")
    yield Case("3.1", "energy of 1 kg of paper", 13000.0, 0.005, lambda: released("book"), "kJ")
    yield from table("4.3", "a cell of (floor, kW/m2) {} burns after", CELLS, 0.03, cell_ignition, unit="s")
    for floor, seconds in GROWTH.items():
        run = functools.partial(floor_megawatt, floor, 1.5 * seconds)
        yield Case("4.3", f"1055 kW from a floor of {floor}", seconds, 0.2, run, "s", slow=True)
    yield Case(
        "4.3", "a book 0.30 m from a waste basket burns", 1.0, 0, lambda: float(neighbour(0.30) < 600), slow=True
    )
    yield Case("4.3", "a book 0.60 m from a waste basket never burns", math.inf, 0, lambda: neighbour(0.60), slow=True)


def cases() -> Iterator[Case]:
    """All cases of this module."""
    yield from of_guide()
    yield from of_rooms()
    yield from of_data()
