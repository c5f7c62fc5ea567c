"""The functions of the hazards' kernels, one at a time, on N bodies: for cases that are about a law, not motion."""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.simulation.kernels.launch import Launches
from hazard_ms.validation.experiments import kernel_probes

_launches = Launches()


class Immersion(NamedTuple):
    """The parts of N bodies that are under water, see hazard_ms.hazards.flood.buoyancy.Immersion."""

    fraction: Tensor  # [N]
    arm: Tensor  # [m], [N, 3]
    waterline: Tensor  # [1/m], [N]
    steepest: Tensor  # [1/m], [N]


def immersion(
    height: Tensor, slope: Tensor, rotation: Tensor, extent: Tensor, shape: Tensor, discs: bool = False
) -> Immersion:
    """Immersion of N bodies under a surface that is `height` [m], [N], above them and rises by `slope`, [N, 2].

    `rotation` is [N, 4], `extent` [m] is [N, 3], `shape` is [N]; `discs`: with cylinders as in `realistic`.
    """
    found = Immersion(*(torch.empty_like(t) for t in (height, extent, height, height)))
    kernel = kernel_probes.immersed if discs else kernel_probes.immersion
    _launches.run(kernel, (len(height),), height, slope, rotation, extent, shape, *found)
    return found


def drag(slip: Tensor, rotation: Tensor, pull: Tensor, mass: Tensor, ball: Tensor, dt: float) -> Tensor:
    """Force [N], [N, 3], of hazard_ms.simulation.kernels.drag.drag on N bodies over a step of `dt` [s].

    `slip` [m/s] and `pull` [kg/m] are [N, 3], `rotation` is [N, 4], `mass` [kg] and `ball` are [N].
    """
    force = torch.empty_like(slip)
    _launches.run(kernel_probes.drag, (len(slip),), dt, slip, rotation, pull, mass, ball, force)
    return force


def spin_drag(spin: Tensor, rotation: Tensor, extent: Tensor, mass: Tensor, density: float, dt: float) -> Tensor:
    """Torque [N m], [N, 3], of hazard_ms.simulation.kernels.drag.spin_drag on N bodies over a step of `dt` [s].

    `spin` [rad/s] and `extent` [m] are [N, 3], `rotation` is [N, 4], `mass` [kg] is [N], `density` [kg/m^3] one number.
    """
    torque = torch.empty_like(spin)
    _launches.run(kernel_probes.spin_drag, (len(spin),), dt, density, spin, rotation, extent, mass, torque)
    return torque


def slab_push(
    share: Tensor, box: Tensor, slip: Tensor, flow: Tensor, mass: Tensor, gravity: float, dt: float
) -> Tensor:
    """Force [N], [N, 3], of hazard_ms.hazards.flood.slab.push on N bodies over a step of `dt` [s].

    `share` and `mass` [kg] are [N], `box` [m] and `slip` [m/s] are [N, 3], `flow` is [N, 2], `gravity` in m/s^2.
    """
    force = torch.empty_like(slip)
    _launches.run(kernel_probes.slab_push, (len(slip),), dt, gravity, share, box, slip, flow, mass, force)
    return force
