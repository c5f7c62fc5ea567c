"""The kinds of rooms, as data."""

from __future__ import annotations

from hazard_ms.catalogue import FIRE_POOL
from hazard_ms.scenes.layout import Against, Around, Before, Corner, Hanging, Hole, Layout, OnTop, Row, Rug, Standing

KITCHEN_A = Layout(
    name="kitchen_a",
    width=(6.8, 7.4),
    depth=(5.8, 6.4),
    floors=("wood", "tile"),
    walls=("plaster", "paint_white", "paint_green", "paint_blue"),
    holes=(
        Hole("window", "north", (0.40, 0.52), 1.3, 1.15, 1.1),
        Hole("window", "east", (0.45, 0.6), 1.1, 1.2, 1.0),
        Hole("door", "south", (0.10, 0.16), 0.9, 2.05),
    ),
    rules=(
        Row("north", ("fridge", "counter", "sink", "counter", "stove")),
        Hanging("wall_cupboard", 1.42, of="counter"),
        Standing("table", (0.28, 0.40, 0.40, 0.50)),
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
    pool=FIRE_POOL,
)

LAYOUTS: dict[str, Layout] = {layout.name: layout for layout in (KITCHEN_A,)}
