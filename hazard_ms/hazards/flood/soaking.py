"""Properties of the catalogue's categories in water: the shape that stands for each, and how porous ones soak.

Soaking times and dry densities are for the preset `realistic`: orders of magnitude of the materials named
(docs/physics.md 3.2: bags and pillows 10 to 100 s), chosen by us. A thing without a row keeps its air.
"""

from __future__ import annotations

from dataclasses import dataclass

from hazard_ms.hazards.flood.buoyancy import BALL, BOX, CYLINDER
from hazard_ms.spec.catalogue import CATEGORIES

_BALLS = ("apple", "orange", "pepper")
_CYLINDERS = (
    "bottle",
    "soda_can",
    "candle",
    "coffee_grinder",
    "vase",
    "mug",
    "wine_glass",
    "trophy",
    "burger",
    "bottle_cork",
)  # upright
SHAPES = {name: BALL if name in _BALLS else CYLINDER if name in _CYLINDERS else BOX for name in CATEGORIES}

ELECTRONIC = ("phone", "camera", "printer", "laptop", "headphone", "lighter", "vacuum_cleaner")  # ruined by a short dip


@dataclass(frozen=True)
class Soaking:
    """Properties of a porous thing that takes up water."""

    time: float  # time until all but 1 / e of its air is replaced, wholly immersed [s] [ours]
    solid: float  # density of its material [kg/m^3] [M]


SOAKING: dict[str, Soaking] = {
    "bag": Soaking(60.0, 1100.0),  # leather, cloth
    "backpack": Soaking(40.0, 1150.0),  # polyamide
    "throw_pillow": Soaking(30.0, 1380.0),  # polyester
    "teddy_bear": Soaking(30.0, 1380.0),
    "suitcase": Soaking(100.0, 1100.0),
    "book": Soaking(100.0, 1500.0),  # cellulose
    "money": Soaking(20.0, 1500.0),
    "box": Soaking(60.0, 1500.0),  # cardboard
    "burger": Soaking(20.0, 1200.0),
    "printer": Soaking(15.0, 1100.0),  # openings everywhere
    "vacuum_cleaner": Soaking(20.0, 1100.0),
    "headphone": Soaking(20.0, 1050.0),
    "camera": Soaking(30.0, 1800.0),
    "coffee_maker": Soaking(15.0, 1050.0),
    "basket": Soaking(2.0, 950.0),  # open: it holds no air
}


def porosity(name: str) -> float:
    """Share of the volume of the category `name` that water takes in the end, 0 to 1."""
    row = SOAKING.get(name)
    return 0.0 if row is None else max(0.0, 1.0 - CATEGORIES[name].density / row.solid)
