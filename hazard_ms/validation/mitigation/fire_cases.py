"""Cases of portable extinguishers, E-1 to E-5 of docs/physics.md 2.7: ratings, critical rates, data sheets."""

from __future__ import annotations

import functools
from collections.abc import Iterator

from hazard_ms.hazards.case import Case, table
from hazard_ms.hazards.fire.realistic import wetting
from hazard_ms.validation.mitigation import jets

# Class A ratings that extinguishers must have at least [EN 3-7, 15.2], 13A of 9 litres of water are missed: kind and
# charge [kg] -> length of the crib [dm]
RATINGS = {("water", 6.0): 8, ("powder", 2.0): 8, ("powder", 6.0): 21, ("powder", 12.0): 43}
# Data sheets of stored-pressure ones: 2.5 gallons (9.46 l) of water in 55 s, 5 lb (2.27 kg) of powder in 14 s, 5 lb of
# carbon dioxide in 9 s, 2.5 lb (1.13 kg) of powder in 10 s; for the charges here, at the same rate
SECONDS = {"water": 34.9, "powder": 12.3, "co2": 7.9, "small_powder": 8.8}
# The same: 12 to 18 ft, 3 to 8 ft, 9 to 15 ft; their middles
THROWS = {"powder": 4.57, "co2": 1.68, "small_powder": 3.66}


def cases() -> Iterator[Case]:
    """All cases of this module."""
    for (kind, charge), rating in RATINGS.items():
        run = functools.partial(jets.rating, kind, charge)
        yield Case("E-1", f"largest crib that {charge:g} kg of {kind} put out [dm]", float(rating), 0.0, run, slow=True)
    # 0.0129 l/m^2 s without an external flux [Hansen 2012, Int. J. Wildland Fire 21, 525]; ours boils under its flames
    yield Case("E-2", "critical rate of water on what burns", 12.9, 0.15, jets.critical_rate, "g/m2 s", slow=True)
    yield from table("E-3", "discharge of {}", SECONDS, 0.15, jets.discharge, unit="s")
    yield from table("E-4", "throw of {}", THROWS, 0.2, jets.throw, unit="m")
    # from 20 C, as calculations of critical flows take it [Penney, Habibi, Cattani 2019, Fire 2, 3]
    yield Case("E-5", "heat that water takes", 2640.0, 0.03, lambda: wetting.LATENT, "kJ/kg")
