"""The table of `severity`: how strong the hazards of `realistic` are. It scales the danger, never the laws.

Wind    mean speed at 10 m: a gale of Beaufort 8, 17.2 to 20.7 m/s, reached; a storm of Beaufort 10, 24.5 to 28.4 m/s;
        a hurricane of category 1 on the Saffir-Simpson scale, 33 to 42 m/s [WMO-No. 306; NOAA]. Streets of one storm
        differ: each has the share of it that its scene's wind is of the middle of the winds of its split, from two
        thirds to four thirds.
Flood   0.3, 0.5 or 1.0 m of water outside the doors, up to the calf, the knee and the waist of a person; it comes in
        as over a weir of a door's width, 0.4 b sqrt(2 g) h^1.5 at first [docs/physics.md L-28].
Fire    growth of t-squared fires: 1 MW after 300, 150, 75 s [NFPA 204: medium, fast, ultra-fast; EN 1991-1-2 annex E
        gives medium for dwellings, fast for libraries and shops, ultra-fast for theatres]; what burns at the start, and
        grows to its peak: three bags of rubbish [SFPE handbook; NUREG-1805], an upholstered chair, a wardrobe [CFAST
        fire library]. Bases are discs of the area of such a thing. Where a scene begins with several fires, they share
        growth, peak and area.
"""

from __future__ import annotations

from dataclasses import dataclass

from hazard_ms.spec.checks import one_of

SCALED = "realistic"  # the preset that severity scales
WINDS = (2.5, 5.0)  # slowest and fastest wind of a scene [m/s] [the original's shipped scenes, docs/physics.md 1.3]
MIDDLE = 0.5 * sum(WINDS)  # of these winds [m/s]
STRONGER_WINDS = {"hard": (5.0, 8.0)}  # those of scenes of other splits [m/s] [ours]
STREETS = 2.0 / 3.0, 4.0 / 3.0  # least and largest share of a storm's wind in one of its streets [-] [ours]


@dataclass(frozen=True)
class Severity:
    """The danger of each hazard."""

    wind: float  # mean speed at 10 m, in the mean over streets [m/s]
    flood_outside: float  # depth of the water outside the doors [m]
    fire_growth: float  # of the fires with which a scene begins [kW/s^2]
    fire_start: float  # their highest heat release [kW]
    fire_base: float  # diameter of the base of one that gives off so much [m] [ours]
    fire_height: float  # of what burns at the start: bags of rubbish, a chair, a wardrobe [m] [ours]


SEVERITIES = {
    "moderate": Severity(17.0, 0.3, 0.01172, 350.0, 0.6, 0.6),
    "severe": Severity(28.0, 0.5, 0.0469, 2100.0, 0.9, 0.9),
    "extreme": Severity(40.0, 1.0, 0.1876, 4500.0, 1.0, 1.8),
}
USUAL = "severe"


def usual_wind(split: str) -> float:
    """The middle of the winds that scenes of a `split` have [m/s]."""
    return 0.5 * sum(STRONGER_WINDS.get(split, WINDS))


def chosen(severity: str, preset: str) -> str:
    """The name of a severity, if it can be had with a preset.

    Raises ValueError for an unknown one, and for any but the usual one with a preset that has only one strength.
    """
    one_of(severity, SEVERITIES, "severity")
    if severity != USUAL and preset != SCALED:
        raise ValueError(f"severity must be {USUAL!r} for all physics but {SCALED!r}, got {severity!r}")
    return severity
