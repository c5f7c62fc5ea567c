"""Carts as an agent believes to know them: which of them count, and what lies in one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hazard_ms.sensing.detection.track import Track

# what is nearer than this to the middle of a cart, and higher, lies in its basket: that is 0.82 m long, 0.45 m wide and
# begins 0.45 m above the ground [m] [hazard_ms.simulation.containers]
BASKET_REACH, BASKET_FLOOR = 0.45, 0.4


def surest(carts: Sequence[Track], count: int) -> list[Track]:
    """The `count` of `carts` that are believed most, those of the surest detections first among equals."""
    return sorted(carts, key=lambda cart: (-cart.belief, -cart.score))[:count]


def lies_in(track: Track, carts: Sequence[Track]) -> bool:
    """Whether a thing lies in one of `carts`: it is safe there, whoever put it there."""
    x, y, z = track.sighting.position.tolist()
    return z > BASKET_FLOOR and any(
        np.hypot(x - cart.sighting.position[0], y - cart.sighting.position[1]) < BASKET_REACH for cart in carts
    )
