"""Categories of the objects that stand in rooms, besides their targets."""

from __future__ import annotations

from hazard_ms.spec.catalogue import FIRE_POOL, TEST_EXTRAS

_OTHERS = ("box", "soda_can", "coffee_maker", "fire_extinguisher", "bottle_cork", "pliers", "skate", "vacuum_cleaner")
TRAIN_THINGS = (*FIRE_POOL, *_OTHERS)  # no training scene holds new objects
TEST_THINGS = (*TRAIN_THINGS, *TEST_EXTRAS)
