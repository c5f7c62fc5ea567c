"""Categories of the objects that stand in rooms, and where they do not stand because of what things are for.

The published scenes were made without these rules (`Layout.anywhere`) and keep their things where they were, but for
vacuum cleaners, which were put down to the floor.
"""

from __future__ import annotations

from hazard_ms.spec.catalogue import FIRE_POOL, TEST_EXTRAS

_OTHERS = ("box", "soda_can", "coffee_maker", "fire_extinguisher", "bottle_cork", "pliers", "skate", "vacuum_cleaner")
TRAIN_THINGS = (*FIRE_POOL, *_OTHERS)  # no training scene holds new objects
TEST_THINGS = (*TRAIN_THINGS, *TEST_EXTRAS)

FOR_FOOD = ("table", "coffee_table", "counter")  # where people eat and cook
FOR_PEOPLE = ("chair", "stool", "sofa", "armchair", "bed")  # where people sit and lie
FOR_STORAGE = ("shelf", "cabinet")

WRONG_PLACES: dict[str, tuple[str, ...]] = {  # category of a thing -> furniture on which it does not stand [ours]
    # what belongs on the floor
    **dict.fromkeys(("vacuum_cleaner", "fire_extinguisher"), FOR_FOOD + FOR_PEOPLE + FOR_STORAGE),
    **dict.fromkeys(("skate", "suitcase", "backpack"), FOR_FOOD),
    # what is soft, or for the body
    "throw_pillow": FOR_FOOD,
    **dict.fromkeys(("toothbrush", "hairbrush"), ("counter",)),
    # what is hot, sharp or spills
    **dict.fromkeys(("pan", "coffee_maker", "candle", "knife", "scissors", "wine_glass", "bowl"), FOR_PEOPLE),
    **dict.fromkeys(("plate", "burger", "mug", "vase", "hammer"), FOR_PEOPLE),
}


def stands_on(category: str, furniture: str) -> bool:
    """Whether a thing of the `category` may stand on `furniture`, a category of fixtures."""
    return furniture not in WRONG_PLACES.get(category, ())
