"""A room with a table, a shelf, a walled-in corner and things to fetch, for tests of skills in real physics."""

from __future__ import annotations

import numpy as np

from hazard_ms.skills import failures
from hazard_ms.skills.motor.walking import walk_to
from tests.worlds.arena import Arena, Box

TABLE = 0.74  # [m]
BOXES = (
    Box("table", (1.5, 0.0, TABLE / 2), (0.8, 1.2, TABLE)),
    Box("mug", (1.3, 0.0, TABLE + 0.05), (0.08, 0.08, 0.1), 0.3),
    Box("deep", (1.6, 0.1, TABLE + 0.05), (0.08, 0.08, 0.1), 0.3),
    Box("bowl", (0.8, -1.2, 0.04), (0.16, 0.16, 0.08), 0.4),
    Box("pen", (-1.0, 0.0, 0.005), (0.14, 0.01, 0.01), 0.02),
    Box("pack", (-1.0, 1.5, 0.2), (0.3, 0.3, 0.4), 3.0),
    Box("shelf", (-2.0, -1.5, 0.6), (0.3, 0.8, 1.2)),
    Box("top", (-2.0, -1.5, 1.25), (0.1, 0.1, 0.1), 0.2),
    Box("walled", (2.5, 2.5, 0.1), (0.1, 0.1, 0.2), 0.2),
    # so far from it that no arm reaches over them, however near the base comes
    Box("keep_s", (2.5, 1.7, 0.6), (1.8, 0.1, 1.2)),
    Box("keep_n", (2.5, 3.3, 0.6), (1.8, 0.1, 1.2)),
    Box("keep_w", (1.7, 2.5, 0.6), (0.1, 1.5, 1.2)),
    Box("keep_e", (3.3, 2.5, 0.6), (0.1, 1.5, 1.2)),
    Box("book", (0.0, -2.0, 0.02), (0.2, 0.3, 0.04), 0.5, target=False),
    Box("far", (-3.5, 3.0, 0.1), (0.1, 0.1, 0.2), 0.2),
)


def horizontal(arena: Arena, name: str) -> float:
    """Horizontal distance [m] from the base to the middle of a thing."""
    x, y, _ = arena.agent.base()
    place = arena.world.position[0, arena.index(name)]
    return float(np.hypot(float(place[0]) - x, float(place[1]) - y))


def walk(arena: Arena, name: str) -> bool:
    """Walk to a thing in as many walks as it takes; whether it arrived."""
    for _ in range(8):
        result = arena.run(walk_to(arena.stage, arena.index(name)))
        assert result.frames <= 100
        if result.ok or result.reason != failures.MAX_FRAMES:
            return result.ok
    return False
