"""The pressure of the air from which a thing at rest slides, whichever way round it stands.

    p = friction g m / (K rho A),   K = gain, times Cd / 2 where shapes count,   A = height x diagonal

a square of the wind's speed, after the share of it that a thing feels. Limits: it neither tumbles nor rolls; the
logarithmic profile and the lift of `realistic` are left out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

from hazard_ms.hazards.wind.air import DENSITY
from hazard_ms.scenes.assets.index import asset, asset_ids
from hazard_ms.simulation.building import FRICTION
from hazard_ms.spec.catalogue import CATEGORIES, IMMOVABLE

if TYPE_CHECKING:
    from hazard_ms.hazards.wind.wind import Wind

GRAVITY = 9.81  # [m/s^2]


def endurance(mass: float, extent: Sequence[float], strength: float, felt: float) -> float:
    """The pressure [m^2/s^2] for a thing of `mass` [kg] and edges `extent` [m], [3], upright.

    `strength`: the factor K [-] on it; `felt`: share of the wind that it feels [-]. It is inf where it feels none.
    """
    pull = strength * float(DENSITY) * extent[2] * math.hypot(extent[0], extent[1]) * felt**2
    return FRICTION * GRAVITY * mass / pull if pull > 0.0 else math.inf


@lru_cache
def of_models(law: Wind, category: str) -> tuple[float, ...]:
    """The pressure [m^2/s^2] for each model of a `category` under the `law`, lightest first."""
    kind = CATEGORIES[category]
    strength = law.gain * (0.5 * kind.drag_coefficient if law.shaped else 1.0)
    resistance = kind.wind_resistance
    if not law.resistances and resistance < IMMOVABLE:
        resistance = 0.0
    felt = 0.0 if resistance > IMMOVABLE - 1 else 1.0 / (1.0 + resistance)
    models = [asset(name) for name in asset_ids(category)]
    return tuple(sorted(endurance(model.mass, model.extent, strength, felt) for model in models))
