"""The water of the HAZARD challenge's code: a slab of each thing's bounding box is immersed, and drag is linear.

    lift  400 g V_slab          the original's impulse 4 g V per frame of 0.01 s
    drag  200 A (flow - v)      its impulse 2 A (u - v) per frame; A: height of the box times its width across the flow

So the original's water has 0.4 of water's density, on the box along the world's axes (physics.md 0.1, 1.2). At the centre of mass: nothing
turns. A step never takes more than the whole slip, and lift is limited as in hazard_ms.hazards.floating: the original's could blow up.
Vectors: components first, see hazard_ms.hazards.drag.
"""

from __future__ import annotations

import torch
from torch import Tensor

LIFT = 400.0  # effective density of water [kg/m^3] [C object.py:277]
DRAG = 200.0  # force per area and slip [N s/m^3] [C object.py:281-290]

_NOTHING = 1e-9  # [m], [kg]


def slab(axes: Tensor, extent: Tensor) -> Tensor:
    """Edges of the bounding boxes along the world's axes [m], [3, ...]."""
    return axes[:, 0].abs() * extent[0] + axes[:, 1].abs() * extent[1] + axes[:, 2].abs() * extent[2]


def immersed_share(level: Tensor, base: Tensor, height: Tensor) -> Tensor:
    """Share of the slab's `height` [m] above its `base` [m] that is under the `level` [m], 0 to 1, [...]."""
    return ((level - base) / height.clamp(min=_NOTHING)).clamp(0, 1)


def push(share: Tensor, box: Tensor, slip: Tensor, flow: Tensor, mass: Tensor, gravity: float, dt: float) -> Tensor:
    """Force of the water [N], [3, ...].

    Args:
        share: Of the box that is immersed, [...].
        box: Edges along the world's axes [m], [3, ...].
        slip: Velocity of the water relative to the body [m/s], [3, ...].
        flow: Direction in which it flows, along x or y for the most part, [2, ...].
        mass: [kg], [...].
        gravity: [m/s^2].
        dt: Length of the physics step [s].
    """
    mass = mass.clamp(min=_NOTHING)
    base = box[0] * box[1]
    across = box[0] * flow[1].abs() + box[1] * flow[0].abs()
    grip = torch.where(share > 0, DRAG * box[2] * across, 0.0)
    force = slip * torch.minimum(grip, mass / dt)
    stiff = LIFT * gravity * base * dt * dt / mass
    lift, weight = LIFT * gravity * base * box[2] * share, mass * gravity
    limited = (lift - weight) / stiff.clamp(min=1) + weight
    force[2] += torch.where(share > 0, limited, 0.0)
    return force
