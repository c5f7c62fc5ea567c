"""The wind that carries a robot off (torch).

    w = sqrt(2 mu m g / (rho Cd A))

At this speed the drag of the air on a robot is the most that its wheels or soles can hold [docs/physics.md 3.3].
"""

from __future__ import annotations

import math

from hazard_ms.hazards.wind.air import DENSITY
from hazard_ms.spec import Build

GRAVITY = 9.81  # [m/s^2]


def sweeping_speed(robot: Build) -> float:
    """Speed of the air [m/s] at which a standing robot begins to slide."""
    return math.sqrt(2.0 * robot.friction * robot.mass * GRAVITY / (DENSITY * robot.drag_area))
