"""Sizes of the original's models, and their substitutes: models of ours of the same kind and size, or plain shapes.

Sizes come from models.json, which names its source and licence. A model that is not in it gets the usual size of its
category.
"""

from __future__ import annotations

import functools
import json
import math
import statistics
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from hazard_ms.scenes.assets import primitives
from hazard_ms.scenes.assets.index import asset, asset_ids
from hazard_ms.scenes.original.things import Thing
from hazard_ms.spec import Vec3
from hazard_ms.spec.catalogue import CATEGORIES

TABLE = Path(__file__).with_name("models.json")
UNKNOWN_SIZE: Vec3 = (0.2, 0.2, 0.2)  # of a model of a category that the table lacks [m] [ours]
UNKNOWN_CATEGORY = "box"
DISTORTION = 2.2  # a model whose scales along its axes differ by more looks wrong: a plain box is better [ours]
SIMILAR = {  # categories whose models may stand for a thing, too, after its own
    "cabinet": ("counter",),
    "table": ("coffee_table",),
    "dining_table": ("table", "coffee_table"),
    "microwave_oven": ("microwave",),
    "framed_picture": ("picture",),
}
HOLDING = ("table", "coffee_table", "dining_table", "cabinet")
# heights from which a surface is a top [of the height], and its area at least [of the footprint] [ours]
TOP_SURFACE = (0.98, 0.8)
# baskets must be hollow; shelves get boards where the original has them
NEVER_USED = ("basket_1", "shelf_1", "shelf_2", "shelf_3")
ALWAYS_USED = ("cart",)  # a model however distorted: things must fit into it
RACKS = ("shelf", "bookshelf")
WORKTOP = "counter_top"  # ends the names of worktops, which stand around what is below them
RIM_HEIGHT = 0.03  # at most [m] [ours]
BOARD_THICKNESS = 0.02  # thickness of the boards of hollow furniture [m] [ours]
LOWEST_CAVITY = 0.1  # [m] [ours]


@dataclass(frozen=True)
class StandIn:
    """A substitute for a thing: an asset, turned about the vertical, scaled to the thing's size."""

    asset: str
    yaw: float  # of the asset's frame in the thing's [degrees]
    scale: Vec3


@functools.lru_cache(maxsize=1)
def _table() -> tuple[dict[str, tuple[str, Vec3, float]], dict[str, dict[str, Vec3]]]:
    data = json.loads(TABLE.read_text(encoding="utf-8"))
    models = {name: (category, (x, z, y), float(factor)) for name, category, x, y, z, factor, _ in data["models"]}
    return models, data["rooms"]


def room_box(name: str) -> tuple[Vec3, Vec3] | None:
    """Size, and middle of the floor, of a room of the original [m], on its axes; None if the table lacks it."""
    room = _table()[1].get(name)
    return None if room is None else (tuple(room["size"]), tuple(room["centre"]))  # type: ignore[return-value]


def size_of(thing: Thing) -> tuple[Vec3, str]:
    """Edge lengths along the thing's own axes, ours [m], and a note if they are a guess."""
    sx, sy, sz = thing.scale
    note = ""
    if thing.name in _table()[0]:
        _, size, factor = _table()[0][thing.name]
        k = thing.scale_factor / factor
    else:
        size, k = _usual_size(thing.category), 1.0
        note = f"the model {thing.name!r} is not in the table: it gets the usual size of {thing.category!r}"
    return (size[0] * k * sx, size[1] * k * sz, size[2] * k * sy), note


@functools.lru_cache(maxsize=256)
def _usual_size(published: str) -> Vec3:
    sizes = [size for category, size, _ in _table()[0].values() if category == published]
    if not sizes:
        return UNKNOWN_SIZE
    x, y, z = (statistics.median(s[k] for s in sizes) for k in range(3))
    return x, y, z


