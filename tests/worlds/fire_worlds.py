"""Rooms for the tests of fire: those that `hazard-ms validate` uses, too."""

from hazard_ms.validation.experiments.fire_room import (
    FAR,
    ORIGINAL,
    about_z,
    begin,
    begin_without_spread,
    one_source,
    repeat,
    room_world,
    run,
    updates,
)

__all__ = [
    "FAR",
    "ORIGINAL",
    "about_z",
    "begin",
    "begin_without_spread",
    "one_source",
    "repeat",
    "room_world",
    "run",
    "updates",
]
