"""The wind that carries a robot off or throws it over.

    slides   w = sqrt(2 mu m g / (rho Cd A))      the drag of the air is the most that wheels or soles can hold
    topples  w = sqrt(m g b / (rho Cd A h))       its moment about an edge of the stance is that of the weight

b is the width of the stance and h the height at which the drag acts [docs/physics.md 3.3].
"""

from __future__ import annotations

import math

from hazard_ms.hazards.wind.air import DENSITY
from hazard_ms.spec import Build

GRAVITY = 9.81  # [m/s^2]


def sweeping_speed(robot: Build) -> float:
    """Speed of the air [m/s] at which a standing robot begins to slide."""
    return math.sqrt(2.0 * robot.friction * robot.mass * GRAVITY / (DENSITY * robot.drag_area))


def toppling_speed(robot: Build) -> float:
    """Speed of the air [m/s] at which a robot that stands upright falls over; infinite for one that cannot."""
    moment = robot.upright_moment(robot.mass * GRAVITY)
    return math.sqrt(2.0 * moment / (DENSITY * robot.drag_area * robot.drag_height))
