"""The functions of the hazards' kernels, one at a time, on N bodies: for the cases that are about a law and not about motion."""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.kernels import probes
from hazard_ms.launching import Launches

_launches = Launches()


class Immersion(NamedTuple):
    """What is under water, see hazard_ms.kernels.buoyancy.Immersion."""

    fraction: Tensor  # [N]
    arm: Tensor  # [m], [N, 3]
    waterline: Tensor  # [1/m], [N]
    steepest: Tensor  # [1/m], [N]


def immersion(height: Tensor, slope: Tensor, rotation: Tensor, extent: Tensor, shape: Tensor) -> Immersion:
    """Of a surface `height` [m], [N], above bodies, that rises by `slope`, [N, 2]; rotation [N, 4], extent [m], [N, 3], shape [N]."""
    found = Immersion(*(torch.empty_like(t) for t in (height, extent, height, height)))
    _launches.run(probes.immersion, (len(height),), height, slope, rotation, extent, shape, *found)
    return found


def drag(slip: Tensor, rotation: Tensor, pull: Tensor, mass: Tensor, ball: Tensor, dt: float) -> Tensor:
    """Force [N], [N, 3], see hazard_ms.kernels.drag.drag: slip [m/s], [N, 3], pull [kg/m], [N, 3], mass [kg], [N], ball [N]."""
    force = torch.empty_like(slip)
    _launches.run(probes.drag, (len(slip),), dt, slip, rotation, pull, mass, ball, force)
    return force


def spin_drag(spin: Tensor, rotation: Tensor, extent: Tensor, mass: Tensor, density: float, dt: float) -> Tensor:
    """Torque [N m], [N, 3], see hazard_ms.kernels.drag.spin_drag: spin [rad/s], [N, 3], extent [m], [N, 3], mass [kg], [N]."""
    torque = torch.empty_like(spin)
    _launches.run(probes.spin_drag, (len(spin),), dt, density, spin, rotation, extent, mass, torque)
    return torque


def slab_push(share: Tensor, box: Tensor, slip: Tensor, flow: Tensor, mass: Tensor, gravity: float, dt: float) -> Tensor:
    """Force [N], [N, 3], see hazard_ms.kernels.slab.push: share [N], box [m], [N, 3], slip [m/s], [N, 3], flow [N, 2], mass [kg], [N]."""
    force = torch.empty_like(slip)
    _launches.run(probes.slab_push, (len(slip),), dt, gravity, share, box, slip, flow, mass, force)
    return force
