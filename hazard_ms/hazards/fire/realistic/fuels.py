"""Materials of the catalogue's categories, published heat-release curves of furniture, and floors.

They are for the preset `realistic`.

Sources: [3.1] docs/physics.md 3.1, which names the publications (CFAST fire library, Quintiere and Harkleroad's
ignition data, NUREG-1805, NIST fire calorimetry database, NFPA 204); [M] standard values (SFPE handbook); [ours].
Whether a category burns at all is the catalogue's `flammable`.
"""

from __future__ import annotations

from dataclasses import dataclass

from hazard_ms.spec.catalogue import CATEGORIES

SLOW, MEDIUM, FAST, ULTRAFAST = 0.00293, 0.01172, 0.0469, 0.1876  # growth of t^2 fires [kW/s^2] [3.1: NFPA 204]


@dataclass(frozen=True)
class Material:
    """Properties of a solid that ignites and burns."""

    ignition: float  # temperature of piloted ignition [C]
    critical: float  # least flux that ignites it [kW/m^2]
    inertia: float  # k rho c of a thermally thick solid [kW^2 s/m^4 K^2]; 0: thermally thin
    sheet: float  # heat capacity of a thin one [kJ/m^2 K]; 0: thick
    release: float  # heat release per burning area [kW/m^2]
    combustion: float  # effective heat of combustion [kJ/kg]
    growth: float  # growth of the heat release [kW/s^2]
    soot: float  # soot per burnt mass [kg/kg]
    monoxide: float  # carbon monoxide per burnt mass with enough air [kg/kg] [M: SFPE, Tewarson]
    cyanide: float = 0.0  # hydrogen cyanide per burnt mass with enough air [kg/kg] [M: SFPE, Purser]
    cyanide_smothered: float = 0.0  # the same without [kg/kg] [M: SFPE, Purser]

    @property
    def yields(self) -> tuple[float, ...]:
        """Yields per heat [kg/kJ]: soot, carbon monoxide, hydrogen cyanide with enough air and without, and fuel."""
        parts = (self.soot, self.monoxide, self.cyanide, self.cyanide_smothered, 1.0)
        return tuple(part / self.combustion for part in parts)


MATERIALS: dict[str, Material] = {
    # particleboard 12.7 mm; plywood's heat of combustion; wood crib's 11 g/m^2 s [3.1]; soot of wood [M]
    "wood": Material(412, 18, 0.93, 0, 131, 11900, MEDIUM, 0.015, 0.004),
    # paper's ignition [3.1: NUREG-1805] on a stack like insulation board, critical flux scaled to it; corrugated
    # paper's 14 g/m^2 s
    "paper": Material(230, 8.8, 0.46, 0, 182, 13000, MEDIUM, 0.015, 0.004),
    # a wall of corrugated board: 0.5 kg/m^2 of 1.3 kJ/kg K [M]; else paper
    "cardboard": Material(230, 8.8, 0, 0.65, 182, 13000, FAST, 0.015, 0.004),
    # carpet nylon/wool blend [3.1]; release and soot of nylon [M]
    "fabric": Material(412, 18, 0.68, 0, 250, 20000, MEDIUM, 0.075, 0.038, 0.0056, 0.055),
    # curtain 0.3 kg/m^2 [3.1] of 1.3 kJ/kg K: cloth of clothes and bags; else acrylic's ignition and nylon's release
    "cloth": Material(300, 10, 0, 0.39, 250, 20000, FAST, 0.075, 0.038, 0.016, 0.066),
    # flexible foam 25 mm, 24 g/m^2 s of 22.3 MJ/kg [3.1]; soot and CO of foam GM21 [M]
    "foam": Material(390, 16, 0.32, 0, 535, 22300, FAST, 0.131, 0.010, 0.0013, 0.015),
    # PMMA type G 12.7 mm and its heat of combustion [3.1]; 250 kW/m^2 as a usual floor of goods [3.1]; soot of PMMA [M]
    "plastic": Material(378, 15, 1.02, 0, 250, 24200, MEDIUM, 0.022, 0.010),
    # polyethylene's ignition and combustion [3.1], PMMA's inertia and critical flux; soot of PE [M]
    "wax": Material(340, 15, 1.02, 0, 250, 43400, SLOW, 0.060, 0.024),
    # wood's ignition on wet flesh of k 0.5 W/m K, 900 kg/m^3, 3.7 kJ/kg K; what is left to burn when it is dry [M]
    # [ours]
    "food": Material(350, 16, 1.67, 0, 60, 2000, SLOW, 0.015, 0.004),
}

