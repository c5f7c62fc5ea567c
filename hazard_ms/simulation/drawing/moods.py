"""The light of each kind of place at each time of the day, as numbers."""

from __future__ import annotations

import zlib
from typing import NamedTuple

from hazard_ms.spec import SceneSpec, Vec3


class Mood(NamedTuple):
    """The light of one kind of place at one time of the day.

    Colours are linear red, green and blue in SAPIEN's units. All values are [ours].
    """

    toward: Vec3  # direction in which the light of sun, moon or windows travels
    sun: Vec3
    lamp: Vec3  # of each lamp that is on
    lit: float  # share of the lamps that are on
    ambient: Vec3 = (0.0, 0.0, 0.0)
    pane: Vec3 = (0.0, 0.0, 0.0)  # light that shines through windows
    air: Vec3 = (1.0, 1.0, 1.0)  # light on haze, smoke, water and flying things, as a share of that of a bright day
    sky: str = ""  # asset of the sky that lights scenes in the open instead of `ambient`


INDOORS = {
    "day": Mood((0.4, 0.6, -1.0), (0.90, 0.87, 0.80), (2.0, 1.9, 1.7), 1.0, (0.45, 0.44, 0.42), (0.55, 0.70, 0.85)),
    "evening": Mood(
        (0.9, 0.5, -0.7),
        (0.30, 0.16, 0.07),
        (4.2, 2.8, 1.45),
        1.0,
        (0.20, 0.16, 0.13),
        (0.30, 0.16, 0.10),
        (0.60, 0.46, 0.36),
    ),
    "night": Mood(
        (0.3, -0.6, -1.0),
        (0.020, 0.030, 0.055),
        (0.75, 0.44, 0.20),
        0.5,
        (0.030, 0.034, 0.048),
        (0.008, 0.013, 0.030),
        (0.09, 0.08, 0.08),
    ),
    "failing": Mood(
        (0.3, -0.6, -1.0),
        (0.030, 0.040, 0.065),
        (3.6, 3.3, 2.8),
        1.0,
        (0.055, 0.058, 0.065),
        (0.008, 0.013, 0.030),
        (0.20, 0.19, 0.18),
    ),
}
DAYS = {  # in the open, by sky
    "sky_day": Mood((0.38, 0.55, -0.74), (2.9, 2.7, 2.3), (0.0, 0.0, 0.0), 0.0, sky="sky_day"),
    "sky_storm": Mood((0.44, 0.63, -0.64), (0.75, 0.78, 0.80), (0.0, 0.0, 0.0), 0.0, sky="sky_storm"),
}
EVENING = Mood(
    (0.98, -0.17, -0.30), (2.6, 1.6, 0.85), (8.0, 5.1, 2.4), 1.0, air=(0.95, 0.66, 0.48), sky="sky_evening"
)  # the sun stands a little higher than in the picture of the sky, so that shadows end
MOONLIGHT = (0.41, -0.58, -0.70), (0.045, 0.060, 0.100)  # `toward` and `sun` of clear nights [ours]
NIGHTS = {
    "night": Mood(*MOONLIGHT, (20.0, 12.8, 6.4), 1.0, air=(0.060, 0.066, 0.090), sky="sky_night"),
    "failing": Mood(*MOONLIGHT, (20.0, 16.8, 12.4), 1.0, air=(0.060, 0.066, 0.090), sky="sky_night"),
}


def moods_of(spec: SceneSpec) -> dict[str, Mood]:
    """Every light that the scene of `spec` can have, by name.

    In the open some days are bright and some stormy, depending on the scene's name.
    """
    if not spec.room.open_air:
        return INDOORS
    return {"day": list(DAYS.values())[zlib.crc32(spec.name.encode()) % len(DAYS)], "evening": EVENING, **NIGHTS}
