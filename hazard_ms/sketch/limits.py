"""The levels of hazards from which they damage a target, as agents are told of them."""

from __future__ import annotations

from hazard_ms.hazards.base import Hazard
from hazard_ms.sensing.target_table import Target
from hazard_ms.spec.catalogue import CATEGORIES

STEPS = 24  # halvings of a range, after which a limit is known to a millionth of it


def limit_of(hazard: Hazard, category: str, height: float) -> float:
    """The level, in its unit, from which `hazard` damages a target of `category` at `height` [m]; or infinity.

    A higher level is never less of a threat. The limit is sought in up to 10 times the usual range of the level.
    """
    target = _told(category)
    low, high = hazard.level.low, hazard.level.low + 10.0 * (hazard.level.high - hazard.level.low)
    if not hazard.threatens(target, high, height):
        return float("inf")
    for _ in range(STEPS):
        middle = (low + high) / 2
        low, high = (low, middle) if hazard.threatens(target, middle, height) else (middle, high)
    return high


def _told(category: str) -> Target:
    """What agents are told of a target of a category."""
    row = CATEGORIES[category]
    return Target(
        index=-1,
        name=category,
        category=category,
        value=float(row.value),
        flammable=row.flammable,
        waterproof=row.waterproof,
        ignition_temperature=row.ignition_temperature,
    )
