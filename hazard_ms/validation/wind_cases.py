"""Cases of wind: W of docs/physics.md 2.3, all but W-23: no hazard has a power law for its profile."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from hazard_ms.hazards.case import Case, table
from hazard_ms.hazards.wind.wind import Wind
from hazard_ms.validation.experiments.wind import (
    LAW,
    SHIPPED,
    W1,
    W9,
    at_height,
    by_frame,
    carried,
    force,
    gust_factor,
    gusty,
    in_cart,
    in_street,
    on_the_ground,
    resisting,
    slides,
    sliding,
    slip_lost,
    three_seconds,
    threshold,
    topples,
    turbulence,
    twist,
    wandering,
)
from hazard_ms.validation.experiments.yard import STILL

AERODYNAMIC = Wind(gain=0.5 * 1.05, scale=1.0, **STILL)
W2 = {1: 0.82185, 2: 1.34495, 5: 2.17595, 10: 2.74033}
W4 = {(0.06, 1): 1.006, (0.06, 2): 1.540, (0.06, 3): 1.883, (0.06, 5): 2.308, (0.06, 10): 2.807}
W4 |= {(0.2, 1): 3.354, (0.2, 2): 3.383, (0.2, 3): 3.408, (0.2, 5): 3.447, (0.2, 10): 3.509}
W5 = {1: 2.705, 2: 3.125, 3: 3.296, 4: 3.388, 5: 3.447}
W7, W7_SLOW = {5: 0.526}, {10: 5.526, 15: 10.526, 20: 15.526}
RHO_A = 1.225 * 0.06  # [kg/m]
W15 = 0.05 * RHO_A * 3.7**2 * 10.0 / 5000.0  # 0.05 J sqrt(N) / m after N = 100 frames of the original [m/s]
W21 = {(5.0, 0.1): 1.25, (5.0, 0.15): 1.39, (5.0, 0.2): 1.51, (5.0, 0.3): 1.76, (2.0, 0.2): 1.47, (10.0, 0.2): 1.50}
W22 = {(0.005, z): u for z, u in zip((0.1, 0.3, 0.5, 1.0, 2.0), (0.394, 0.539, 0.606, 0.697, 0.788), strict=True)}
W22 |= {(0.03, z): u for z, u in zip((0.1, 0.3, 0.5, 1.0, 2.0), (0.207, 0.396, 0.484, 0.604, 0.723), strict=True)}
W22 |= {(0.1, z): u for z, u in zip((0.3, 0.5, 1.0, 2.0), (0.239, 0.349, 0.500, 0.651), strict=True)}
# u(1 m) ln((z + 0.003) / 0.001) / ln(1.003 / 0.001) below 1 m, ln(z / 0.03) / ln(10 / 0.03) above
W25 = {0.0: 0.09596, 0.01: 0.22404, 0.1: 0.40483, 0.3: 0.49907, 1.0: 0.60363, 2.0: 0.72295}
BOXES = {"phone": (0.15, 0.075, 0.01), "banknote": (0.12, 0.06, 0.0005), "carton": (0.3, 0.3, 0.3)}  # edges [m]
# By numerical quadrature of 0.5 x 1.225 x 1.05 x width x u(z)^2 over the height, in 200,000 steps [N]
W26 = {("phone", 17.0): 0.0044464, ("phone", 28.0): 0.012062, ("phone", 40.0): 0.024617}
W26 |= {("banknote", 17.0): 5.9083e-05, ("banknote", 28.0): 1.6028e-04, ("banknote", 40.0): 3.2711e-04}
W26 |= {("carton", 17.0): 2.9916, ("carton", 28.0): 8.1157, ("carton", 40.0): 16.563}


def of_motion() -> Iterator[Case]:
    """Cases of things that move in the wind."""
    yield from table(
        "W-1",
        "speed of a free body after {} s",
        {t: v for t, (v, _) in W1.items()},
        0.01,
        lambda t: carried(LAW)[t][0],
        unit="m/s",
    )
    yield from table(
        "W-1",
        "distance of a free body after {} s",
        {t: x for t, (_, x) in W1.items()},
        0.01,
        lambda t: carried(LAW)[t][1],
        unit="m",
    )
    yield from table(
        "W-2",
        "speed of a free body with Cd / 2 after {} s",
        W2,
        0.01,
        lambda t: carried(AERODYNAMIC)[t][0],
        unit="m/s",
        slow=True,
    )
    yield from table(
        "W-4",
        "speed in the original's frames, (m2, frame) {}",
        W4,
        1e-3,
        lambda k: by_frame(SHIPPED, k[0])[k[1]],
        unit="m/s",
    )
    implicit = dataclasses.replace(SHIPPED, implicit=True)
    yield from table(
        "W-5",
        "implicit step, 0.6 m2, frame {}",
        W5,
        6e-4,
        lambda n: by_frame(implicit, 0.6)[n],
        unit="m/s",
        absolute=True,
    )
    starts = {0.9: 0.0, 0.98: 0.0, 1.02: 1.0, 1.1: 1.0}
    yield from table("W-6", "moves at {} of the threshold", starts, 0, lambda s: threshold()[s])
    yield from table("W-7", "terminal speed on the ground in {} m/s", W7, 0.02, sliding, unit="m/s")
    yield from table("W-7", "terminal speed on the ground in {} m/s", W7_SLOW, 0.02, sliding, unit="m/s", slow=True)
    ground = {(a, r): v for a, row in W9.items() for r, v in enumerate(row)}
    more = {k: v for k, v in ground.items() if v}
    yield from table(
        "W-9",
        "the original's terminal speed, (m2, resistance) {}",
        more,
        0.05,
        lambda k: on_the_ground()[k],
        unit="m/s",
    )
    rest = {k: v for k, v in ground.items() if not v}
    yield from table(
        "W-9", "does not move (m2, resistance) {}", rest, 2e-3, lambda k: on_the_ground()[k], unit="m/s", absolute=True
    )


def of_laws() -> Iterator[Case]:
    """Cases of scaling, turbulence, gusts, profile and thresholds."""
    yield Case("W-10", "twice the wind: force times", 4.0, 1e-5, lambda: force(LAW, (7.4, 0.0)) / force(LAW))
    yield Case(
        "W-10",
        "no force at the wind's speed",
        0.0,
        1e-6,
        lambda: force(LAW, velocity=(3.7, 0.0, 0.0)),
        "N",
        absolute=True,
    )
    yield Case(
        "W-10",
        "moving across changes the force by",
        1.0,
        1e-6,
        lambda: force(LAW, velocity=(0.0, 2.0, 0.0)) / force(LAW),
    )
    yield from table(
        "W-11", "share of the force at resistance {}", {1.0: 1 / 4, 2.0: 1 / 9, 3.0: 1 / 16, 11.0: 0.0}, 1e-5, resisting
    )
    yield Case(
        "W-12",
        "turbulence: standard deviation across the wind",
        0.05,
        0.01,
        lambda: float(turbulence("shipped")[:, 1].std()),
    )
    yield Case(
        "W-12", "turbulence: mean magnitude", 0.06267, 0.01, lambda: float(turbulence("shipped").norm(dim=1).mean())
    )
    yield Case("W-12", "turbulence along the wind", 0.0, 0, lambda: float(turbulence("shipped")[:, 0].abs().max()))
    yield Case(
        "W-13",
        "turbulence of fixed length: mean magnitude",
        0.06802,
        0.01,
        lambda: float(turbulence("paper").norm(dim=1).mean()),
    )
    yield Case(
        "W-13",
        "turbulence of fixed length: largest magnitude",
        0.0866,
        1e-3,
        lambda: float(turbulence("paper").norm(dim=1).max()),
    )
    yield Case(
        "W-14",
        "torque over force: standard deviation across the wind",
        0.05 * 0.2,
        0.01,
        lambda: float(twist()[:, 1:].std()),
        "m",
    )
    yield Case("W-14", "torque along the wind", 0.0, 0, lambda: float(twist()[:, 0].abs().max()), "m")
    yield from table(
        "W-15",
        "standard deviation of sideways speed, {} frames a second",
        {100: W15, 25: W15},
        0.02,
        wandering,
        unit="m/s",
        slow=True,
    )
    yield from table(
        "W-16", "force on what has come to rest in a cart, layer {}", {0: 0.0, 1: 0.0}, 0, in_cart, unit="N"
    )
    lost = RHO_A * 3.7 * 1.0 / 1e-4
    yield Case(
        "W-17", "share of its slip that a feather loses in a step", lost / (1 + lost), 1e-5, lambda: slip_lost(LAW)
    )
    yield Case(
        "W-17", "share of its slip that a feather loses in the original's step", 1.0, 1e-6, lambda: slip_lost(SHIPPED)
    )
    yield Case(
        "W-20",
        "variance of 3-s means over U^2",
        0.2**2 * 0.8267,
        0.05,
        lambda: float(three_seconds(gusty(5.0, 0.2)).var()),
        slow=True,
    )
    yield from table("W-21", "gust factor (s, intensity) {}", W21, 0.03, gust_factor, absolute=True, slow=True)
    yield from table("W-22", "profile u / u10 (z0, z) {}", W22, 1e-3, lambda k: at_height(*k), absolute=True)
    yield from table(
        "W-25", "u / u10 over a pavement, z {}", W25, 1e-3, lambda z: at_height(0.03, z, 0.001), absolute=True
    )
    yield from table(
        "W-26", "force of the profile (box, u10) {}", W26, 0.01, lambda k: in_street(BOXES[k[0]], k[1]), unit="N"
    )
    yield from table("W-24", "cardboard slides at {} of its threshold", {0.95: 0.0, 1.05: 1.0}, 0, slides, slow=True)
    yield from table("W-24", "a carton topples at {} of its threshold", {0.97: 0.0, 1.03: 1.0}, 0, topples, slow=True)


def cases() -> Iterator[Case]:
    """All cases of this module."""
    yield from of_motion()
    yield from of_laws()
