"""The regions of the wind task as data: ground, and rules that say where houses, plants and street furniture belong.

Everything is written for a square of REGION_SIZE metres seen from the south: roads run along x, houses are north.
A scene turns it by quarter turns. Areas are (left, lower, right, upper) in metres, yaws in degrees; furniture faces -y.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from hazard_ms.spec import Vec2
from hazard_ms.spec.severity import STRONGER_WINDS, WINDS

Area = tuple[float, float, float, float]

REGION_SIZE = 16.0  # edge of a region [m] [docs/benchmark.md 1]
BEYOND = 8.0  # how far things can be blown out of the square on every side [m] [ours]
SKY = 12.0  # height up to which things can be blown [m] [ours]


@dataclass(frozen=True)
class Ground:
    """A rectangle of ground."""

    material: str
    area: Area


@dataclass(frozen=True)
class Some:
    """Pieces anywhere in an area, each of one of the categories."""

    categories: tuple[str, ...]
    area: Area
    count: tuple[int, int] = (1, 1)
    yaws: tuple[float, ...] = (0.0, 90.0, 180.0, 270.0)
    sway: float = 5.0  # [degrees]


@dataclass(frozen=True)
class Line:
    """Pieces of one category from `start` towards `end`, side by side or one `every` few metres.

    An entrance, `open` metres wide, is left out somewhere.
    """

    categories: tuple[str, ...]  # one is drawn for the whole line
    start: Vec2
    end: Vec2
    yaw: float
    every: float = 0.0  # from middle to middle [m]; 0: side by side
    open: float = 0.0  # width of an entrance [m]
    share: float = 1.0  # of the places that are taken


@dataclass(frozen=True)
class Fronts:
    """Houses side by side with their fronts on a line, which may lie outside of the square."""

    start: Vec2
    end: Vec2
    yaw: float  # where they face: 0 is -y
    between: tuple[float, float] = (0.6, 1.8)  # [m]


Rule = Some | Line | Fronts


@dataclass(frozen=True)
class Region:
    """A kind of outdoor place. Scenes of it differ by what the seed draws: turn, models, places, things, wind."""

    name: str  # "street"
    base: str  # material of the ground
    grounds: tuple[Ground, ...]
    rules: tuple[Rule, ...]
    aisle: float = 0.9  # width of the passages [m]
    targets: int = 15  # number of things that can blow away [docs/benchmark.md 1]
    wind: tuple[float, float] = WINDS  # slowest and fastest [m/s]
    parked: bool = False  # whether the carts stand side by side at the edge, as in a bay, or anywhere


def dashes(
    first: float, step: float, long: float, wide: float, along_x: bool, at: float, count: int
) -> tuple[Ground, ...]:
    """White lines on a road, one behind the other: from `first`, every `step` [m]."""
    made = []
    for k in range(count):
        low, high = first + k * step, first + k * step + long
        side = (at - wide / 2, at + wide / 2)
        made.append(Ground("line_white", (low, side[0], high, side[1]) if along_x else (side[0], low, side[1], high)))
    return tuple(made)


def _crossing_for_walkers(at: float, low: float, along_x: bool) -> tuple[Ground, ...]:
    """Six bars across a road of 4.8 m that begins at `low`."""
    bars = []
    for k in range(6):
        a = low + 0.2 + 0.8 * k
        bars.append(Ground("line_white", (at, a, at + 1.4, a + 0.4) if along_x else (a, at, a + 0.4, at + 1.4)))
    return tuple(bars)


SMALL = ("hydrant", "mailbox", "trash_bin", "traffic_sign", "bollard", "planter")

STREET = Region(
    "street",
    "grass",
    (
        Ground("asphalt", (-60.0, -1.0, 76.0, 4.6)),
        Ground("pavement", (-60.0, 4.6, 76.0, 6.2)),
        Ground("pavement", (-60.0, -2.6, 76.0, -1.0)),
        Ground("gravel", (6.9, 6.2, 9.1, 12.2)),
        *dashes(-10.0, 3.0, 1.5, 0.14, True, 1.8, 13),
    ),
    (
        Fronts((-6.0, 12.2), (22.0, 12.2), 0.0),
        Fronts((-6.0, -3.0), (22.0, -3.0), 180.0, (1.0, 3.0)),
        Line(("fence", "hedge"), (0.3, 6.55), (6.8, 6.55), 0.0, open=1.5),
        Line(("fence", "hedge"), (9.2, 6.55), (15.7, 6.55), 0.0, open=1.5),
        Line(("hedge", "fence"), (8.0, 9.4), (8.0, 12.0), 90.0),
        Line(("street_lamp",), (3.0, 5.0), (13.5, 5.0), 0.0, every=8.0),
        Some(("car",), (2.6, 3.1, 13.4, 3.5), (1, 2), (90.0, 270.0), 2.0),
        Some(("tree",), (1.6, 7.8, 14.4, 11.2), (1, 3)),
        Some(SMALL, (0.6, 4.9, 15.4, 5.4), (2, 4), (0.0, 180.0)),
        Some(("bench", "planter", "picnic_table"), (1.0, 7.4, 15.0, 11.6), (1, 2)),
    ),
)

CROSSING = Region(
    "crossing",
    "grass",
    (
        Ground("pavement", (-60.0, 4.2, 76.0, 11.8)),
        Ground("pavement", (4.2, -60.0, 11.8, 76.0)),
        Ground("asphalt", (-60.0, 5.6, 76.0, 10.4)),
        Ground("asphalt", (5.6, -60.0, 10.4, 76.0)),
        *_crossing_for_walkers(3.9, 5.6, True),
        *_crossing_for_walkers(10.7, 5.6, True),
        *_crossing_for_walkers(3.9, 5.6, False),
        *_crossing_for_walkers(10.7, 5.6, False),
        *dashes(-9.0, 3.0, 1.5, 0.14, True, 8.0, 4),
        *dashes(13.0, 3.0, 1.5, 0.14, True, 8.0, 4),
    ),
    (
        Fronts((-7.0, 15.4), (3.4, 15.4), 0.0),
        Fronts((12.6, 15.4), (23.0, 15.4), 0.0),
        Fronts((-7.0, 0.6), (3.4, 0.6), 180.0),
        Fronts((12.6, 0.6), (23.0, 0.6), 180.0),
        Line(("hedge", "fence"), (0.3, 12.1), (3.9, 12.1), 0.0, open=1.2),
        Line(("hedge", "fence"), (12.1, 3.9), (15.7, 3.9), 180.0, open=1.2),
        Line(("fence", "hedge"), (3.9, 0.4), (3.9, 3.7), 90.0, open=1.2),
        Line(("street_lamp",), (4.6, 4.6), (11.4, 4.6), 0.0, every=6.8),
        Line(("street_lamp",), (4.6, 11.4), (11.4, 11.4), 180.0, every=6.8),
        Some(("car",), (1.6, 6.9, 3.2, 7.0), (0, 1), (270.0,), 2.0),
        Some(("car",), (13.0, 9.0, 14.4, 9.2), (0, 1), (90.0,), 2.0),
        Some(("car",), (9.1, 1.8, 9.3, 2.2), (0, 1), (180.0,), 2.0),
        Some(("tree",), (1.3, 13.0, 3.0, 14.2), (0, 1)),
        Some(("tree",), (13.0, 1.6, 14.6, 2.8), (1, 1)),
        Some(("bus_stop",), (1.4, 4.6, 2.6, 4.8), (0, 1), (180.0,), 0.0),
        Some(SMALL, (11.0, 10.9, 15.4, 11.6), (1, 2)),
        Some((*SMALL, "traffic_cone"), (0.5, 4.4, 4.9, 5.3), (1, 2)),
        Some(("bench", "planter", "kiosk", "trash_bin"), (12.3, 12.3, 15.2, 14.6), (1, 2)),
        Some(("bench", "planter", "trash_bin"), (0.8, 0.9, 3.2, 3.2), (1, 2)),
        Some(("traffic_cone", "bollard"), (6.0, 6.0, 10.0, 10.0), (0, 3)),
    ),
)

PARKING = Region(
    "parking",
    "asphalt",
    (
        Ground("grass", (-60.0, 16.0, 76.0, 76.0)),
        Ground("pavement", (-60.0, 15.6, 76.0, 18.0)),
        Ground("grass", (-60.0, -60.0, 76.0, -0.2)),
        *dashes(1.6, 2.56, 0.1, 4.6, True, 2.7, 6),
        *dashes(1.6, 2.56, 0.1, 4.6, True, 13.1, 6),
        Ground("line_white", (1.6, 0.4, 14.5, 0.5)),
        Ground("line_white", (1.6, 15.3, 14.5, 15.4)),
    ),
    (
        Fronts((-6.0, 18.2), (22.0, 18.2), 0.0, (0.2, 0.8)),
        Line(("car",), (2.93, 13.0), (14.0, 13.0), 0.0, every=2.56, share=0.5),
        Line(("car",), (2.93, 2.8), (14.0, 2.8), 180.0, every=2.56, share=0.4),
        Line(("hedge", "fence"), (0.45, 0.6), (0.45, 15.4), 90.0, open=3.0),
        Line(("fence", "hedge"), (15.55, 0.6), (15.55, 15.4), 90.0, open=3.0),
        Line(("street_lamp",), (4.0, 8.0), (12.5, 8.0), 0.0, every=8.0),
        Some(("kiosk", "shed", "bus_stop"), (2.2, 7.4, 4.2, 8.6), (0, 1), (0.0, 180.0), 2.0),
        Some(("planter", "bench", "trash_bin"), (5.5, 7.6, 10.5, 8.4), (1, 3), (0.0, 180.0)),
        Some(("traffic_cone", "bollard", "hydrant", "traffic_sign"), (1.2, 5.6, 14.8, 10.4), (2, 5)),
        Some(("planter", "tree"), (13.0, 6.6, 14.4, 9.4), (1, 1)),
    ),
)

PARK = Region(
    "park",
    "grass",
    (
        Ground("gravel", (-60.0, 6.9, 76.0, 9.1)),
        Ground("gravel", (6.9, -60.0, 9.1, 76.0)),
        Ground("pavement", (5.6, 5.6, 10.4, 10.4)),
        Ground("soil", (1.2, 12.6, 3.8, 14.8)),
    ),
    (
        Fronts((-6.0, 18.4), (22.0, 18.4), 0.0, (2.0, 5.0)),
        Line(("hedge",), (0.5, 15.5), (15.5, 15.5), 0.0, open=2.4),
        Line(("fence", "hedge"), (0.45, 0.5), (0.45, 6.6), 90.0),
        Line(("hedge", "fence"), (15.55, 9.4), (15.55, 15.0), 90.0),
        Line(("bench",), (2.2, 9.7), (6.0, 9.7), 0.0, every=3.4),
        Line(("bench",), (10.6, 6.3), (14.5, 6.3), 180.0, every=3.4),
        Line(("street_lamp",), (5.3, 5.3), (10.9, 5.3), 0.0, every=5.5),
        Some(("tree",), (1.8, 1.8, 6.0, 5.6), (1, 2)),
        Some(("tree",), (10.6, 10.6, 14.2, 14.0), (1, 2)),
        Some(("tree",), (10.8, 1.8, 14.2, 5.0), (0, 1)),
        Some(("slide", "picnic_table", "sandbox"), (2.0, 11.4, 5.6, 13.8), (1, 2)),
        Some(("picnic_table", "shed"), (11.0, 1.8, 14.4, 4.8), (1, 1)),
        Some(("trash_bin", "planter", "traffic_sign"), (5.8, 5.8, 10.2, 10.2), (1, 3)),
        Some(("hedge",), (10.2, 10.2, 14.6, 14.6), (0, 2), (0.0, 90.0)),
    ),
)

PARKING_HARD = replace(PARKING, name="parking_hard", targets=20, wind=STRONGER_WINDS["hard"])
GALE = tuple(replace(r, name=f"{r.name}_gale", parked=True) for r in (STREET, CROSSING, PARKING, PARK))
MARKET = Region(
    "market_gale",
    "pavement",
    (Ground("asphalt", (-60.0, -6.0, 76.0, -0.6)),),
    (
        Fronts((-6.0, 17.0), (22.0, 17.0), 0.0, (0.2, 0.8)),
        Line(("kiosk",), (2.5, 12.6), (13.5, 12.6), 0.0, every=5.5, share=0.8),
        Line(("hedge", "fence"), (15.5, 1.0), (15.5, 11.0), 90.0, open=2.0),
        Some(("car",), (2.6, 2.2, 13.4, 2.8), (1, 2), (90.0, 270.0), 2.0),
        Some(("bench", "picnic_table", "planter", "tree"), (3.0, 4.5, 13.0, 10.5), (2, 4)),
        Some(SMALL, (1.0, 1.0, 15.0, 15.0), (1, 3)),
    ),
)
YARD = Region(
    "yard_gale",
    "gravel",
    PARKING.grounds[:3],
    (
        *(PARKING.rules[k] for k in (0, 3, 4)),
        Line(("shed",), (3.0, 13.2), (13.0, 13.2), 0.0, every=5.0, share=0.8),
        Some(("car", "shed"), (3.0, 2.0, 13.0, 3.2), (1, 2), (90.0, 270.0), 2.0),
        Some(("planter", "trash_bin", "traffic_cone", "bollard"), (2.0, 5.0, 14.0, 11.0), (3, 6)),
    ),
)
MARKET, YARD = (replace(region, parked=True) for region in (MARKET, YARD))
REGIONS: dict[str, Region] = {r.name: r for r in (STREET, CROSSING, PARKING, PARK, PARKING_HARD, *GALE, MARKET, YARD)}
