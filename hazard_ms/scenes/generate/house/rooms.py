"""The rooms of homes, as data: each as if the hall were to the south of it."""

from __future__ import annotations

from hazard_ms.scenes.generate.layout import (
    Against,
    Around,
    Before,
    Corner,
    Hanging,
    Hole,
    OnTop,
    RoomPart,
    Row,
    Rug,
    Standing,
)

ANY = (0.0, 0.0)  # the width of a room is that of its column

KITCHEN = RoomPart(
    width=ANY,
    holes=(Hole("window", "north", (0.40, 0.60), 1.2, 1.15, 1.1),),
    rules=(
        Row("north", ("fridge", "counter", "stove", "sink")),
        Standing("table", (0.42, 0.42, 0.60, 0.52), optional=True),
        Around("chair", "table", (1, 3), optional=True),
        Against("cabinet", ("east", "west", "south"), (0.0, 1.0)),
        Against("bin", ("west", "east"), (0.3, 1.0), optional=True),
        OnTop("microwave", "counter"),
        Hanging("picture", 1.45, walls=("south", "west", "east")),
    ),
)
LIVING_ROOM = RoomPart(
    width=ANY,
    holes=(
        Hole("door", "north", (0.18, 0.22), 0.95, 2.05),  # to the garden
        Hole("window", "north", (0.64, 0.70), 1.4, 1.3, 0.9),
    ),
    rules=(
        Against("sofa", ("north", "west", "east"), (0.3, 0.7)),
        Before("coffee_table", "sofa", (0.42, 0.55), optional=True),
        Rug("rug", "coffee_table"),
        Against("shelf", ("west", "east"), (0.1, 0.9)),
        Against("cabinet", ("west", "east", "south"), (0.0, 1.0)),
        Corner("armchair", ("north-east", "north-west"), optional=True),
        Corner("lamp", ("north-east", "north-west"), optional=True),
        Corner("plant", ("south-west", "south-east"), optional=True),
        Hanging("picture", 1.45, walls=("west", "east")),
    ),
)
BEDROOM = RoomPart(
    width=ANY,
    holes=(Hole("window", "north", (0.3, 0.7), 1.2, 1.2, 1.0),),
    rules=(
        Against("bed", ("north", "west", "east"), (0.0, 1.0)),
        Against("cabinet", ("west", "east", "south"), (0.0, 1.0)),
        Against("shelf", ("west", "east", "north"), (0.0, 1.0), optional=True),
        Against("stool", ("south", "east"), optional=True),
        Corner("lamp", ("north-east", "north-west"), optional=True),
        Hanging("picture", 1.5, walls=("south", "west")),
    ),
)
STUDY = RoomPart(
    width=ANY,
    holes=(Hole("window", "north", (0.35, 0.65), 1.3, 1.2, 1.0),),
    rules=(
        Against("table", ("north", "west", "east"), (0.2, 0.8)),
        Around("chair", "table", (1, 1), optional=True),
        Against("shelf", ("west", "east"), (0.0, 1.0)),
        Against("shelf", ("south", "east", "west"), (0.0, 1.0), optional=True),
        Corner("armchair", ("north-east", "north-west"), optional=True),
        Corner("plant", ("south-west", "south-east"), optional=True),
        Hanging("picture", 1.5, walls=("south", "east")),
    ),
)
BATHROOM = RoomPart(
    width=ANY,
    holes=(Hole("window", "north", (0.4, 0.6), 0.6, 0.8, 1.4),),
    rules=(
        Against("sink", ("west", "east"), (0.4, 1.0)),
        Against("cabinet", ("west", "east"), (0.0, 1.0)),
        Against("stool", ("north",), optional=True),
        Corner("plant", ("north-east", "north-west"), optional=True),
    ),
)
STORE = RoomPart(
    width=ANY,
    holes=(),
    rules=(
        Against("shelf", ("west", "east"), (0.0, 1.0)),
        Against("shelf", ("west", "east", "north"), (0.0, 1.0)),
        Against("cabinet", ("north", "west", "east"), (0.0, 1.0), optional=True),
    ),
)

ROOMS = {
    "kitchen": KITCHEN,
    "living_room": LIVING_ROOM,
    "bedroom": BEDROOM,
    "study": STUDY,
    "bathroom": BATHROOM,
    "store": STORE,
}
