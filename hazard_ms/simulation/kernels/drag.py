"""Drag of oriented boxes and balls in a flow, for any fluid: quadratic, per face, implicit (Warp).

    along each axis i    F_i = rho Cd A_i |s_i| s_i / 2 / (1 + k_i |s_i| dt),   k_i = rho Cd A_i / (2 m)
    turning about it     T_i = -c_i |w_i| w_i / (1 + c_i |w_i| dt / I_i),       c_i = rho b_i (b_j^4 + b_k^4) / 64

s = flow - velocity is the slip, A_i the area of the face across the axis, b the edges. F is the exact mean of quadratic
drag over a step of constant flow: no step is too long and no body too light, and the slip never changes its sign. With
other forces at work, s_i (not |s_i|) is the slip that they would leave at the end of the step. T is the box form of
MuJoCo's inertia model (its documentation, "Fluid forces"). Limits: no lift, no shading of one body by another.

The functions are for one body; `axes` is explained in hazard_ms.simulation.kernels.boxes.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.boxes import to_body
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

_TINY = wp.constant(1e-12)  # least mass [kg] and moment of inertia [kg m^2], so that 0 / 0 cannot occur


@wp.func
def drag(slip: wp.vec3, axes: wp.mat33, pull: wp.vec3, mass: float, dt: float, ball: bool, change: wp.vec3) -> wp.vec3:
    """Mean drag force [N], world frame, over a step of `dt` [s].

    Args:
        slip: Velocity of the fluid relative to the body [m/s], world frame.
        axes: Axes of the body.
        pull: rho Cd A / 2 of each face [kg/m].
        mass: Mass of the body [kg].
        dt: Length of the physics step [s].
        ball: Whether drag acts along the slip, with the speed of the whole slip instead of one axis.
        change: Change of the slip by all other forces within the step [m/s], body frame. With it, a body that falls
            through the fluid ends at its true terminal velocity, however long the step.
    """
    along = to_body(axes, slip)
    speed = wp.vec3(wp.abs(along[0]), wp.abs(along[1]), wp.abs(along[2]))
    if ball:
        whole = wp.length(along)
        speed = wp.vec3(whole, whole, whole)
    push = wp.cw_mul(speed, pull)
    held = push * (dt / wp.max(mass, _TINY)) + wp.vec3(1.0, 1.0, 1.0)
    return axes * wp.cw_div(wp.cw_mul(push, along + change), held)


@wp.func
def inertia_of(extent: wp.vec3, mass: float) -> wp.vec3:
    """Moments of inertia [kg m^2] of a homogeneous box about its axes."""
    squared = wp.cw_mul(extent, extent)
    own = _sum_of_others(squared) * (mass / 12.0)
    return wp.vec3(wp.max(own[0], _TINY), wp.max(own[1], _TINY), wp.max(own[2], _TINY))


@wp.func
def spin_drag(
    spin: wp.vec3, axes: wp.mat33, extent: wp.vec3, mass: float, density: float, dt: float, rate: float
) -> wp.vec3:
    """Mean torque [N m], world frame, by which a fluid slows a turning homogeneous box over a step of `dt` [s].

    Args:
        spin: Angular velocity [rad/s], world frame.
        axes: Axes of the body.
        extent: Edges of the box [m].
        mass: Mass of the body [kg].
        density: Density of the fluid [kg/m^3], times the immersed share of the body.
        dt: Length of the physics step [s].
        rate: Rate of an additional linear damping [1/s].
    """
    turn, inertia = to_body(axes, spin), inertia_of(extent, mass)
    squared = wp.cw_mul(extent, extent)
    # drag of turning over the density [m^5]
    across = wp.cw_mul(_sum_of_others(wp.cw_mul(squared, squared)), extent) * (1.0 / 64.0)
    fast = wp.vec3(wp.abs(turn[0]), wp.abs(turn[1]), wp.abs(turn[2]))
    slowing = wp.cw_div(wp.cw_mul(fast, across) * density, inertia) + wp.vec3(rate, rate, rate)  # [1/s]
    left = slowing * dt + wp.vec3(1.0, 1.0, 1.0)
    return -(axes * wp.cw_div(wp.cw_mul(wp.cw_mul(turn, inertia), slowing), left))


@wp.func
def _sum_of_others(amount: wp.vec3) -> wp.vec3:
    """For each of three axes, the sum over the two others."""
    return wp.vec3(amount[1] + amount[2], amount[0] + amount[2], amount[0] + amount[1])
