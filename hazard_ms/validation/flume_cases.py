"""Cases of `realistic` water against publications: L-36 to L-66 of docs/physics.md 2.2.

L-36 to L-39 are of the laws of friction and inflow. The numbers of L-41 to L-52 were written down before the first run,
and nothing is tuned to them. One such case misses: docs/physics.md 2.2 says by how much.
"""

from __future__ import annotations

from collections.abc import Iterator

from hazard_ms.hazards.case import Case, table
from hazard_ms.validation.experiments import channel, flume

FLOWS = {(0.01, 0.01): 0.3868, (0.1, 0.005): 1.2695, (1.0, 0.002): 3.7268}  # h^(2/3) sqrt(S) / n


def of_laws() -> Iterator[Case]:
    """Friction of the floor, and flow through doors."""
    # u0 / (1 + g n^2 u0 t / h^(4/3))
    yield Case("L-36", "1 m/s over a level floor, 0.1 m deep: after 5 s", 0.8679, 0.01, channel.slowed, "m/s")
    yield from table("L-37", "uniform flow of (m, slope) {}", FLOWS, 0.03, channel.uniform, unit="m/s", slow=True)
    inflow = {0.3: 0.2620, 0.5: 0.5638, 1.0: 1.5946}  # 0.4 b sqrt(2 g) H^1.5
    yield from table("L-38", "open door, {} m outside, steady", inflow, 0.05, flume.steady, unit="m^3/s")
    drowned = {0.5: 0.8454, 0.8: 0.6163}  # Villemonte: (1 - (h / H)^1.5)^0.385
    yield from table(
        "L-39", "open door, water inside {} as high: share of the free discharge", drowned, 0.10, flume.submerged
    )


def of_channels() -> Iterator[Case]:
    """Exact solutions in channels and dishes."""
    yield Case("L-41", "Stoker's bore off a wall: depth", 0.4752, 0.05, lambda: channel.reflected()[0], "m")
    yield Case("L-41", "Stoker's bore off a wall: speed", 1.1733, 0.05, lambda: channel.reflected()[1], "m/s")
    yield Case("L-42", "surge from a closed gate: depth", 0.4952, 0.03, lambda: channel.surge()[0], "m")
    yield Case("L-42", "surge from a closed gate: speed", 1.5372, 0.03, lambda: channel.surge()[1], "m/s")
    yield Case("L-43", "water in a parabola: period", 10.030, 0.03, lambda: channel.parabola()[0], "s")
    yield Case(
        "L-43",
        "water in a parabola: share of the swing left after two periods",
        1.0,
        0.15,
        lambda: channel.parabola()[1],
    )
    heights = {0.5: 0.48, 1.0: 0.75}  # deep sqrt(1 - A^2) / (1 - A cos wt)
    yield from table("L-44", "round dish, {} periods: depth in its middle", heights, 0.10, channel.dish, unit="m")
    # 2.831 sqrt(cot b) H^(5/4) [Synolakis 1987]
    yield Case("L-45", "solitary wave on a beach: run-up", 0.08606, 0.15, channel.run_up, "m", slow=True)
    # 5/3 of the speed of the water
    yield Case("L-46", "flood wave down a slope of 0.2 %", 0.8430, 0.03, channel.flood_wave, "m/s", slow=True)


def of_steady_flows() -> Iterator[Case]:
    """Steady flows over bumps and long slopes."""
    crest = int(10.0 / 0.1)
    yield Case(
        "L-47",
        "bump, 4.42 m2/s: depth on it",
        1.7073,
        0.02,
        lambda: float(channel.over_bump(4.42, 2.0)[0][crest - 1 : crest + 1].mean()),
        "m",
        slow=True,
    )
    yield Case("L-48", "bump, 0.18 m2/s: place of the jump", 11.666, 0.2, channel.jump_behind_bump, "m", True, True)
    depths = {10.0: 0.6203, 20.0: 0.4058}
    yield from table(
        "L-49",
        "bump, 1.53 m2/s: depth at {} m",
        depths,
        0.05,
        lambda x: float(channel.over_bump(1.53, 0.40578)[0][round(x / 0.1)]),
        unit="m",
        slow=True,
    )
    depths = {30.05: 0.9377, 50.05: 1.1123}
    yield from table(
        "L-50",
        "backwater of MacDonald: depth at {} m",
        depths,
        0.02,
        lambda x: channel.backwater((x,))[0],
        unit="m",
        slow=True,
    )
    yield Case("L-51", "doorway between rooms, 0.5 m before it", 0.5638, 0.10, flume.doorway, "m^3/s")
    yield Case("L-52", "diagonal seiche of a room", 3.6414, 0.02, channel.swashing, "s")


def of_doors() -> Iterator[Case]:
    """Closed doors between rooms: O of docs/physics.md 2.6."""
    # 0.611 a sqrt(2 g H), a = 0.9 x 0.02 m
    yield Case("O-1", "leakage of a closed door under 0.5 m of water", 0.03445, 0.08, flume.under_door, "m^3/s")
    yield Case("O-2", "depth of water that breaks a closed door", 0.8, 0.2, flume.breaking_depth, "m", absolute=True)


def of_what_stands_in_it() -> Iterator[Case]:
    """Robots and people that fall over, furniture that floats off and dams doors."""
    speeds = {0.5: 1.662, 0.8: 0.935}  # sqrt(2 b (m - rho w^2 d) g / (rho Cd w)) / d
    yield from table("L-60", "G1 in water {} m deep topples at", speeds, 0.01, flume.topples_at, unit="m/s")
    yield Case("L-61", "Fetch floats and keels over at", 0.4421, 0.005, lambda: flume.keels_over(flume.FETCH), "m")

    def product(depth: float) -> float:
        return depth * flume.topples_at(depth, flume.PERSON)

    people = dict.fromkeys((0.5, 0.7, 0.9, 1.1), 1.41)  # 0.70 to 2.12 m2/s [Abt et al. 1989]
    yield from table("L-62", "a person in {} m: depth x speed", people, 0.71, product, unit="m2/s", absolute=True)
    depths = {"fridge_1": 0.2062, "cabinet_8": 0.5850}  # 0.12 of 1.719 m, 0.65 of 0.9 m
    yield from table("L-63", "{} leaves the floor at", depths, 0.01, flume.floats_at, unit="m")
    rates = {0.4: 0.9567, 0.8: 0.3189}  # (1 - share) 0.4 b sqrt(2 g) H^1.5
    yield from table("L-66", "door, 1 m outside, {} of it dammed", rates, 0.05, flume.dammed, unit="m^3/s")


def cases() -> Iterator[Case]:
    """All cases of this module."""
    yield from of_what_stands_in_it()
    yield from of_laws()
    yield from of_channels()
    yield from of_steady_flows()
    yield from of_doors()
