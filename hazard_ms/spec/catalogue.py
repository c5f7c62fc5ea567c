"""The one table of all kinds of things and of how hazards act on them: scorer, planner, prompts and labels read it.

Each number's source is the letter in the same place of the row's last column, see SOURCES. Density is mass over the
volume inside the outer surface, cavities included, so it says whether the thing floats. Drag refers to the frontal
area.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from hazard_ms.spec import catalogue_original as original
from hazard_ms.spec.catalogue_rows import FIXTURES, IMMOVABLE, OBJECTS, Row
from hazard_ms.spec.scene import Body, Fixture

HIGH_VALUE, LOW_VALUE = 5, 1  # HAZARD challenge.py:88
LEAST_VALUE, MOST_VALUE = 1.0, 20.0  # that a scene may give to a single thing [ours]: of targets in homes
FLOOD_BOARD = "flood_board"  # what flood boards are called before their number; their category is box
DAMAGED_SHARE = 0.5  # of its value that a target keeps when it is rescued damaged (docs/benchmark.md 4)

SOURCES = {
    "H": "HAZARD, published attributes of categories (scene_configs: value.json, fire.json, fluid.json)",
    "T": "HAZARD, data/meta_data/temperature.json, the commonest value among the category's models",
    "L": "HAZARD, data/meta_data/temperature.json, value of the nearest listed kind (sandwich, cup, cabinet, ...)",
    "U": "HAZARD, fireagent_controller.py:147-173, default for names without an entry",
    "W": "HAZARD, scene_configs/object_list.json",
    "M": "handbook density of the main material times the share of the volume that it fills (estimate)",
    "D": "Aeronautical Engineer's Data Book p. 119; Hoerner: sphere 0.47, cylinder 0.63-0.87, cube 1.05, plate 1.17",
    "O": "ours",
}
NUMBERED = (
    "value",
    "flammable",
    "waterproof",
    "ignition_temperature",
    "density",
    "drag_coefficient",
    "wind_resistance",
)

GRASPS = {  # where a hand takes a thing best: which objects; all others by the body, fixtures not at all [ours]
    "handle": "basket coffee_maker fire_extinguisher flashlight hairbrush hammer jug knife mug pan pliers pot scissors "
    "suitcase teakettle toothbrush vacuum_cleaner carving_fork fork spoon kitchen_utensil",
    "strap": "bag backpack headphone camera rescue_bag",
    "rim": "bowl plate coaster",
    "neck": "bottle vase wine_glass trophy",
    "edge": "book laptop money phone chocolate key coin shirt_button",
    "body": "",
}

LIMITS = {  # what a row may hold, in its units
    "ignition_temperature": (40, 4000),
    "density": (10, 12000),
    "drag_coefficient": (0.05, 2.5),
    "wind_resistance": (0, IMMOVABLE),
}


@dataclass(frozen=True)
class Category:
    """One kind of thing."""

    name: str  # lower case, words joined by underscores: "coffee_grinder"
    published: str  # its name in the HAZARD files; empty: not among them
    kind: str  # object (moves) | fixture (furniture)
    value: int  # of one rescued
    flammable: bool
    waterproof: bool
    ignition_temperature: float  # [C]
    density: float  # [kg/m^3]
    drag_coefficient: float  # [-]
    wind_resistance: float  # [-] felt wind = wind / (1 + resistance), none above 10
    sources: str  # one letter per entry of NUMBERED
    grasp: str = ""  # where a hand takes one best, one of GRASPS; empty for what is not taken [ours]

    def source(self, attribute: str) -> str:
        """The source of the number `attribute`. Raises ValueError for attributes without one."""
        if attribute not in NUMBERED:
            raise ValueError(f"an attribute with a source must be one of {', '.join(NUMBERED)}, got {attribute!r}")
        return SOURCES[self.sources[NUMBERED.index(attribute)]]

    @property
    def label(self) -> str:
        """The name in ordinary words: "coffee grinder"."""
        return self.name.replace("_", " ")


def _read(rows: Iterable[Row], kind: str) -> Iterable[Category]:
    for name, published, high, flammable, waterproof, ignition, density, drag, resistance, sources in rows:
        value = HIGH_VALUE if high else LOW_VALUE
        flags = bool(flammable), bool(waterproof)
        grasp = (
            next((part for part, names in GRASPS.items() if name in names.split()), "body") if kind == "object" else ""
        )
        yield Category(
            name,
            published,
            kind,
            value,
            *flags,
            float(ignition),
            float(density),
            drag,
            float(resistance),
            sources,
            grasp,
        )


def check(rows: Iterable[Category]) -> dict[str, Category]:
    """The table by name. Raises ValueError that names the row and what is wrong with it."""
    table: dict[str, Category] = {}
    for c in rows:
        for attribute, (low, high) in LIMITS.items():
            if not low <= getattr(c, attribute) <= high:
                raise ValueError(f"{attribute} of {c.name!r} must be from {low} to {high}, got {getattr(c, attribute)}")
        if c.value not in (LOW_VALUE, HIGH_VALUE):
            raise ValueError(f"value of {c.name!r} must be {LOW_VALUE} or {HIGH_VALUE}, got {c.value}")
        if c.kind not in ("object", "fixture"):
            raise ValueError(f"kind of {c.name!r} must be object or fixture, got {c.kind!r}")
        if (c.grasp not in GRASPS) if c.kind == "object" else c.grasp:
            raise ValueError(
                f"grasp of {c.name!r} must be one of {', '.join(GRASPS)} (objects) or empty, got {c.grasp!r}"
            )
        if not c.name.isidentifier() or c.name != c.name.lower():
            raise ValueError(f"a name must be lower-case words joined by underscores, got {c.name!r}")
        if len(c.sources) != len(NUMBERED) or set(c.sources) - set(SOURCES):
            raise ValueError(
                f"sources of {c.name!r} must be {len(NUMBERED)} letters of {''.join(SOURCES)}, got {c.sources!r}"
            )
        if c.name in table:
            raise ValueError(f"names of categories must differ, got {c.name!r} twice")
        table[c.name] = c
    return table


CATEGORIES: dict[str, Category] = check(
    (
        *_read(OBJECTS, "object"),
        *_read(FIXTURES, "fixture"),
        *_read(original.OBJECTS, "object"),
        *_read(original.FIXTURES, "fixture"),
    )
)

FIRE_POOL = tuple(row[0] for row in OBJECTS[:22])  # targets of fire and flood, the table in the paper's appendix
TEST_EXTRAS = ("suitcase", "candle")  # stand in published test scenes only
WIND_POOL = (
    "bag",
    "backpack",
    "basket",
    "money",
    "box",
    "soda_can",
    "headphone",
    "suitcase",
    "phone",
    "bottle",
    "camera",
)
NEW_OBJECTS = tuple(row[0] for row in OBJECTS[35:-1]) + ("headphone", "money")


def category(name: str) -> Category:
    """The category called `name`. Raises ValueError for unknown names."""
    if name not in CATEGORIES:
        raise ValueError(f"category must be one of {', '.join(CATEGORIES)}, got {name!r:.100}")
    return CATEGORIES[name]


def value_of(thing: Body | Fixture) -> float:
    """The value of a thing that is rescued: its own where its scene gives one, else that of its category."""
    own = thing.value if isinstance(thing, Body) else None
    return float(CATEGORIES[thing.category].value if own is None else own)
