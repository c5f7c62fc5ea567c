"""Drag of oriented boxes and balls in a flow: quadratic, per face, implicit. For any fluid; nothing here knows water or air.

    along each axis i of the body    F_i = rho Cd A_i |s_i| s_i / 2 / (1 + k_i |s_i| dt),   k_i = rho Cd A_i / (2 m)
    turning about it                 T_i = -c_i |w_i| w_i / (1 + c_i |w_i| dt / I_i),       c_i = rho b_i (b_j^4 + b_k^4) / 64

s = flow - velocity is the slip, A_i the area of the face across the axis, b the edges. F is the exact mean of quadratic drag over a
step of constant flow: no step is too long, no body too light, and the slip never changes its sign. With other forces at work, s_i
(not |s_i|) is the slip that they would leave at the end of the step. T is the box form of MuJoCo's
inertia model (its documentation, "Fluid forces"). Limits: no lift, no shading of one body by another.

Vectors come with their components first, [3, ...], as `planes` makes them of [..., 3]: five times faster on a CPU than components last.
"""

from __future__ import annotations

import torch
from torch import Tensor

_NOTHING = 1e-12  # [kg], [kg m^2]: keeps 0 / 0 away where there is no body


def planes(vector: Tensor) -> Tensor:
    """[..., 3] with its components first: [3, ...]."""
    return vector.movedim(-1, 0).contiguous()


def rows(vector: Tensor) -> Tensor:
    """[3, ...] with its components last: [..., 3]."""
    return vector.movedim(0, -1).contiguous()


def axes_of(rotation: Tensor) -> Tensor:
    """Rotation matrices [3, 3, ...] of unit quaternions [..., 4]; [:, i] is axis i of the body in the world frame."""
    parts = rotation.movedim(-1, 0).contiguous()
    own = parts[1:]
    w, x, y, z = (2 * parts).unbind()
    (wx, wy, wz), (xx, xy, xz) = (w * own).unbind(), (x * own).unbind()
    (_, yy, yz), zz = (y * own).unbind(), z * own[2]
    entries = [1 - (yy + zz), xy - wz, xz + wy, xy + wz, 1 - (xx + zz), yz - wx, xz - wy, yz + wx, 1 - (xx + yy)]
    return torch.stack(entries).unflatten(0, (3, 3))


def to_body(axes: Tensor, vector: Tensor) -> Tensor:
    """World-frame vectors [3, ...] along the body's own axes; `axes` as `axes_of` gives them."""
    x, y, z = (axes * vector[:, None]).unbind()
    return (x + y).add_(z)


def to_world(axes: Tensor, vector: Tensor) -> Tensor:
    """Vectors along the body's own axes, [3, ...], in the world frame."""
    x, y, z = (axes * vector).unbind(1)
    return (x + y).add_(z)


def face_areas(extent: Tensor) -> Tensor:
    """Areas [m^2] of a box's faces across its axes, [3, ...], from its edges [m], [3, ...]."""
    x, y, z = extent.unbind()
    return torch.stack([y * z, x * z, x * y])


def drag(
    slip: Tensor, axes: Tensor, pull: Tensor, mass: Tensor, dt: float, ball: Tensor | None = None, change: Tensor | None = None
) -> Tensor:
    """Mean drag [N] over the next `dt` [s], world frame, [3, ...].

    Args:
        slip: Velocity of the fluid relative to the body [m/s], world frame, [3, ...].
        axes: The body's axes, [3, 3, ...], see `axes_of`.
        pull: rho Cd A / 2 of the faces across the axes [kg/m], [3, ...]: of their wet part, where only a part is in the fluid.
        mass: [kg], [...]; zero where there is no body.
        dt: Length of the physics step [s].
        ball: Bodies, bool [...], that are dragged straight along the slip: the speed is that of the whole slip, not of one axis.
        change: Of the slip by all other forces within the step [m/s], own axes, [3, ...]; where it is given, a body that falls
            through the fluid ends at its true terminal velocity, however long the step.
    """
    along = to_body(axes, slip)
    speed = along.abs()
    if ball is not None:
        x, y, z = (along * along).unbind()
        speed = torch.where(ball, (x + y).add_(z).sqrt_(), speed)
    push = speed.mul_(pull)
    if change is not None:
        along = along.add_(change)
    return to_world(axes, (push * along).div_((push * (dt / mass.clamp(min=_NOTHING))).add_(1)))


def spin_drag(
    spin: Tensor, axes: Tensor, extent: Tensor, mass: Tensor, density: Tensor | float, dt: float, rate: Tensor | float = 0.0
) -> Tensor:
    """Mean torque [N m], world frame, [3, ...], by which a fluid slows the turning of boxes of homogeneous mass.

    Args:
        spin: Angular velocity [rad/s], world frame, [3, ...].
        axes: The body's axes, [3, 3, ...], see `axes_of`.
        extent: Edges [m], [3, ...].
        mass: [kg], [...]; zero where there is no body.
        density: Of the fluid [kg/m^3], a number or [...]: times the part of the body that is in it.
        dt: Length of the physics step [s].
        rate: Of linear damping besides [1/s], a number or [...].
    """
    inertia, turning = turning_of(extent, mass)
    return spin_drag_of(to_body(axes, spin), axes, inertia, turning, density, dt, rate)


def turning_of(extent: Tensor, mass: Tensor) -> tuple[Tensor, Tensor]:
    """Moments of inertia [kg m^2] of boxes, and their drag of turning over the fluid's density [m^5]; about their axes, [3, ...]."""
    squared = extent * extent
    inertia = _of_others(squared).mul_(mass / 12).clamp_(min=_NOTHING)
    return inertia, _of_others(squared * squared).mul_(extent).mul_(1 / 64)


def spin_drag_of(
    turn: Tensor, axes: Tensor, inertia: Tensor, turning: Tensor, density: Tensor | float, dt: float, rate: Tensor | float
) -> Tensor:
    """As `spin_drag`, from the angular velocity along the body's own axes [rad/s], [3, ...], and what `turning_of` gives."""
    slowing = (turn.abs() * turning).mul_(density).div_(inertia).add_(rate)  # [1/s]
    return to_world(axes, (turn * inertia).mul_(slowing).div_((slowing * -dt).sub_(1)))


def _of_others(amount: Tensor) -> Tensor:
    """For each of three axes, the sum over the two others, [3, ...]."""
    x, y, z = amount.unbind()
    return torch.stack([y + z, x + z, x + y])