_OF: dict[str, tuple[str, ...]] = {  # every other category is of wood if it is furniture, else of plastic [ours]
    "paper": ("book", "money", "picture", "framed_picture"),
    "cardboard": ("box",),
    "cloth": ("bag", "backpack"),
    "fabric": ("suitcase", "rug", "teddy_bear"),
    "foam": ("throw_pillow", "sofa", "armchair", "bed", "bee"),
    "wood": ("bowl", "bottle_cork", "coaster", "kitchen_utensil", "pepper_mill"),
    "wax": ("candle",),
    "food": ("banana", "apple", "orange", "pepper", "burger", "bread", "chocolate", "plant"),
}
_BY_NAME = {category: material for material, names in _OF.items() for category in names}


def material(category: str) -> Material:
    """The main material of a category of the catalogue."""
    usual = "wood" if CATEGORIES[category].kind == "fixture" else "plastic"
    return MATERIALS[_BY_NAME.get(category, usual)]


PILLOW = (48.6, 4400.0)  # polyester pillow: peak [kW] and energy [kJ] [3.1: NIST calorimetry]
MEASURED: dict[str, tuple[float, float]] = {"throw_pillow": PILLOW}


@dataclass(frozen=True)
class Curve:
    """A measured heat release: knots (s, kW), straight between them; the fire is over at the last one."""

    radiant: float  # share of the heat that is radiated
    knots: tuple[tuple[float, float], ...]


def _curve(radiant: float, *numbers: float) -> Curve:
    return Curve(radiant, ((0.0, 0.0), *zip(numbers[::2], numbers[1::2], strict=True)))


CURVES: dict[str, Curve] = {  # [3.1: CFAST fire library]
    "upholstered_chair": _curve(
        0.33, 90, 90.5, 140, 452.5, 200, 2099.6, 265, 597.3, 390, 144.8, 540, 144.8, 840, 90.5, 1940, 0
    ),
    "sofa": _curve(
        0.33,
        *(100, 135.9, 200, 953.9, 300, 1864, 400, 3447, 500, 1667, 600, 531.7),
        *(700, 539, 800, 416, 900, 317, 1000, 241, 1100, 217),
    ),
    "mattress": Curve(
        0.30,
        ((0, 25), (400, 100), (580, 300), (615, 540), (760, 300), (910, 660), (1100, 300), (1500, 100), (1700, 75)),
    ),
    "wardrobe": _curve(
        0.33, 60, 250, 120, 1050, 160, 3500, 170, 4500, 180, 3500, 200, 1400, 240, 600, 600, 150, 900, 150
    ),
    "workstation": _curve(
        0.37, 50, 166, 164, 274, 356, 798, 420, 1050, 484, 3080, 550, 6710, 616, 2590, 744, 1140, 872, 714
    ),
    "kiosk": _curve(0.37, 350, 33, 775, 136, 927, 348, 1080, 403, 1230, 1750, 1420, 1080, 1750, 805),
    "curtains": _curve(
        0.30, 120, 0, 150, 50, 168, 150, 180, 240, 210, 200, 228, 150, 240, 100, 294, 50, 462, 15, 540, 3
    ),
    "bunk_bed": _curve(0.52, 99, 9.8, 200, 171, 240, 4620, 300, 1330, 401, 749, 501, 218, 602, 20),
    "tv": _curve(0.40, 150, 3, 420, 10, 480, 50, 600, 150, 720, 280, 900, 150, 1200, 90, 1500, 120, 1800, 35),
}
CURVE_OF = {
    "armchair": "upholstered_chair",
    "sofa": "sofa",
    "bed": "mattress",
    "cabinet": "wardrobe",
    "bookshelf": "wardrobe",
    "kiosk": "kiosk",
}

AS_GOODS = 250.0  # heat release of a burning floor per area [kW/m^2] [3.1]


@dataclass(frozen=True)
class Floor:
    """A floor that flames and smoke can light: a thick solid."""

    ignition: float  # [C]
    critical: float  # least flux that ignites it [kW/m^2]
    inertia: float  # k rho c [kW^2 s/m^4 K^2]; 0: it does not burn


BARE = Floor(1000.0, 1.0, 0.0)
_PLYWOOD = Floor(390.0, 16.0, 0.54)  # 12.7 mm [3.1]
_CARPET = Floor(300.0, 10.0, 0.42)  # acrylic [3.1]
FLOORS = {  # by the material of the floor; every other one is bare
    "wood": _PLYWOOD,
    "parquet": _PLYWOOD,
    "light_wood": _PLYWOOD,
    "carpet": _CARPET,
    "carpet_blue": _CARPET,
    "grass": Floor(412.0, 18.0, 0.93),  # as slow as particleboard [ours]
}
