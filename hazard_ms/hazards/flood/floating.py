"""Push of water with a sloping surface on turned bodies, stable in steps of any length (Warp).

    lift      rho g V f upwards, at the middle of the immersed part (f, the middle: hazard_ms.hazards.flood.buoyancy)
    drag      quadratic, per face, on the share f of each face, at the same point; and of turning
              (hazard_ms.simulation.kernels.drag)
    damping   by waves: 2 zeta sqrt(rho g A m) of heaving at a waterline A, and the same rate of turning
    inertia   net force, and torque of lift and drag, are divided by 1 + Ca rho V f / m: some of the water moves along

The lift of a body that floats acts as a spring. In a step too long for it, X = (rho g A / m) dt^2 > 1, the net of lift
and weight is divided by X: then lift moves nothing farther than to its level, and where a body floats does not change.
Drag and damping are implicit. Order: 1, as PhysX's own. Limits: no waves, no pressure gradient along the slope, no
water inside hollow things.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.flood.buoyancy import BALL, CYLINDER, FILLS, Immersion
from hazard_ms.simulation.kernels.boxes import face_areas, spans
from hazard_ms.simulation.kernels.drag import drag, spin_drag
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

_TINY = wp.constant(1e-9)  # least mass [kg], so that 0 / 0 cannot occur
_DISC = wp.constant(FILLS[CYLINDER])  # share of its square that a disc fills


@wp.struct
class Liquid:
    """The fields of hazard_ms.hazards.flood.water.Water, as one argument of kernels."""

    density: float
    gravity: float
    damping: float
    added_mass: float


@wp.struct
class Body:
    """One body in the water, world frame."""

    velocity: wp.vec3  # [m/s]
    spin: wp.vec3  # angular velocity [rad/s]
    axes: wp.mat33
    extent: wp.vec3  # edges [m]
    mass: float  # [kg]
    volume: float  # volume of water that the wholly immersed body displaces [m^3]
    shape: int  # BOX, CYLINDER or BALL
    drag_coefficient: float  # [-]


@wp.struct
class Push:
    """Force and torque of the water on one body over the next step."""

    force: wp.vec3  # [N], world frame
    torque: wp.vec3  # torque about the centre [N m], world frame


@wp.func
def areas(extent: wp.vec3, shape: int) -> wp.vec3:
    """Areas [m^2] of a body's outlines along its axes; those of balls, and of the ends of cylinders, are discs."""
    faces = face_areas(extent)
    if shape == BALL:
        return _DISC * faces
    if shape == CYLINDER:
        return wp.vec3(faces[0], faces[1], _DISC * faces[2])
    return faces


@wp.func
def push(liquid: Liquid, body: Body, wet: Immersion, flow: wp.vec3, height: float, dt: float) -> Push:
    """Force and torque of water on a body over the next `dt` [s].

    Args:
        liquid: Properties of the water.
        body: The body and its motion.
        wet: The part of the body that is under water.
        flow: Velocity of the water [m/s], world frame.
        height: Height of the surface above the body's centre [m].
        dt: Length of the physics step [s].
    """
    made = Push()
    if wet.fraction <= 0.0:  # a dry body near the water is in air
        return made
    density, gravity, m = liquid.density, liquid.gravity, wp.max(body.mass, _TINY)
    step, weight = dt / m, m * gravity
    displaced = body.volume * density / m  # of the wholly immersed body, in units of its own mass
    afloat, soaked = displaced * wet.fraction, density * wet.fraction
    lift, carried = weight * afloat, 1.0 + liquid.added_mass * afloat
    stiff = float(1.0)
    if _near(body.axes, body.extent, displaced * gravity * dt * dt, height):
        stiff = wp.max(displaced * wet.steepest * gravity * dt * dt, 1.0)
    net = (lift - weight) / (stiff + (carried - 1.0))
    pull = areas(body.extent, body.shape) * (0.5 * body.drag_coefficient * soaked)
    change = wp.vec3(body.axes[2, 0], body.axes[2, 1], body.axes[2, 2]) * (-net * step)
    dragged = drag(flow - body.velocity, body.axes, pull, m * carried, dt, body.shape == BALL, change) / carried
    rate = 2.0 * liquid.damping * wp.sqrt(displaced * wet.waterline * gravity)
    heaving = body.velocity[2] + dragged[2] * step  # after the drag: together they never reverse a motion
    made.force = dragged + wp.vec3(0.0, 0.0, net + weight - heaving * m * rate / (1.0 + rate * dt))
    lifted = dragged * carried + wp.vec3(0.0, 0.0, lift / stiff)
    slowed = spin_drag(body.spin, body.axes, body.extent, m, soaked, dt, rate)
    made.torque = wp.cross(wet.arm, lifted) / carried + slowed
    return made


@wp.func
def _near(axes: wp.mat33, extent: wp.vec3, rise: float, height: float) -> bool:
    """Whether the surface cuts the body now, or could within the step, in which lift moves it by up to `rise` [m]."""
    return wp.abs(height) <= 0.5 * spans(axes, extent)[2] + rise
