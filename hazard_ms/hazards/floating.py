"""The push of water with a sloping surface on turned bodies: lift, drag, damping, added mass; stable in steps of any length.

    lift      rho g V f upwards, at the middle of the immersed part (f, the middle: hazard_ms.hazards.buoyancy)
    drag      quadratic, per face, on the share f of each face, at the same point; and of turning (hazard_ms.hazards.drag)
    damping   by waves: 2 zeta sqrt(rho g A m) of heaving at a waterline A, and the same rate of turning
    inertia   what the water does is divided by 1 + Ca rho V f / m, the share of the water that moves along

The lift of a body that floats acts as a spring. In a step too long for it, X = (rho g A / m) dt^2 > 1, the net of lift and weight is
divided by X: then lift moves nothing farther than to its level, and where a body floats does not change. Drag and damping are
implicit. Order: 1, as PhysX's own. Limits: no waves, no pressure gradient along the slope, no water inside hollow things.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any, NamedTuple

import torch
from torch import Tensor

from hazard_ms.hazards.base import Push, nobody
from hazard_ms.hazards.buoyancy import BALL, CYLINDER, FILLS, Immersion
from hazard_ms.hazards.drag import axes_of, drag, face_areas, planes, rows, spin_drag_of, to_body, turning_of

_NOTHING = 1e-9  # [kg] keeps 0 / 0 away where there is no body


@dataclass(frozen=True)
class Water:
    """What water is like."""

    density: float = 1000.0  # [kg/m^3]
    gravity: float = 9.81  # [m/s^2]
    damping: float = 0.1  # zeta, share of the critical damping of a body that heaves or rolls [-] [physics.md L-10]
    added_mass: float = 0.0  # Ca, of the displaced mass [-]


class Fixed(NamedTuple):
    """What does not change while a body moves, along its axes, [3, ...]."""

    inertia: Tensor  # moments of inertia of its box [kg m^2]
    turning: Tensor  # drag of turning over the water's density [m^5]


@dataclass(frozen=True)
class Bodies:
    """Bodies in water; vectors with their components first, world frame."""

    velocity: Tensor  # [m/s], [3, ...]
    spin: Tensor  # [rad/s], [3, ...]
    axes: Tensor  # [3, 3, ...]
    extent: Tensor  # edges [m], [3, ...]
    mass: Tensor  # [kg], [...]
    volume: Tensor  # of water that it displaces wholly immersed [m^3], [...]
    shape: Tensor  # BOX, CYLINDER or BALL, [...]
    drag_coefficient: Tensor  # [-], [...]
    fixed: Fixed | None = None  # if known: else it is worked out at every push

    @classmethod
    def of(cls, velocity: Tensor, spin: Tensor, rotation: Tensor, extent: Tensor, **others: Any) -> Bodies:
        """From tensors with their components last, [..., 3] and [..., 4], and the `others` as they are."""
        return cls(planes(velocity), planes(spin), axes_of(rotation), planes(extent), **others)


def areas(extent: Tensor, shape: Tensor) -> Tensor:
    """Areas of a body's outlines along its axes [m^2], [3, ...]: discs of balls, and at the ends of cylinders."""
    return face_areas(extent).mul_(_outlines(shape.device)[:, shape])


@functools.lru_cache(maxsize=8)
def _outlines(device: torch.device) -> Tensor:
    """Share of its face that an outline fills, by axis and shape, [3, 3]."""
    disc = FILLS[CYLINDER]
    return torch.tensor([[1.0, 1.0, disc], [1.0, 1.0, disc], [1.0, disc, disc]], device=device)


def push(water: Water, bodies: Bodies, wet: Immersion, flow: Tensor, height: Tensor, dt: float) -> Push:
    """What water that flows with `flow` [m/s], [3, ...], does to bodies of which `wet` is immersed over the next `dt` [s].

    `height`: of the surface above the bodies' centres [m], [...]. Force [N] and torque [N m] with components last, [..., 3].
    """
    mass = bodies.mass.clamp(min=_NOTHING)
    fixed = bodies.fixed or Fixed(*turning_of(bodies.extent, mass))
    displaced = (bodies.volume * water.density).div_(mass)  # of a wholly immersed body, in units of its own mass
    fraction, step = wet.fraction, dt / mass
    afloat, soaked = displaced * fraction, fraction * water.density
    weight = mass * water.gravity
    lift = weight * afloat
    carried = (afloat * water.added_mass).add_(1) if water.added_mass else 1.0
    stiff = _stiff(water, bodies, displaced, wet, height, dt)
    net = (lift - weight).div_(stiff + (carried - 1))
    ball = bodies.shape == BALL
    change = bodies.axes[2] * (net * -step)
    slip, pull = flow - bodies.velocity, areas(bodies.extent, bodies.shape).mul_(bodies.drag_coefficient * soaked).mul_(0.5)
    dragged = drag(slip, bodies.axes, pull, mass * carried, dt, ball, change).div_(carried)
    rate = (displaced * wet.waterline).mul_(water.gravity).sqrt_().mul_(2 * water.damping)
    heaving = (dragged[2] * step).add_(bodies.velocity[2])  # after the drag: together they never reverse a motion
    force = dragged.clone()
    force[2].add_(net).add_(weight).sub_(heaving.mul_(mass).mul_(rate).div_((rate * dt).add_(1)))
    force.mul_(fraction > 0)  # a dry body near the water is in air
    turning = spin_drag_of(to_body(bodies.axes, bodies.spin), bodies.axes, fixed.inertia, fixed.turning, soaked, dt, rate)
    dragged[2].add_(lift.div_(stiff))
    return Push(rows(force), rows(torch.linalg.cross(wet.arm, dragged, dim=0).add_(turning)))


def _stiff(water: Water, bodies: Bodies, displaced: Tensor, wet: Immersion, height: Tensor, dt: float) -> Tensor | float:
    """By what the net of lift and weight is divided, at least 1, [...]."""
    stiff = (displaced * wet.steepest).mul_(water.gravity * dt * dt)
    if nobody(stiff > 1):
        return 1.0
    return stiff.mul_(_near(water, bodies, displaced, height, dt)).clamp_(min=1)


def _near(water: Water, bodies: Bodies, displaced: Tensor, height: Tensor, dt: float) -> Tensor:
    """Bodies that the surface cuts now, or that lift could bring there within the step, bool [...]."""
    x, y, z = (bodies.axes[2] * bodies.extent).abs_().unbind()
    return height.abs() <= (x + y).add_(z).div_(2).add_(displaced, alpha=water.gravity * dt * dt)
