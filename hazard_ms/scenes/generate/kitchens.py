"""The kitchens, as data."""

from __future__ import annotations

from dataclasses import replace

from hazard_ms.scenes.generate.layout import (
    Against,
    Around,
    Before,
    Corner,
    Either,
    Hanging,
    Hole,
    Layout,
    OnTop,
    RoomPart,
    Row,
    Rug,
    Standing,
)
from hazard_ms.scenes.generate.room_things import TEST_THINGS, TRAIN_THINGS
from hazard_ms.spec.catalogue import FIRE_POOL, NEW_OBJECTS

KITCHEN_A = Layout(
    name="kitchen_a",
    parts=(
        RoomPart(
            width=(6.8, 7.4),
            holes=(
                Hole("window", "north", (0.40, 0.52), 1.3, 1.15, 1.1),
                Hole("window", "east", (0.45, 0.6), 1.1, 1.2, 1.0),
                Hole("door", "south", (0.10, 0.16), 0.9, 2.05),
            ),
            rules=(
                Either(
                    (
                        Row("north", ("fridge", "counter", "sink", "counter", "stove")),
                        Row("north", ("fridge", "counter", "stove", "counter", "sink", "counter")),
                    )
                ),
                Hanging("wall_cupboard", 1.42, of="counter"),
                Standing("table", (0.28, 0.40, 0.45, 0.52)),
                Around("chair", "table", (3, 4)),
                Against("sofa", ("east", "south"), (0.25, 0.75)),
                Before("coffee_table", "sofa", (0.45, 0.6), optional=True),
                Rug("rug", "coffee_table"),
                Against("shelf", ("west", "south"), (0.2, 1.0)),
                Against("cabinet", ("south", "west", "east"), (0.0, 1.0)),
                Corner("lamp", ("south-east", "north-east"), optional=True),
                Corner("plant", ("north-east", "south-east"), optional=True),
                Against("bin", ("west", "north"), (0.3, 1.0), optional=True),
                OnTop("microwave", "counter"),
                Hanging("picture", 1.45, walls=("south", "west", "east")),
            ),
        ),
    ),
    depth=(5.8, 6.4),
    floors=("wood", "tile", "light_wood"),
    walls=("plaster", "paint_white", "paint_green", "paint_blue"),
    pool=FIRE_POOL,
    things=TRAIN_THINGS,
    anywhere=True,
)

KITCHEN_B = Layout(  # long and narrow, with worktops on both sides
    name="kitchen_b",
    parts=(
        RoomPart(
            width=(8.2, 8.8),
            holes=(
                Hole("window", "north", (0.22, 0.30), 1.2, 1.15, 1.1),
                Hole("window", "north", (0.72, 0.80), 1.2, 1.15, 1.1),
                Hole("door", "east", (0.42, 0.58), 0.9, 2.05),
            ),
            rules=(
                Either(
                    (
                        Row("north", ("fridge", "counter", "sink", "counter", "counter")),
                        Row("north", ("cabinet", "counter", "counter", "sink", "counter")),
                    )
                ),
                Either(
                    (
                        Row("south", ("counter", "stove", "counter"), start=(0.4, 1.2)),
                        Row("south", ("stove", "counter", "shelf"), start=(0.4, 1.2)),
                    )
                ),
                Hanging("wall_cupboard", 1.42, of="counter"),
                Standing("table", (0.62, 0.42, 0.74, 0.56), yaws=(0.0, 90.0)),
                Around("chair", "table", (3, 5)),
                Rug("rug", "table"),
                Against("shelf", ("south",), (0.5, 1.0)),
                Against("cabinet", ("south", "west"), (0.3, 1.0)),
                Against("stool", ("west", "north", "south"), (0.2, 0.9), optional=True),
                Corner("plant", ("south-east", "north-east"), optional=True),
                Corner("lamp", ("north-east", "south-east"), optional=True),
                Against("bin", ("west", "south"), (0.1, 0.9), optional=True),
                OnTop("microwave", "counter"),
                Hanging("picture", 1.45, walls=("south", "west", "east")),
            ),
        ),
    ),
    depth=(4.8, 5.2),
    floors=("dark_tile", "tile", "parquet"),
    walls=("paint_white", "wallpaper_stripes", "plaster"),
    pool=FIRE_POOL,
    things=TEST_THINGS,
    anywhere=True,
)

KITCHEN_B_NEW = replace(KITCHEN_B, name="kitchen_b_new", pool=NEW_OBJECTS)
# If nobody acts, as large a share of the targets' value burns in its 900 frames as in the 1,500 of KITCHEN_B
KITCHEN_B_HARD = replace(KITCHEN_B, name="kitchen_b_hard", targets=(12, 18), fires=(3, 4), inflows=2)
