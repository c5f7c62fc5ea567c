"""Cases of `realistic` water: L-12, L-26 to L-29 and L-31 to L-35 of docs/physics.md 2.2, solved without friction.

Those of hazard_ms.validation.flume_cases follow them.
"""

from __future__ import annotations

from collections.abc import Iterator

from hazard_ms.hazards.case import Case, table
from hazard_ms.validation import flume_cases
from hazard_ms.validation.experiments import basin

SEEN = 1e-3  # least depth whose front is followed in long frames [m]
RITTER, STOKER = (0.5, 0.0), (0.5, 0.05)  # depths behind the dam and before it, as in Ritter's and Stoker's cases [m]


def cases() -> Iterator[Case]:
    """All cases of this module and of flume_cases."""
    # (1 - cos a) / 2 with a - sin a cos a = pi s
    logs = {0.2: 0.25407, 0.5: 0.5, 0.9: 0.84352}
    yield from table("L-12", "draught of a floating log, relative density {}", logs, 1e-3, basin.lying)
    yield Case("L-33", "water at rest over plinths", 0.0, 1e-6, basin.at_rest, "m/s", absolute=True)
    at_dam = "dam break, dry: {} at the dam"
    yield Case("L-29", at_dam.format("depth"), 0.2222, 0.05, lambda: basin.dam_break(*RITTER)[0], "m")
    yield Case("L-29", at_dam.format("discharge"), 0.3281, 0.05, lambda: basin.dam_break(*RITTER)[1], "m^2/s")
    # 2 c - 3 sqrt(g h) of Ritter's solution, c = sqrt(g 0.5 m); the last depth is that below which water does not flow
    fronts = {0.1: 1.4580, 0.05: 2.3282, 0.01: 3.4897, 0.001: 4.1323, 0.00001: 4.3997}
    yield from table(
        "L-29", "dam break, dry: speed of {} m", fronts, 0.10, lambda h: basin.front(*RITTER, h), unit="m/s"
    )
    seen = {depth: speed for depth, speed in fronts.items() if depth >= SEEN}
    yield from table(
        "L-29",
        "dam break, dry, frames of 1/30 s: speed of {} m",
        seen,
        0.10,
        lambda h: basin.front(*RITTER, h, dt=1 / 30),
        unit="m/s",
    )
    yield Case("L-35", "dam break, dry: error of cells of 0.1 over 0.05 m", 2.0, 0.25, basin.refined, slow=True)
    yield Case("L-31", "dam break, wet: depth behind the bore", 0.1981, 0.05, lambda: basin.dam_break(*STOKER)[2], "m")
    yield Case(
        "L-31",
        "dam break, wet: speed of the water behind the bore",
        1.641,
        0.05,
        lambda: basin.dam_break(*STOKER)[3],
        "m/s",
    )
    yield Case("L-31", "dam break, wet: speed of the bore", 2.196, 0.05, lambda: basin.front(*STOKER, 0.124), "m/s")
    yield Case(
        "L-32", "bowl: share of the swing left after three periods", 1.0, 0.10, lambda: basin.bowl()[0], slow=True
    )
    yield Case(
        "L-32", "bowl: angle after three periods", 0.0, 20.0, lambda: basin.bowl()[1], "deg", absolute=True, slow=True
    )
    yield Case(
        "L-34",
        "change of mass in 50 s, flow through a door",
        0.0,
        1e-6,
        lambda: basin.filled(1.0, 50.0)[1],
        absolute=True,
        slow=True,
    )
    yield Case("L-26", "two rooms joined under water: time until level", 8.095, 0.01, lambda: basin.levelled()[0], "s")
    yield Case(
        "L-26", "two rooms joined under water: change of mass", 0.0, 1e-6, lambda: basin.levelled()[1], absolute=True
    )
    # 0.611 a sqrt(2 g Z) / A, and Z (1 - (1 - t / 580.6 s)^2)
    yield Case("L-27", "gap under a door: rise", 1.7223e-3, 0.02, lambda: basin.gap_under_door(5.0) / 5.0, "m/s")
    gap = {60: 0.09800, 300: 0.38321}
    yield from table("L-27", "gap under a door: depth after {} s", gap, 0.05, basin.gap_under_door, unit="m")
    yield Case("L-28", "open door, 0.5 m of water outside", 0.5638, 1e-3, lambda: basin.inflow(0.5), "m^3/s")
    yield from flume_cases.cases()
