"""Portable fire extinguishers: what they hold, how long and how far they throw it, and what it does to a fire.

Water and powder are a film on what burns. As much of each as covers a square metre follows from the ratings of EN 3-7,
class A: an extinguisher rated nA puts out a crib of n dm length, of 7 layers of 5 sticks along it and 7 layers of n
sticks of 0.5 m across it, each 39 mm thick: a surface of 1.09 n m^2. Powder of 2, 6 and 12 kg is rated 8A, 21A and 43A
at least, 0.23 to 0.26 kg/m^2. Water has to be boiled away, too, and 6 litres are rated 8A.
"""

from __future__ import annotations

from typing import NamedTuple

CRIB = (
    4 * 0.039 * (7 * 5 * 0.1 + 7 * 0.5)
)  # surface of a class A crib per decimetre of its length [m^2] [EN 3-7 annex I]


class Extinguisher(NamedTuple):
    """A portable extinguisher."""

    agent: str  # what it throws
    charge: float  # [kg]
    seconds: float  # how long the charge lasts [s]
    reach: float  # of the jet [m]
    angle: float  # half of the jet's opening [rad]
    film: float  # that covers a burning surface [kg/m^2]; 0: it leaves none
    boils: bool  # heat takes the film away
    smothers: float  # flux that keeps flames from burning while it lasts [kg/m^2 s]

    @property
    def rate(self) -> float:
        """Discharge [kg/s]."""
        return self.charge / self.seconds


# Times are more than the least of EN 3-7: 6 s up to 3 kg, 9 s up to 6 kg. Reaches: data sheets of stored-pressure ones,
# 5 lb powder 12 to 18 ft and 14 s, 2.5 gallons water 30 to 40 ft and 55 s, 5 lb CO2 3 to 8 ft and 9 s. Half of the
# opening of the jets: [ours]. CO2 of 2 kg puts out a pan of 34 litres of heptane, 1.07 m^2 [EN 3-7 34B], so needs
# 0.22 / 1.07 kg/m^2 s; powder of 2 kg one of 144B [EN 3-7: 4.5 m^2]; water none.
EXTINGUISHERS = {
    "water": Extinguisher("water", 6.0, 33.0, 6.0, 0.06, 0.25, True, float("inf")),
    "powder": Extinguisher("ABC powder", 2.0, 12.0, 4.5, 0.12, 0.24, False, 0.04),
    "co2": Extinguisher("carbon dioxide", 2.0, 9.0, 2.0, 0.2, 0.0, False, 0.21),
    # 2.5 lb powder: 8 to 10 s, 9 to 15 ft; it weighs 2 kg, which an arm of G1 carries
    "small_powder": Extinguisher("ABC powder", 1.0, 9.0, 3.7, 0.12, 0.24, False, 0.04),
}
