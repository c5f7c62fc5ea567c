"""The living room, the craft room and the flat, as data."""

from __future__ import annotations

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
from hazard_ms.spec.catalogue import FIRE_POOL

LIVING_ROOM_A = Layout(
    name="living_room_a",
    parts=(
        RoomPart(
            width=(7.0, 7.6),
            holes=(
                Hole("window", "south", (0.28, 0.36), 1.6, 1.3, 0.9),
                Hole("window", "south", (0.68, 0.76), 1.6, 1.3, 0.9),
                Hole("door", "west", (0.75, 0.88), 0.9, 2.05),
            ),
            rules=(
                Either(
                    (Against("sofa", ("north",), (0.3, 0.6)), Standing("sofa", (0.38, 0.58, 0.5, 0.68), (0.0,), 0.0))
                ),
                Before("coffee_table", "sofa", (0.42, 0.55)),
                Rug("rug", "coffee_table"),
                Around("armchair", "coffee_table", (1, 2), (0.35, 0.5)),
                Row("east", ("shelf", "cabinet", "shelf"), start=(1.2, 2.6)),
                Standing("table", (0.70, 0.18, 0.80, 0.30), yaws=(0.0, 90.0), optional=True),
                Around("chair", "table", (2, 4), optional=True),
                Against("cabinet", ("west", "north"), (0.1, 0.9)),
                Against("shelf", ("west", "north"), (0.0, 0.9), optional=True),
                Corner("lamp", ("north-east", "north-west"), optional=True),
                Corner("plant", ("south-west", "south-east")),
                Corner("plant", ("north-east", "south-west"), optional=True),
                Corner("lamp", ("south-west", "south-east"), optional=True),
                Hanging("picture", 1.45, walls=("north", "west")),
                Hanging("picture", 1.45, walls=("north", "east")),
            ),
        ),
    ),
    depth=(5.8, 6.2),
    floors=("parquet", "wood", "carpet_blue"),
    walls=("wallpaper_stripes", "wallpaper_flowers", "paint_blue", "plaster"),
    pool=FIRE_POOL,
    things=TRAIN_THINGS,
    anywhere=True,
)

CRAFT_ROOM_A = Layout(  # work tables in the middle, stores along the walls
    name="craft_room_a",
    parts=(
        RoomPart(
            width=(5.8, 6.3),
            holes=(
                Hole("window", "east", (0.30, 0.38), 1.4, 1.3, 1.0),
                Hole("window", "west", (0.55, 0.7), 1.2, 1.2, 1.0),
                Hole("door", "south", (0.78, 0.86), 0.9, 2.05),
            ),
            rules=(
                Row("north", ("shelf", "cabinet", "shelf", "shelf"), start=(0.05, 0.6)),
                Either(
                    (
                        Row("west", ("counter", "sink", "counter"), start=(0.3, 1.2)),
                        Row("west", ("counter", "counter", "cabinet"), start=(0.3, 1.2)),
                    )
                ),
                Standing("table", (0.50, 0.52, 0.60, 0.60)),
                Around("stool", "table", (2, 4)),
                Against("table", ("east",), (0.55, 0.85), optional=True),
                Around("chair", "table", (1, 1), optional=True),
                Against("shelf", ("south", "east"), (0.0, 0.7)),
                Corner("armchair", ("south-west", "south-east"), optional=True),
                Corner("lamp", ("south-west", "north-east"), optional=True),
                Corner("plant", ("north-east", "south-east"), optional=True),
                Against("bin", ("east", "west", "south"), (0.1, 0.9), optional=True),
                Hanging("picture", 1.5, walls=("south", "east")),
            ),
        ),
    ),
    depth=(6.0, 6.6),
    floors=("light_wood", "carpet", "tile"),
    walls=("paint_white", "paint_green", "wallpaper_flowers"),
    pool=FIRE_POOL,
    things=TRAIN_THINGS,
    anywhere=True,
)

FLAT_A = Layout(  # a kitchen and a living room, of more than twice the floor of any single room together
    name="flat_a",
    parts=(
        RoomPart(
            width=(5.8, 6.4),
            holes=(
                Hole("window", "north", (0.40, 0.52), 1.3, 1.15, 1.1),
                Hole("window", "west", (0.45, 0.6), 1.1, 1.2, 1.0),
                Hole("door", "south", (0.12, 0.2), 0.9, 2.05),
            ),
            rules=(
                Row("north", ("fridge", "counter", "sink", "counter", "stove")),
                Hanging("wall_cupboard", 1.42, of="counter"),
                Row("west", ("counter", "counter", "cabinet"), start=(3.6, 4.0), optional=True),
                Standing("table", (0.42, 0.40, 0.56, 0.54)),
                Around("chair", "table", (4, 6)),
                Rug("rug", "table"),
                Against("cabinet", ("south", "east"), (0.3, 1.0)),
                Against("cabinet", ("east", "south"), (0.0, 1.0), optional=True),
                Against("shelf", ("west", "south"), (0.1, 0.6)),
                Against("stool", ("south", "east"), optional=True),
                Corner("armchair", ("south-east",), optional=True),
                Against("bin", ("west", "east"), (0.6, 0.95), optional=True),
                Corner("plant", ("south-east", "south-west"), optional=True),
                OnTop("microwave", "counter"),
                Hanging("picture", 1.45, walls=("south", "west", "east")),
            ),
        ),
        RoomPart(
            width=(7.2, 7.8),
            holes=(
                Hole("window", "south", (0.26, 0.36), 1.6, 1.3, 0.9),
                Hole("window", "east", (0.3, 0.4), 1.6, 1.3, 0.9),
                Hole("window", "north", (0.7, 0.8), 1.2, 1.2, 1.0),
            ),
            rules=(
                Either(
                    (
                        Against("sofa", ("north",), (0.3, 0.6)),
                        Standing("sofa", (0.46, 0.56, 0.56, 0.66), (0.0, 180.0), 0.0),
                    )
                ),
                Before("coffee_table", "sofa", (0.42, 0.55)),
                Rug("rug", "coffee_table"),
                Around("armchair", "coffee_table", (1, 2), (0.35, 0.5)),
                Row("east", ("shelf", "cabinet", "shelf"), start=(3.8, 4.2)),
                Standing("table", (0.68, 0.18, 0.78, 0.26), yaws=(0.0, 90.0)),
                Around("chair", "table", (2, 4)),
                Against("table", ("north", "west"), (0.05, 0.3), optional=True),
                Around("chair", "table", (1, 1), optional=True),
                Against("bed", ("south", "west"), (0.0, 0.45), optional=True),
                Against("cabinet", ("south", "north"), (0.1, 0.9)),
                Against("cabinet", ("west", "south"), (0.0, 0.5), optional=True),
                Against("shelf", ("west", "north"), (0.0, 0.9)),
                Corner("armchair", ("south-west",), optional=True),
                Corner("lamp", ("north-east", "north-west"), optional=True),
                Corner("plant", ("north-west", "south-east")),
                Corner("plant", ("north-east", "south-west"), optional=True),
                Corner("lamp", ("south-west", "south-east"), optional=True),
                Hanging("picture", 1.45, walls=("north", "west")),
                Hanging("picture", 1.45, walls=("north", "east")),
            ),
        ),
    ),
    depth=(7.5, 8.0),
    floors=("wood", "tile", "light_wood", "parquet"),
    walls=("plaster", "paint_white", "wallpaper_flowers", "paint_blue"),
    pool=FIRE_POOL,
    things=TEST_THINGS,
    anywhere=True,
)
