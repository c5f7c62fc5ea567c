"""The push of water with a sloping surface on turned bodies: lift, drag, damping, added mass; stable in steps of any length.

    lift      rho g V f upwards, at the middle of the immersed part (f, the middle: hazard_ms.kernels.buoyancy)
    drag      quadratic, per face, on the share f of each face, at the same point; and of turning (hazard_ms.kernels.drag)
    damping   by waves: 2 zeta sqrt(rho g A m) of heaving at a waterline A, and the same rate of turning
    inertia   what the water does is divided by 1 + Ca rho V f / m, the share of the water that moves along

The lift of a body that floats acts as a spring. In a step too long for it, X = (rho g A / m) dt^2 > 1, the net of lift and weight is
divided by X: then lift moves nothing farther than to its level, and where a body floats does not change. Drag and damping are
implicit. Order: 1, as PhysX's own. Limits: no waves, no pressure gradient along the slope, no water inside hollow things.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.kernels.boxes import face_areas, spans
from hazard_ms.kernels.buoyancy import BALL, CYLINDER, FILLS, Immersion
from hazard_ms.kernels.drag import drag, spin_drag
from hazard_ms.launching import OPTIONS

wp.set_module_options(OPTIONS)

_NOTHING = wp.constant(1e-9)  # [kg] keeps 0 / 0 away where there is no body
_DISC = wp.constant(FILLS[CYLINDER])  # share of its square that a disc fills


@wp.struct
class Push:
    """What water does over the next step."""

    force: wp.vec3  # [N], world frame
    torque: wp.vec3  # about the centre [N m], world frame


@wp.func
def areas(extent: wp.vec3, shape: int) -> wp.vec3:
    """Areas of a body's outlines along its axes [m^2]: discs of balls, and at the ends of cylinders."""
    faces = face_areas(extent)
    if shape == BALL:
        return _DISC * faces
    if shape == CYLINDER:
        return wp.vec3(faces[0], faces[1], _DISC * faces[2])
    return faces


@wp.func
def push(
    water: wp.vec4,
    velocity: wp.vec3,
    spin: wp.vec3,
    axes: wp.mat33,
    extent: wp.vec3,
    mass: float,
    volume: float,
    shape: int,
    drag_coefficient: float,
    wet: Immersion,
    flow: wp.vec3,
    height: float,
    dt: float,
) -> Push:
    """What water does to a body of which `wet` is immersed, over the next `dt` [s].

    Args:
        water: Density [kg/m^3], gravity [m/s^2], damping and added mass [-], see Water.
        velocity: [m/s], world frame.
        spin: [rad/s], world frame.
        axes: The body's axes.
        extent: Edges [m].
        mass: [kg].
        volume: Of water that it displaces wholly immersed [m^3].
        shape: BOX, CYLINDER or BALL.
        drag_coefficient: [-].
        wet: What is under water.
        flow: Velocity of the water [m/s].
        height: Of the surface above the body's centre [m].
        dt: [s].
    """
    made = Push()
    if wet.fraction <= 0.0:  # a dry body near the water is in air
        return made
    density, gravity, m = water[0], water[1], wp.max(mass, _NOTHING)
    step, weight = dt / m, m * gravity
    displaced = volume * density / m  # of the wholly immersed body, in units of its own mass
    afloat, soaked = displaced * wet.fraction, density * wet.fraction
    lift, carried = weight * afloat, 1.0 + water[3] * afloat
    stiff = float(1.0)
    if _near(axes, extent, displaced * gravity * dt * dt, height):
        stiff = wp.max(displaced * wet.steepest * gravity * dt * dt, 1.0)
    net = (lift - weight) / (stiff + (carried - 1.0))
    pull = areas(extent, shape) * (0.5 * drag_coefficient * soaked)
    change = wp.vec3(axes[2, 0], axes[2, 1], axes[2, 2]) * (-net * step)
    dragged = drag(flow - velocity, axes, pull, m * carried, dt, shape == BALL, change) / carried
    rate = 2.0 * water[2] * wp.sqrt(displaced * wet.waterline * gravity)
    heaving = velocity[2] + dragged[2] * step  # after the drag: together they never reverse a motion
    made.force = dragged + wp.vec3(0.0, 0.0, net + weight - heaving * m * rate / (1.0 + rate * dt))
    lifted = dragged + wp.vec3(0.0, 0.0, lift / stiff)
    made.torque = wp.cross(wet.arm, lifted) + spin_drag(spin, axes, extent, m, soaked, dt, rate)
    return made


@wp.func
def _near(axes: wp.mat33, extent: wp.vec3, rise: float, height: float) -> bool:
    """Whether the surface cuts the body now, or lift could bring it there within the step, by `rise` [m]."""
    return wp.abs(height) <= 0.5 * spans(axes, extent)[2] + rise
