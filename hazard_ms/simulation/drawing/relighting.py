"""Other light than a scene has in training: brighter or darker, warmer or cooler, the sun from elsewhere."""

from __future__ import annotations

import math
from typing import NamedTuple

from hazard_ms.simulation.drawing.moods import Mood
from hazard_ms.spec import Vec3
from hazard_ms.spec.perturbation import amount

# most by level, 0 to 3
STOPS = (0.0, 0.25, 0.5, 1.0)  # of brightness, a stop being a factor of 2; beyond, walls are all white [-] [ours]
MIREDS = (0.0, 40.0, 80.0, 160.0)  # of colour temperature, as a quarter, half and full filter of film lights [ours]
TURNS = (0.0, math.radians(30.0), math.radians(60.0), math.radians(120.0))  # of the sun about the vertical [rad] [ours]
DRAWS = 6  # uniform numbers of a change: a direction and an amount of each of the three
SECOND_RADIATION = 0.014388  # c2 of Planck's law [m K] [CODATA 2018]
WAVELENGTHS = (610e-9, 550e-9, 465e-9)  # of red, green and blue of a display [m] [ours]
LUMINANCE = (0.2126, 0.7152, 0.0722)  # of linear red, green and blue [ITU-R BT.709]


class Change(NamedTuple):
    """The difference of a light from that of training."""

    stops: float  # of brightness; positive: brighter
    mireds: float  # millionths of 1/K by which the reciprocal colour temperature grows; positive: warmer
    turn: float  # of the sun, anticlockwise from above [rad]


def drawn(level: int, numbers: list[float]) -> Change:
    """The change of a `level`, from DRAWS uniform numbers between 0 and 1."""
    signs = [1.0 if number < 0.5 else -1.0 for number in numbers[:3]]
    most = (STOPS[level], MIREDS[level], TURNS[level])
    return Change(*(s * amount(m, share) for s, m, share in zip(signs, most, numbers[3:], strict=True)))


def relit(mood: Mood, change: Change) -> Mood:
    """The light `mood` after a `change`: its lamps, sun, panes and air, not the picture of its sky.

    Colours change by Wien's law of radiation, at the same luminance of white.
    """
    exponents = [-SECOND_RADIATION / length * change.mireds * 1e-6 for length in WAVELENGTHS]
    gains = [math.exp(e) for e in exponents]
    white = sum(weight * gain for weight, gain in zip(LUMINANCE, gains, strict=True))
    r, g, b = (2.0**change.stops * gain / white for gain in gains)

    def lit(colour: Vec3) -> Vec3:
        return r * colour[0], g * colour[1], b * colour[2]

    x, y, z = mood.toward
    c, s = math.cos(change.turn), math.sin(change.turn)
    return mood._replace(
        toward=(c * x - s * y, s * x + c * y, z),
        sun=lit(mood.sun),
        lamp=lit(mood.lamp),
        ambient=lit(mood.ambient),
        pane=lit(mood.pane),
        air=lit(mood.air),
    )