@functools.lru_cache(maxsize=256)
def category_of(published: str) -> tuple[str, str]:
    """Our category for the original's, and a note if there is none."""
    slug = published.split(",")[0].strip().replace(" ", "_").lower()
    same = [c.name for c in CATEGORIES.values() if c.published == published]
    if same:
        return (slug if slug in same else same[0]), ""
    if slug in CATEGORIES:
        return slug, ""
    return UNKNOWN_CATEGORY, f"the category {published!r} is not in the catalogue: it becomes {UNKNOWN_CATEGORY!r}"


def stand_in(thing: Thing, category: str, size: Vec3, holds: Iterable[float]) -> StandIn:
    """The substitute for `thing`; `holds`: heights above its base at which other things stand in it [m]."""
    hollow = (size[0], size[1], _top(thing, size[2]))
    cavities = _cavities(thing, category, hollow, sorted(holds))
    if cavities:
        kind = "rack" if category in RACKS or thing.name.endswith(WORKTOP) else "case"
        return _turned(
            primitives.name_of(kind, cavities), hollow, across=size[0] < size[1] and category in RACKS, behind=True
        )
    best = _nearest_model(
        category, size, topped=any(f > TOP_SURFACE[0] * size[2] for f in thing.floors) and category in HOLDING
    )
    return StandIn("plain_box", 0.0, size) if best is None else best


def _nearest_model(category: str, size: Vec3, topped: bool) -> StandIn | None:
    """The model that is distorted least; `topped`: things stand on it, up to its corners."""
    furniture = CATEGORIES[category].kind == "fixture"
    names = [n for c in (category, *SIMILAR.get(category, ())) for n in asset_ids(category=c) if n not in NEVER_USED]
    names = [n for n in names if not topped or _has_top(n)]
    found = [_turned(n, size, across, furniture) for n in names for across in (False, True)]
    best = min(found, key=_distortion, default=None)
    return best if best is not None and (_distortion(best) <= DISTORTION or category in ALWAYS_USED) else None


def _has_top(name: str) -> bool:
    """Whether things can stand nearly everywhere on a model."""
    a = asset(name)
    tops = [(s.max[0] - s.min[0]) * (s.max[1] - s.min[1]) for s in a.supports if s.z >= TOP_SURFACE[0] * a.extent[2]]
    return max(tops, default=0.0) >= TOP_SURFACE[1] * a.extent[0] * a.extent[1]


def _distortion(s: StandIn) -> float:
    return max(s.scale) / min(s.scale)


def _turned(name: str, size: Vec3, across: bool, behind: bool) -> StandIn:
    """`across`: the asset's width along the thing's depth.

    `behind`: our furniture faces -y, the original's its forward axis, +y.
    """
    x, y, z = asset(name).extent
    width, depth = (size[1], size[0]) if across else (size[0], size[1])
    return StandIn(name, (90.0 if across else 0.0) + (180.0 if behind else 0.0), (width / x, depth / y, size[2] / z))


def _top(thing: Thing, height: float) -> float:
    """The height of hollow furniture up to where things stand on it [m].

    A rim above that, as of shelves, would be in them.
    """
    return max((f for f in thing.floors if height - RIM_HEIGHT < f <= height), default=height)


def _cavities(thing: Thing, category: str, size: Vec3, holds: list[float]) -> list[tuple[float, float]]:
    """Where furniture is hollow, in parts of its height: above each floor in it, if anything stands in it."""
    if thing.name.endswith(WORKTOP):
        return [(0.0, 0.95)]
    if not holds and category not in RACKS:
        return []
    inner = size[2] - BOARD_THICKNESS
    floors = sorted(f for f in thing.floors if 0.0 <= f < inner - LOWEST_CAVITY)
    if not floors:
        return []
    if holds and holds[0] < floors[0] - BOARD_THICKNESS:
        floors.insert(0, max(holds[0], 0.0))
    kept = [floors[0]]
    kept += [f for f, below in zip(floors[1:], floors, strict=False) if f - below > LOWEST_CAVITY]
    tops = [f - BOARD_THICKNESS for f in kept[1:]] + [inner]
    return [
        (low / size[2], top / size[2])
        for low, top in zip(kept, tops, strict=True)
        if math.floor((top - low) * 1000) > 0
    ]
