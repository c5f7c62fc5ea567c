"""An agent in moving water: how dangerous it is to people, and how firmly a robot stands (torch).

Hazard classes H1 to H6: the worst of three rules on depth times speed, speed and depth (Australian Rainfall and Runoff
2019, AIDR guideline 7-3). The robot is an upright watertight box, of the mass, width and friction that its build tells;
grip = 1 - drag / (friction x (weight - lift)), between 0 and 1.

`realistic` has friction hold a robot until the water slides it, at u = sqrt(2 mu N / (rho Cd w d)), with N the weight
less the lift, w the width and d the depth. Where it falls over: hazard_ms.hazards.flood.realistic.footing.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.spec import Build

CLASSES = (  # class, and what it begins above: depth x speed [m^2/s], speed [m/s], depth [m] [docs/physics.md 3.2]
    (2, 0.3, torch.inf, 0.3),
    (3, torch.inf, torch.inf, 0.5),
    (4, 0.6, torch.inf, 1.2),
    (5, 1.0, 2.0, 2.0),
    (6, 4.0, 4.0, 4.0),
)


DRAG_COEFFICIENT = 1.1  # drag coefficient of an upright box in water [-] [docs/physics.md 3.2]
LEAST_HOLD = 1e-6  # force of friction below which a robot is afloat [N]


def hazard_class(depth: Tensor, speed: Tensor) -> Tensor:
    """Hazard class to people in water of `depth` [m] and `speed` [m/s], int64, [...]: 1 to 6 for H1 to H6, 0 if dry."""
    found = (depth > 0).long()
    for number, product, fast, deep in CLASSES:
        worse = (depth * speed > product) | ((speed > fast) & (depth > 0)) | (depth > deep)
        found = torch.where(worse, number, found)
    return found


def traction(depth: Tensor, robot: Build, density: float) -> Tensor:
    """Share of the robot's weight that is left on the floor at `depth` [m], [...]: 1 on dry ground, 0 afloat."""
    return (1 - density * robot.width**2 * depth.clamp(min=0) / robot.mass).clamp(0, 1)


def grip(depth: Tensor, speed: Tensor | float, robot: Build, density: float, gravity: float) -> Tensor:
    """Share of its own motion that the robot keeps, [...]: 1 if it stands firm, 0 if it is carried along.

    The water is `depth` [m], [...], deep and flows at `speed` [m/s], [...].
    """
    wet = robot.width * depth.clamp(min=0)
    dragged = 0.5 * density * DRAG_COEFFICIENT * wet * speed * speed
    held = robot.friction * robot.mass * gravity * traction(depth, robot, density)
    return (1 - dragged / held.clamp(min=LEAST_HOLD)).clamp(0, 1)


def sliding_speed(depth: Tensor, robot: Build, density: float, gravity: float) -> Tensor:
    """Speed of water `depth` [m], [...], deep that overcomes the friction of a standing robot [m/s], [...].

    Infinite on dry ground, 0 afloat.
    """
    held = robot.friction * robot.mass * gravity * traction(depth, robot, density)
    return (2.0 * held / (density * DRAG_COEFFICIENT * robot.width * depth.clamp(min=0))).sqrt()
