"""Shapes that need no model and stand for things that the assets lack: all in a cube of edge 1, with its base at z = 0.

plain_box                          a solid box
plain_case_A-B_C-D...              a box with cavities from height A to B, C to D, ... [1/1000 of its height], open at
the front (-y)
plain_rack_A-B_C-D...              the same, open at the back, too
"""

from __future__ import annotations

import re
from collections.abc import Iterator

PREFIX = "plain_"
NAME = re.compile(r"plain_(box|(case|rack)((?:_\d{1,4}-\d{1,4}){1,12}))")
WALL = 0.015  # thickness of sides and back [of the width and depth] [ours]
MASS = 100.0  # of a cube of edge 1 m [kg]: furniture is mostly air [ours]
PARTS = 1000  # of the height, in names

WOOD, STEEL, WHITE, BRASS, DARK = (
    (0.36, 0.22, 0.11),
    (0.46, 0.47, 0.48),
    (0.70, 0.69, 0.66),
    (0.52, 0.36, 0.10),
    (0.04, 0.04, 0.05),
)
COLOURS = {  # of what is nearly always of one colour, linear red, green, blue [ours]
    **dict.fromkeys(("cabinet", "shelf", "bookshelf", "coaster", "bottle_cork"), WOOD),
    **dict.fromkeys(
        ("stove", "dishwasher", "water_faucet", "fork", "carving_fork", "spoon", "knife", "scissors", "pot", "pan"),
        STEEL,
    ),
    **dict.fromkeys(("microwave", "microwave_oven", "phone", "headphone"), DARK),
    **dict.fromkeys(("radiator", "toothbrush"), WHITE),
    "coin": BRASS,
}

Box = tuple[float, float, float, float, float, float]  # centre and half size


def name_of(kind: str, cavities: list[tuple[float, float]]) -> str:
    """The name of a `case` or `rack` with cavities between heights [of its own height]; of a box if there are none."""
    spans = [(round(low * PARTS), round(high * PARTS)) for low, high in cavities]
    return f"{PREFIX}{kind}" + "".join(f"_{low}-{high}" for low, high in spans) if spans else f"{PREFIX}box"


def boxes_of(name: str) -> tuple[Box, ...]:
    """The boxes that make up the shape called `name`. Raises ValueError for unknown names."""
    found = NAME.fullmatch(name)
    if found is None:
        raise ValueError(
            f"a shape must look like plain_box, plain_case_100-500 or plain_rack_0-300_320-980, got {name!r:.100}"
        )
    if found[2] is None:
        return ((0.0, 0.0, 0.5, 0.5, 0.5, 0.5),)
    edges = [int(v) for v in re.split("[_-]", found[3].lstrip("_"))]
    if edges != sorted(set(edges)) or edges[-1] > PARTS:
        raise ValueError(f"heights of cavities must rise and be at most {PARTS}, got {name!r}")
    return tuple(_hollow([v / PARTS for v in edges], closed=found[2] == "case"))


def _hollow(edges: list[float], closed: bool) -> Iterator[Box]:
    solid = [0.0, *edges, 1.0]
    for low, high in zip(solid[::2], solid[1::2], strict=True):
        if high > low:
            yield 0.0, 0.0, (low + high) / 2, 0.5, 0.5, (high - low) / 2
    for low, high in zip(edges[::2], edges[1::2], strict=True):
        middle, half = (low + high) / 2, (high - low) / 2
        for side in (-1.0, 1.0):
            yield side * (0.5 - WALL / 2), 0.0, middle, WALL / 2, 0.5, half
        if closed:
            yield 0.0, 0.5 - WALL / 2, middle, 0.5 - WALL, WALL / 2, half


def colour(category: str) -> tuple[float, float, float]:
    """The colour of a category: linear red, green, blue, 0 to 1."""
    if category in COLOURS:
        return COLOURS[category]
    code = sum((i + 1) * ord(letter) for i, letter in enumerate(category))
    low, high = 0.12, 0.62
    return tuple(low + (high - low) * (code * step % 97) / 96 for step in (29, 53, 71))  # type: ignore[return-value]
