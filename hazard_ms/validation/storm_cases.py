"""Cases of wind against publications that no constant was chosen by: W-30 and on of docs/physics.md 2.3."""

from __future__ import annotations

from collections.abc import Iterator

from hazard_ms.hazards.case import Case, table
from hazard_ms.validation.experiments import storm

W30 = {10.0: 0.172, 5.0: 0.1955, 2.0: 0.238, 1.0: 0.285}  # 1 / ln(z / 0.03 m) [EN 1991-1-4, 4.4]
W31 = {5.0: 0.1869, 2.0: 0.2276}  # 2.39 x 0.4 / ln(z / 0.03 m) [Panofsky & Dutton 1984]
W33 = {2: 0.2, 5: 0.35, 10: 0.65, 20: 0.85}  # [Heisler & DeWalle 1988]
W34 = {5: 0.25, 10: 0.70, 15: 0.90, 20: 0.95}  # [Brandle & Finch 1991]
# [Brandle & Finch 1991, density 60 to 80 %]; 0.35 at 10 H and 0.65 at 15 H are missed, see docs/physics.md 2.3
W34_HEDGE = {5: 0.25, 20: 0.85}
# 1 - (L / x)^1.5, L the length of the cavity of Hosker 1979, 1.75 W / (1 + 0.25 W / H) [Roeckle 1990]
W35 = {2: 0.4143, 4: 0.7929, 8: 0.9268}  # L = 1.4 H
W36 = {8: 0.7106, 12: 0.8425}  # L = 3.5 H; 0.4143 at 5 H is missed, see docs/physics.md 2.3
# 1 - exp(-sqrt(1.822 K x*)) [Lin, Holmes & Letchford 2007]
W37 = {0.25: 0.491, 0.5: 0.615, 1.0: 0.741, 2.0: 0.852}
# 0.456 k^2 - 0.148 k^3 + 0.024 k^4 - 0.0014 k^5, k = K t* [Lin, Letchford & Holmes 2006]
W39 = {1: 0.3306, 2: 0.9792, 3: 1.7118}
W38 = {"fetch": 34.9, "g1": 16.6}  # sqrt(m g b / (rho Cd A h)): 115 and 35 kg, b 0.51 and 0.2 m, h 0.55 and 0.656 m


def cases() -> Iterator[Case]:
    """All cases of this module."""
    yield from table("W-30", "intensity of turbulence at {} m", W30, 0.1, storm.intensity)
    yield from table("W-31", "intensity of turbulence at {} m, measured", W31, 0.1, storm.intensity)
    yield from table("W-38", "wind speed at 1 m that topples {}", W38, 0.03, storm.topples_at, unit="m/s")
    yield from table(
        "W-37", "speed of plates over the wind's at distance K x* = {}", W37, 0.15, storm.speed_after, slow=True
    )
    yield from table("W-39", "distance K x* of plates at time K t* = {}", W39, 0.15, storm.distance_after, slow=True)
    # off-land winds [Harper, Kepert & Ginger 2010, WMO/TD-No. 1555]
    yield Case("W-32", "3-s gust over the 600-s mean, open country", 1.52, 0.1, storm.gust_factor, slow=True)
    yield from table(
        "W-33", "wind speed over that upstream, {} H behind a solid wall", W33, 0.15, storm.behind_wall, absolute=True
    )
    yield from table(
        "W-34",
        "wind speed over that upstream, {} H behind a solid wall (second source)",
        W34,
        0.15,
        storm.behind_wall,
        absolute=True,
    )
    hedge = "wind speed over that upstream, {} H behind a hedge"
    yield from table("W-34", hedge, W34_HEDGE, 0.15, storm.behind_hedge, absolute=True)
    yield from table(
        "W-35", "wind speed over that upstream, {} H behind a cube", W35, 0.15, storm.behind_cube, absolute=True
    )
    yield from table(
        "W-36", "wind speed over that upstream, {} H behind a wide block", W36, 0.15, storm.behind_house, absolute=True
    )
