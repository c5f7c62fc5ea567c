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

from dataclasses import dataclass

import torch
from torch import Tensor

from hazard_ms.hazards.base import Push
from hazard_ms.hazards.buoyancy import BALL, CYLINDER, FILLS, Immersion
from hazard_ms.hazards.drag import axes_of, drag, face_areas, planes, rows, spin_drag

_NOTHING = 1e-9  # [kg] keeps 0 / 0 away where there is no body


@dataclass(frozen=True)
class Water:
    """What water is like."""

    density: float = 1000.0  # [kg/m^3]
    gravity: float = 9.81  # [m/s^2]
    damping: float = 0.1  # zeta, share of the critical damping of a body that heaves or rolls [-] [physics.md L-10]
    added_mass: float = 0.0  # Ca, of the displaced mass [-]


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

    @classmethod
    def of(cls, velocity: Tensor, spin: Tensor, rotation: Tensor, extent: Tensor, **others: Tensor) -> Bodies:
        """From tensors with their components last, [..., 3] and [..., 4], and the `others` as they are."""
        return cls(planes(velocity), planes(spin), axes_of(rotation), planes(extent), **others)


def areas(extent: Tensor, shape: Tensor) -> Tensor:
    """Areas of a body's outlines along its axes [m^2], [3, ...]: discs of balls, and at the ends of cylinders."""
    made = face_areas(extent)
    ball = shape == BALL
    made *= torch.where(ball, FILLS[CYLINDER], 1.0)
    made[2] *= torch.where(shape == CYLINDER, FILLS[CYLINDER], 1.0)
    return made


def push(water: Water, bodies: Bodies, wet: Immersion, flow: Tensor, height: Tensor, dt: float) -> Push:
    """What water that flows with `flow` [m/s], [3, ...], does to bodies of which `wet` is immersed over the next `dt` [s].

    `height`: of the surface above the bodies' centres [m], [...]. Force [N] and torque [N m] with components last, [..., 3].
    """
    mass = bodies.mass.clamp(min=_NOTHING)
    displaced = water.density * bodies.volume / mass  # of a wholly immersed body, in units of its own mass
    carried = 1 + water.added_mass * displaced * wet.fraction
    stiff = torch.where(_near(water, bodies, displaced, wet, height, dt), displaced * wet.steepest * (water.gravity * dt * dt), 0.0)
    stiff = stiff.clamp(min=1)
    lift = mass * water.gravity * displaced * wet.fraction
    weight = mass * water.gravity
    net = (lift - weight) / (stiff + carried - 1)
    pull = areas(bodies.extent, bodies.shape) * (0.5 * water.density * bodies.drag_coefficient * wet.fraction)
    slip = flow - bodies.velocity
    change = torch.zeros_like(slip)
    change[2] = -net * dt / mass
    dragged = drag(slip, bodies.axes, pull, mass * carried, dt, bodies.shape == BALL, change) / carried
    rate = 2 * water.damping * (water.gravity * displaced * wet.waterline).sqrt()
    heaving = bodies.velocity[2] + dragged[2] * dt / mass  # after the drag: together they never reverse a motion
    force = dragged.clone()
    force[2] += net + weight - mass * heaving * rate / (1 + rate * dt)
    force *= wet.fraction > 0  # a dry body near the water is in air
    turning = spin_drag(bodies.spin, bodies.axes, bodies.extent, mass, water.density * wet.fraction, dt, rate)
    dragged[2] += lift / stiff
    return Push(rows(force), rows(torch.linalg.cross(wet.arm, dragged, dim=0) + turning))


def _near(water: Water, bodies: Bodies, displaced: Tensor, wet: Immersion, height: Tensor, dt: float) -> Tensor:
    """Bodies that the surface cuts now, or that lift could bring there within the step, bool [...]."""
    tall = (bodies.axes[2] * bodies.extent).abs().sum(0) / 2
    return height.abs() <= tall + displaced * (water.gravity * dt * dt)
