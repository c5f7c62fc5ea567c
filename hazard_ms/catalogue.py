"""The one table of what kinds of things there are and how hazards act on them: scorer, planner, prompts and labels read it.

Each number's source is the letter in the same place of the row's last column, see SOURCES. Density is mass over the volume inside
the outer surface, cavities included, so it says whether the thing floats. Drag refers to the frontal area.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from hazard_ms import catalogue_original as original

HIGH_VALUE, LOW_VALUE = 5, 1  # HAZARD challenge.py:88
DAMAGED_SHARE = 0.5  # of its value that a target keeps when it is rescued damaged (benchmark rules 4)
IMMOVABLE = 11  # HAZARD envs/wind/object.py:41: a wind resistance above 10 feels no wind

SOURCES = {
    "H": "HAZARD, published attributes of categories (scene_configs: value.json, fire.json, fluid.json)",
    "T": "HAZARD, data/meta_data/temperature.json, the commonest value among the category's models",
    "L": "HAZARD, data/meta_data/temperature.json, value of the nearest listed kind (sandwich, cup, gas cooker, cabinet, ...)",
    "U": "HAZARD, fireagent_controller.py:147-173, default for names without an entry",
    "W": "HAZARD, scene_configs/object_list.json",
    "M": "handbook density of the main material times the share of the volume that it fills (estimate)",
    "D": "Aeronautical Engineer's Data Book p. 119; Hoerner: sphere 0.47, cylinder 0.63-0.87, cube 1.05, plate 1.17",
    "O": "ours",
}
NUMBERED = ("value", "flammable", "waterproof", "ignition_temperature", "density", "drag_coefficient", "wind_resistance")

GRASPS = {  # where a hand takes a thing best: which objects; all others by the body, fixtures not at all [ours]
    "handle": "basket coffee_maker fire_extinguisher flashlight hairbrush hammer jug knife mug pan pliers pot scissors suitcase "
    "teakettle toothbrush vacuum_cleaner carving_fork fork spoon kitchen_utensil",
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
        """Where the number `attribute` comes from."""
        if attribute not in NUMBERED:
            raise ValueError(f"{attribute!r} has no source; those that have one: {', '.join(NUMBERED)}")
        return SOURCES[self.sources[NUMBERED.index(attribute)]]

    @property
    def label(self) -> str:
        """As people say it."""
        return self.name.replace("_", " ")


_Row = tuple[str, str, int, int, int, float, float, float, float, str]
_OBJECTS: tuple[_Row, ...] = (
    # name, HAZARD's name, high value, flammable, waterproof, ignition C, density kg/m3, drag, wind resistance, sources
    ("bag", "bag, handbag, pocketbook, purse", 1, 1, 0, 200, 120, 1.05, 1, "HHHTMDW"),
    ("banana", "banana", 0, 1, 1, 100, 950, 0.82, 0, "HHHTMDO"),
    ("plate", "plate", 1, 0, 1, 500, 2300, 1.17, 0, "HHHTMDO"),
    ("phone", "ipod", 1, 0, 0, 400, 1900, 1.17, 3, "HHHTMDW"),
    ("hairbrush", "hairbrush", 0, 1, 1, 200, 500, 0.82, 0, "HHHTMDO"),
    ("bowl", "bowl", 1, 1, 1, 500, 800, 1.05, 0, "HHHTMDO"),
    ("pen", "pen", 0, 0, 1, 200, 900, 0.82, 0, "HHHTMDO"),
    ("lighter", "lighter", 0, 0, 0, 500, 1000, 1.05, 0, "HHHTMDO"),
    ("toothbrush", "toothbrush", 0, 0, 1, 200, 900, 0.82, 0, "HHHTMDO"),
    ("apple", "apple", 0, 1, 1, 100, 830, 0.47, 0, "HHHTMDO"),
    ("key", "key", 0, 0, 1, 500, 4000, 1.17, 0, "HHHTMDO"),
    ("pan", "pan", 0, 0, 1, 3000, 1500, 1.05, 0, "HHHTMDO"),
    ("bottle", "bottle", 0, 0, 1, 500, 900, 0.74, 0, "HHHTMDW"),
    ("chocolate", "chocolate candy", 1, 1, 0, 200, 1300, 1.17, 0, "HHHTMDO"),
    ("book", "book", 1, 1, 0, 200, 800, 1.17, 0, "HHHTMDO"),
    ("printer", "printer", 1, 0, 0, 500, 250, 1.05, 3, "HHHTMDO"),
    ("camera", "camera", 1, 0, 0, 400, 900, 1.05, 3, "HHHTMDW"),
    ("basket", "basket", 0, 0, 1, 2000, 60, 1.05, 0, "HHHTMDW"),
    ("backpack", "backpack", 1, 1, 0, 300, 100, 1.05, 2, "HHHTMDW"),
    ("coffee_grinder", "coffee grinder", 1, 0, 1, 700, 700, 0.82, 2, "HHHTMDO"),
    ("throw_pillow", "throw pillow", 0, 1, 0, 200, 50, 1.05, 0, "HHHTMDO"),
    ("shirt_button", "shirt button", 0, 1, 1, 300, 1190, 1.17, 0, "HHHTMDO"),
    ("suitcase", "suitcase", 1, 1, 0, 300, 120, 1.05, 2, "HHHTMDO"),
    ("candle", "candle", 0, 1, 1, 200, 900, 0.74, 0, "HHHTMDO"),
    ("money", "money", 1, 1, 0, 200, 700, 1.17, 0, "HOOUMDW"),
    ("box", "box", 0, 1, 0, 500, 120, 1.05, 3, "HHHTMDW"),
    ("soda_can", "soda can", 0, 0, 1, 2000, 1000, 0.68, 0, "HHHTMDW"),
    ("headphone", "headphone", 1, 0, 0, 400, 250, 1.05, 2, "HOOTMDW"),
    ("bee", "bee", 0, 1, 0, 200, 300, 1.05, 0, "HHHUMDO"),
    ("bottle_cork", "bottle cork", 0, 1, 0, 200, 180, 0.87, 0, "HHHTMDO"),
    ("coffee_maker", "coffee maker", 0, 0, 1, 500, 300, 1.05, 2, "HHHTMDO"),
    ("fire_extinguisher", "fire extinguisher", 1, 0, 1, 3000, 1100, 0.74, 3, "HHHOMDO"),
    ("pliers", "pliers", 0, 0, 1, 1000, 4000, 1.17, 0, "HHHLMDO"),
    ("skate", "skate", 1, 0, 1, 500, 400, 1.05, 2, "HHHOMDO"),
    ("vacuum_cleaner", "vacuum cleaner", 1, 0, 0, 500, 200, 1.05, 3, "HHHOMDO"),
    # New objects: no training scene holds them as targets.
    ("laptop", "laptop, laptop computer", 1, 0, 0, 500, 1500, 1.17, 3, "OOOTMDO"),
    ("vase", "vase", 1, 0, 1, 60, 600, 0.74, 0, "HOOTMDO"),
    ("wine_glass", "wineglass", 1, 0, 1, 1000, 600, 0.74, 0, "HOOTMDO"),
    ("knife", "knife", 1, 0, 1, 500, 4000, 0.82, 0, "HOOTMDO"),
    ("scissors", "scissors", 1, 0, 1, 500, 4000, 1.17, 0, "HOOTMDO"),
    ("trophy", "trophy", 1, 0, 1, 500, 1500, 0.74, 2, "HOOTMDO"),
    ("pepper", "", 0, 1, 1, 100, 500, 0.47, 0, "OOOLMDO"),
    ("burger", "sandwich", 0, 1, 0, 100, 500, 0.82, 0, "HOOTMDO"),
    ("orange", "orange", 0, 1, 1, 100, 950, 0.47, 0, "OOOTMDO"),
    ("mug", "cup", 0, 0, 1, 500, 900, 0.68, 0, "OOOTMDO"),
    ("teddy_bear", "", 0, 1, 0, 300, 60, 1.05, 0, "OOOLMDO"),
    ("hammer", "", 0, 0, 1, 500, 2500, 0.82, 0, "OOOLMDO"),
    ("flashlight", "", 0, 0, 1, 500, 1100, 0.74, 0, "OOOLMDO"),
    ("rescue_bag", "", 0, 0, 1, 3000, 60, 1.05, 11, "OOOLMDO"),  # the agent's own: HAZARD gives its backpack 3000 C
)

_F = IMMOVABLE
_FIXTURES: tuple[_Row, ...] = (
    ("table", "table", 0, 1, 1, 300, 80, 1.17, _F, "OOOTMDO"),
    ("coffee_table", "coffee table", 0, 1, 1, 300, 80, 1.17, _F, "OOOLMDO"),
    ("chair", "chair", 0, 1, 1, 300, 100, 1.05, _F, "OOOTMDO"),
    ("stool", "stool", 0, 1, 1, 500, 100, 1.05, _F, "OOOTMDO"),
    ("counter", "cabinet", 0, 1, 1, 700, 250, 1.05, _F, "OOOLMDO"),
    ("cabinet", "cabinet", 0, 1, 1, 700, 150, 1.05, _F, "OOOTMDO"),
    ("wall_cupboard", "cabinet", 0, 1, 1, 700, 150, 1.05, _F, "OOOTMDO"),
    ("shelf", "shelf", 0, 1, 1, 300, 100, 1.05, _F, "OOOTMDO"),
    ("sofa", "", 0, 1, 0, 600, 70, 1.05, _F, "OOOLMDO"),
    ("armchair", "", 0, 1, 0, 600, 70, 1.05, _F, "OOOLMDO"),
    ("bed", "", 0, 1, 0, 200, 80, 1.05, _F, "OOOLMDO"),
    ("rug", "rug", 0, 1, 0, 500, 200, 1.17, _F, "OOOLMDO"),
    ("lamp", "", 0, 0, 0, 400, 60, 0.74, _F, "OOOLMDO"),
    ("fridge", "", 0, 0, 1, 2000, 120, 1.05, _F, "OOOLMDO"),
    ("stove", "gas cooker", 0, 0, 1, 500, 250, 1.05, _F, "OOOTMDO"),
    ("sink", "", 0, 1, 1, 700, 150, 1.05, _F, "OOOLMDO"),
    ("microwave", "microwave", 0, 0, 0, 2000, 350, 1.05, _F, "OOOTMDO"),
    ("bin", "", 0, 0, 1, 1000, 60, 0.82, _F, "OOOLMDO"),
    ("plant", "houseplant", 0, 1, 1, 200, 60, 1.05, _F, "OOOTMDO"),
    ("picture", "painting", 0, 1, 0, 200, 300, 1.17, _F, "OOOTMDO"),
    ("door", "", 0, 1, 1, 700, 400, 1.17, _F, "OOOLMDO"),
    ("window", "", 0, 0, 1, 2000, 1000, 1.17, _F, "OOOLMDO"),
    ("cart", "shopping cart", 0, 0, 1, 2000, 60, 1.05, _F, "OOOLMDO"),
    ("bench", "", 0, 1, 1, 300, 150, 1.05, _F, "OOOLMDO"),
    ("tree", "", 0, 1, 1, 300, 100, 1.05, _F, "OOOLMDO"),
    ("hedge", "", 0, 1, 1, 200, 30, 1.05, _F, "OOOLMDO"),
    ("fence", "", 0, 1, 1, 300, 100, 1.17, _F, "OOOLMDO"),
    ("street_lamp", "", 0, 0, 1, 3000, 100, 0.82, _F, "OOOLMDO"),
    ("car", "", 0, 0, 1, 2000, 120, 1.05, _F, "OOOLMDO"),
    ("hydrant", "", 0, 0, 1, 3000, 2000, 0.74, _F, "OOOLMDO"),
    ("house", "", 0, 0, 1, 3000, 300, 1.05, _F, "OOOLMDO"),
    ("trash_bin", "", 0, 0, 1, 1000, 60, 0.82, _F, "OOOLMDO"),
    ("mailbox", "", 0, 0, 1, 3000, 250, 0.82, _F, "OOOLMDO"),
    ("traffic_cone", "", 0, 1, 1, 300, 100, 0.74, _F, "OOOLMDO"),
    ("bollard", "", 0, 0, 1, 3000, 600, 0.82, _F, "OOOLMDO"),
    ("traffic_sign", "", 0, 0, 1, 3000, 150, 1.17, _F, "OOOLMDO"),
    ("bus_stop", "", 0, 0, 1, 3000, 40, 1.05, _F, "OOOLMDO"),
    ("kiosk", "", 0, 1, 1, 300, 60, 1.05, _F, "OOOLMDO"),
    ("picnic_table", "", 0, 1, 1, 300, 30, 1.05, _F, "OOOLMDO"),
    ("planter", "", 0, 0, 1, 3000, 900, 1.05, _F, "OOOLMDO"),
    ("sandbox", "", 0, 0, 1, 3000, 1200, 1.05, _F, "OOOLMDO"),
    ("slide", "", 0, 0, 1, 3000, 25, 1.05, _F, "OOOLMDO"),
    ("swing", "", 0, 1, 1, 300, 10, 1.05, _F, "OOOLMDO"),
    ("shed", "", 0, 1, 1, 300, 35, 1.05, _F, "OOOLMDO"),
)


def _read(rows: Iterable[_Row], kind: str) -> Iterable[Category]:
    for name, published, high, flammable, waterproof, ignition, density, drag, resistance, sources in rows:
        value = HIGH_VALUE if high else LOW_VALUE
        flags = bool(flammable), bool(waterproof)
        grasp = next((part for part, names in GRASPS.items() if name in names.split()), "body") if kind == "object" else ""
        yield Category(name, published, kind, value, *flags, float(ignition), float(density), drag, float(resistance), sources, grasp)


def check(rows: Iterable[Category]) -> dict[str, Category]:
    """The table by name. Raises ValueError naming the row and what is wrong with it."""
    table: dict[str, Category] = {}
    for c in rows:
        for attribute, (low, high) in LIMITS.items():
            if not low <= getattr(c, attribute) <= high:
                raise ValueError(f"{attribute} {getattr(c, attribute)} of {c.name!r} is not between {low} and {high}")
        if c.value not in (LOW_VALUE, HIGH_VALUE):
            raise ValueError(f"value {c.value} of {c.name!r} is neither {LOW_VALUE} nor {HIGH_VALUE}")
        if c.kind not in ("object", "fixture"):
            raise ValueError(f"kind {c.kind!r} of {c.name!r} is neither object nor fixture")
        if (c.grasp not in GRASPS) if c.kind == "object" else c.grasp:
            raise ValueError(f"grasp {c.grasp!r} of {c.name!r}, a {c.kind}: objects need one of {', '.join(GRASPS)}, fixtures none")
        if not c.name.isidentifier() or c.name != c.name.lower():
            raise ValueError(f"name {c.name!r} is not of lower-case words joined by underscores")
        if len(c.sources) != len(NUMBERED) or set(c.sources) - set(SOURCES):
            raise ValueError(f"sources {c.sources!r} of {c.name!r} are not {len(NUMBERED)} letters of {''.join(SOURCES)}")
        if c.name in table:
            raise ValueError(f"category {c.name!r} stands twice in the catalogue")
        table[c.name] = c
    return table


CATEGORIES: dict[str, Category] = check(
    (
        *_read(_OBJECTS, "object"),
        *_read(_FIXTURES, "fixture"),
        *_read(original.OBJECTS, "object"),
        *_read(original.FIXTURES, "fixture"),
    )
)

FIRE_POOL = tuple(row[0] for row in _OBJECTS[:22])  # targets of fire and flood, [P] table of the appendix
TEST_EXTRAS = ("suitcase", "candle")  # stand in published test scenes only
WIND_POOL = ("bag", "backpack", "basket", "money", "box", "soda_can", "headphone", "suitcase", "phone", "bottle", "camera")
NEW_OBJECTS = tuple(row[0] for row in _OBJECTS[35:-1]) + ("headphone", "money")


def category(name: str) -> Category:
    """The category called `name`."""
    if name not in CATEGORIES:
        raise ValueError(f"no category is called {name!r}; there are {', '.join(CATEGORIES)}")
    return CATEGORIES[name]
