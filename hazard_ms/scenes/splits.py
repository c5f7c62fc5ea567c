"""The one list of all scenes: their names, the splits and families that hold them, and the scene of each name."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hazard_ms.scenes.generate import indoor, outdoor
from hazard_ms.scenes.generate.house import homes
from hazard_ms.spec import SceneSpec
from hazard_ms.spec.checks import one_of

SCENES = 25  # of every place [HAZARD, section 4.1]


@dataclass(frozen=True)
class Family:
    """Scenes of one sort: the places of each split, and the maker of a scene from its place, its name and its split."""

    places: dict[str, tuple[str, ...]]
    make: Callable[[str, str, str], SceneSpec]


HOUSES = tuple(f"house_{number:02d}" for number in range(1, 41))  # to train in
FLOODED_HOUSES = tuple(f"house_flood_{number:02d}" for number in range(1, 41))
FAMILIES: dict[str, Family] = {
    "indoor": Family(
        {
            "train": ("kitchen_a", "living_room_a", "craft_room_a"),
            "test": ("kitchen_b",),
            "large": ("flat_a",),
            "new_objects": ("kitchen_b_new",),
            "hard": ("kitchen_b_hard",),
        },
        indoor.make,
    ),
    "outdoor": Family(
        {"train": ("street", "crossing", "park"), "test": ("parking",), "hard": ("parking_hard",)}, outdoor.make
    ),
    "house": Family(
        {
            "train": HOUSES,
            "test": ("house_test_1", "house_test_2"),
            homes.HELD_OUT: ("house_held_out_1", "house_held_out_2"),
        },
        homes.make,
    ),
    "house_flood": Family(
        {
            "train": FLOODED_HOUSES,
            "test": ("house_flood_test_1", "house_flood_test_2"),
            homes.HELD_OUT: ("house_flood_held_out_1", "house_flood_held_out_2"),
        },
        homes.make,
    ),
    "gale": Family(
        {
            "train": ("street_gale", "crossing_gale"),
            "test": ("parking_gale", "park_gale"),
            "held_out": ("market_gale", "yard_gale"),
        },
        outdoor.make,
    ),
}


def families() -> tuple[str, ...]:
    """Names of the families."""
    return tuple(FAMILIES)


def split_names(family: str = "indoor") -> tuple[str, ...]:
    """Names of the splits of a family. Raises ValueError for unknown families."""
    return tuple(_family(family).places)


def scene_names(split: str, family: str = "indoor") -> tuple[str, ...]:
    """Names of the scenes of a split, "kitchen_a/00" and so on. Raises ValueError for unknown splits and families."""
    places = _family(family).places
    one_of(split, places, f"split of {family} scenes")
    return tuple(f"{place}/{n:02d}" for place in places[split] for n in range(SCENES))


def all_scene_names(family: str = "indoor") -> tuple[str, ...]:
    """Names of all scenes of a family. Raises ValueError for unknown families."""
    return tuple(name for split in split_names(family) for name in scene_names(split, family))


@functools.lru_cache(maxsize=512)
def scene(name: str) -> SceneSpec:
    """The scene called `name`, of whichever family: always the same. Raises ValueError for unknown names."""
    for family in FAMILIES:
        for split in split_names(family):
            if name in scene_names(split, family):
                return FAMILIES[family].make(name.split("/")[0], name, split)
    places = [place for f in FAMILIES.values() for split in f.places.values() for place in split]
    known = ", ".join(f"{place}/00 to {place}/{SCENES - 1:02d}" for place in places)
    raise ValueError(f"scene must be one of {known}, got {name!r}")


def spare_scene(names: Sequence[str], number: int) -> SceneSpec:
    """A scene that belongs to no split, for training: `number` from SCENES on, in one of the places of `names`.

    The places take turns. Raises ValueError for unknown names, and for the number of a scene that belongs to a split.
    """
    places = sorted({name.split("/")[0] for name in names})
    place = places[number % len(places)]
    homes = [(family, split) for family in FAMILIES.values() for split, of in family.places.items() if place in of]
    if not homes or number < SCENES:
        raise ValueError(
            f"a spare scene must have a known place and a number of at least {SCENES}, got {place}/{number}"
        )
    (family, split), *_ = homes
    return family.make(place, f"{place}/{number:02d}", split)


def _family(name: str) -> Family:
    return FAMILIES[one_of(name, FAMILIES, "family of scenes")]
