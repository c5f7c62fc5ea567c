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

import functools

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
    first, second, twice = _products(rotation.device)
    parts = rotation.movedim(-1, 0)
    made = parts[first] * (parts * twice.view(2, *[1] * parts.dim())).flatten(0, 1)[second]
    made = made[:9] + made[9:]
    made[::4] += 1
    return made.unflatten(0, (3, 3))


@functools.lru_cache(maxsize=8)
def _products(device: torch.device) -> tuple[Tensor, Tensor, Tensor]:
    """Indices of 18 pairs of factors from a quaternion, and from it twice and minus twice; the same at every call."""
    w, x, y, z = range(4)
    pairs = (((y, -y), (x, y), (x, z)), ((x, y), (x, -x), (y, z)), ((x, z), (y, z), (x, -x)))
    others = (((z, -z), (w, -z), (w, y)), ((w, z), (z, -z), (w, -x)), ((w, -y), (w, x), (y, -y)))
    made = [pair for part in (pairs, others) for row in part for pair in row]
    first = [a for a, _ in made]
    second = [b if b > 0 else 4 - b for _, b in made]  # x, y, z are not 0, so the sign can stand for minus twice
    return torch.tensor(first, device=device), torch.tensor(second, device=device), torch.tensor([2.0, -2.0], device=device)


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
    x, y, z = extent
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
        change: Of the slip by all other forces within the step [m/s], world frame, [3, ...]; where it is given, a body that falls
            through the fluid ends at its true terminal velocity, however long the step.
    """
    along = to_body(axes, slip)
    speed = along.abs()
    if ball is not None:
        x, y, z = (along * along).unbind()
        speed = torch.where(ball, (x + y).add_(z).sqrt_(), speed)
    push = speed.mul_(pull)
    if change is not None:
        along = along + to_body(axes, change)
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
    turn = to_body(axes, spin)
    squared = extent * extent
    fourth = squared * squared
    inertia = (mass / 12 * _of_others(squared)).clamp(min=_NOTHING)
    slowing = density / 64 * extent * _of_others(fourth) * turn.abs() + rate * inertia
    return to_world(axes, -slowing * turn / (1 + slowing * dt / inertia))


def _of_others(amount: Tensor) -> Tensor:
    """For each of three axes, the sum over the two others, [3, ...]."""
    x, y, z = amount
    return torch.stack([y + z, x + z, x + y])
