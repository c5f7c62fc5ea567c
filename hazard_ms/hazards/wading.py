"""An agent in moving water: how dangerous it is to people, and how firmly a wheeled robot stands.

Hazard classes H1 to H6: the worst of three rules on depth times speed, speed and depth (Australian Rainfall and Runoff 2019, AIDR
guideline 7-3). The robot: an upright box of water-tight base; grip = 1 - drag / (friction x (weight - lift)), between 0 and 1.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

CLASSES = (  # number of the class from which on: depth x speed [m^2/s], speed [m/s], depth [m]; physics.md 3.2
    (2, 0.3, torch.inf, 0.3),
    (3, torch.inf, torch.inf, 0.5),
    (4, 0.6, torch.inf, 1.2),
    (5, 1.0, 2.0, 2.0),
    (6, 4.0, 4.0, 4.0),
)


@dataclass(frozen=True)
class Wader:
    """The robot as water meets it [physics.md 3.2]."""

    mass: float = 115.0  # [kg]
    width: float = 0.51  # of its square base [m]
    friction: float = 0.6  # of its wheels [-]
    drag_coefficient: float = 1.1  # [-]


def hazard_class(depth: Tensor, speed: Tensor) -> Tensor:
    """1 to 6 for H1 to H6, 0 on dry ground; `depth` [m], `speed` [m/s], [...]: int64 [...]."""
    found = (depth > 0).long()
    for number, product, fast, deep in CLASSES:
        worse = (depth * speed > product) | ((speed > fast) & (depth > 0)) | (depth > deep)
        found = torch.where(worse, number, found)
    return found


def traction(depth: Tensor, wader: Wader, density: float) -> Tensor:
    """Share of the robot's weight that is left on its wheels at `depth` [m], [...]: 1 on dry ground, 0 afloat."""
    return (1 - density * wader.width**2 * depth.clamp(min=0) / wader.mass).clamp(0, 1)


def grip(depth: Tensor, speed: Tensor | float, wader: Wader, density: float, gravity: float) -> Tensor:
    """Share of its own motion that the robot keeps in a flow of `speed` [m/s], `depth` [m], [...]: 1 firm, 0 carried along."""
    wet = wader.width * depth.clamp(min=0)
    dragged = 0.5 * density * wader.drag_coefficient * wet * speed * speed
    held = wader.friction * wader.mass * gravity * traction(depth, wader, density)
    return (1 - dragged / held.clamp(min=1e-6)).clamp(0, 1)
