"""What moving air does to a box: the kernels of wind.

    F = K |s| s / (1 + K |s| dt / m),   K = c rho A,   s = flow - velocity

the mean over a step of dt of the exact solution for a free body: it never overshoots the flow, however light the body (physics.md
W-5, W-17). `c` is 1 in the paper (F1 = rho A v^2), Cd / 2 in aerodynamics. The original's explicit step K |s| s, held at the force that
stops the slip within the step, is kept for comparison. Vectors come with their components first, [3, E, B]: see hazard_ms.hazards.drag.
"""

from __future__ import annotations

import torch
from torch import Tensor

from hazard_ms.hazards.drag import face_areas

DENSITY = 1.225  # of air [kg/m^3] [HAZARD wind_utils.py:8; ISA, sea level, 15 C]
LEADING = 0.2  # of an edge's length: how far the centre of pressure is ahead; slanting plates: 0.3 (1 - sin angle) (Joessel) [ours]
_NOTHING = 1e-9  # keeps 0 / 0 away [m/s], [kg], [m^2]


def slip_along(felt: Tensor, heading: Tensor, velocity: Tensor) -> tuple[Tensor, Tensor]:
    """How fast air passes bodies along the wind only [m/s], [E, B], signed, and the wind's direction, [3, E, 1].

    `felt` speed [m/s], [E, B]; `heading`: unit vectors, [E, 2]; `velocity` [m/s], [3, E, B].
    """
    x, y = heading[:, :1], heading[:, 1:]
    return felt - velocity[0] * x - velocity[1] * y, torch.stack([x, y, torch.zeros_like(x)])


def slip_all(felt: Tensor, heading: Tensor, velocity: Tensor) -> tuple[Tensor, Tensor]:
    """As `slip_along`, for the whole relative velocity: its magnitude, and its direction, [3, E, B]."""
    x, y, z = felt * heading[:, :1] - velocity[0], felt * heading[:, 1:] - velocity[1], -velocity[2]
    speed = (x * x + y * y + z * z).sqrt()
    return speed, torch.stack([x, y, z]) / speed.clamp(min=_NOTHING)


def drag(slip: Tensor, strength: Tensor, mass: Tensor, dt: float, implicit: bool) -> Tensor:
    """Mean force [N] along the slip [m/s] over a step of `dt`, all [E, B]; `strength` K [kg/m], `mass` [kg]."""
    rate, mass = strength * slip.abs(), mass.clamp(min=_NOTHING)
    if implicit:
        return rate * slip / (1.0 + rate * (dt / mass))
    return slip * torch.minimum(rate, mass / dt)


def projected_area(across: Tensor, extent: Tensor) -> Tensor:
    """Area [m^2] of a box of `extent` [m] as seen along `across`, a direction in its own frame; [3, ...] -> [...]."""
    x, y, z = across.abs() * face_areas(extent)
    return x + y + z


def spans(axes: Tensor, extent: Tensor) -> Tensor:
    """Edges [m] of the axis-aligned boxes around boxes of `extent` [m], [3, ...]; `axes` as `drag.axes_of` gives them."""
    x, y, z = extent
    return axes[:, 0].abs() * x + axes[:, 1].abs() * y + axes[:, 2].abs() * z


def pressure_arm(across: Tensor, extent: Tensor) -> Tensor:
    """Torque per newton along `across` [m], own frame, [3, ...]: the force acts upwind of the centre, so plates turn broadside on.

    A cube or a face seen squarely feels none.
    """
    (x, y, z), (u, v, w) = -LEADING * extent * across, across
    return torch.stack([y * w - z * v, z * u - x * w, x * v - y * u])


def sideways(heading: Tensor, vector: Tensor) -> Tensor:
    """The level unit vectors `heading`, [E, 2], times `vector`, [E, 3, B] (cross product): at right angles to the heading."""
    hx, hy = heading[:, :1], heading[:, 1:]
    x, y, z = vector.unbind(1)
    return torch.stack([hy * z, -hx * z, hx * y - hy * x], 1)
