"""Force and torque of moving air on a box (Warp).

    F = K |s| s / (1 + K |s| dt / m),   K = c rho A,   s = flow - velocity

the mean over a step of dt of the exact solution for a free body: it never overshoots the flow, however light the body
(docs/physics.md W-5, W-17). `c` is 1 in the paper (F1 = rho A v^2), Cd / 2 in aerodynamics. The original's explicit
step K |s| s, held at the force that stops the slip within the step, is kept for comparison.
"""

from __future__ import annotations

import warp as wp

from hazard_ms.simulation.kernels.boxes import face_areas
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

DENSITY = wp.constant(1.225)  # density of air [kg/m^3] [HAZARD wind/wind_utils.py:8; ISA, sea level, 15 C]
# How far the centre of pressure is upwind of the centre, in shares of an edge; for slanting plates Joessel measured
# 0.3 (1 - sin angle) [ours]
LEADING = wp.constant(0.2)
REFERENCE = wp.constant(10.0)  # height at which meteorologists measure wind [m]
# Depth of the layer of air that has adapted to the pavement: a tenth of the fetch of some 10 m of street behind each
# kerb [Garratt 1992: internal boundary layers grow as 0.1 of the fetch]
JOIN = wp.constant(1.0)  # [m]
# Height of the tops of the stones, on which things lie, above the zero plane of their profile, in roughness lengths:
# stones of height k have a roughness length of 0.1 k and a zero plane at 0.7 k [Garratt 1992; Oke 1987]
TOPS = wp.constant(3.0)
# Gauss-Legendre rule of four points, in half heights of a body [Abramowitz & Stegun 1964, 25.4.30]
POINTS = wp.constant(4)
NODES = wp.constant(wp.vec4(-0.8611363116, -0.3399810436, 0.3399810436, 0.8611363116))
WEIGHTS = wp.constant(wp.vec4(0.1739274226, 0.3260725774, 0.3260725774, 0.1739274226))
# Flat plates [Holmes, Letchford & Lin 2006, Investigations of plate-type windborne debris, part II]: the force is
# normal to the face, and up to an angle of STALL between face and air it grows in proportion to it, to PEAK of that on
# a plate across the wind
STALL = wp.constant(0.698132)  # 40 degrees [rad]
PEAK = wp.constant(1.71 / 1.15)
FLAT = wp.constant(0.2)  # largest thickness of a plate, in its middle edges [-] [ours]
CELL = wp.constant(0.5)  # edge of a cell of a map of shelter [m] [ours]
LOWEST = wp.constant(0.5)  # height below which fixtures shelter nothing [m] [ours]
THIN = wp.constant(1e-6)  # least half height [m], so that 0 / 0 cannot occur
_TINY = wp.constant(1e-9)  # least speed [m/s] and mass [kg], so that 0 / 0 cannot occur


@wp.func
def drag(slip: float, strength: float, mass: float, dt: float, implicit: bool) -> float:
    """Mean force [N] along the slip [m/s] over a step of `dt` [s]; `strength` K [kg/m], `mass` [kg]."""
    rate, m = strength * wp.abs(slip), wp.max(mass, _TINY)
    if implicit:
        return rate * slip / (1.0 + rate * (dt / m))
    return slip * wp.min(rate, m / dt)


@wp.func
def per_mass(rate: float, mass: float) -> float:
    """Rate [1/s] at which a pull of `rate` [kg/s] changes the speed of a `mass` [kg]."""
    return rate / wp.max(mass, _TINY)


@wp.func
def projected_area(across: wp.vec3, extent: wp.vec3) -> float:
    """Area [m^2] of a box with edges `extent` [m] as seen along `across`, a unit vector in the body frame."""
    faces = face_areas(extent)
    return wp.abs(across[0]) * faces[0] + wp.abs(across[1]) * faces[1] + wp.abs(across[2]) * faces[2]


@wp.func
def pressure_arm(across: wp.vec3, extent: wp.vec3) -> wp.vec3:
    """Torque [N m] per newton along `across`, body frame: the force acts upwind of the centre.

    So plates turn broadside on; a cube, or a face seen squarely, feels no torque.
    """
    return wp.cross(-LEADING * wp.cw_mul(extent, across), across)


@wp.func
def unit(slip: wp.vec3) -> wp.vec3:
    """Unit vector along a slip [m/s]."""
    return slip / wp.max(wp.length(slip), _TINY)


@wp.func
def plate_normal(extent: wp.vec3) -> wp.vec3:
    """Unit vector across the faces of a plate with edges `extent` [m], body frame; 0 for other shapes."""
    x, y, z = extent[0], extent[1], extent[2]
    thin = wp.min(x, wp.min(y, z))
    middle = x + y + z - thin - wp.max(x, wp.max(y, z))
    if thin > FLAT * middle:
        return wp.vec3()
    if z == thin:
        return wp.vec3(0.0, 0.0, 1.0)
    if y == thin:
        return wp.vec3(0.0, 1.0, 0.0)
    return wp.vec3(1.0, 0.0, 0.0)


@wp.func
def steepness(sine: float) -> float:
    """Force on a face over that on one across the wind, and over the `sine` of the angle between face and air."""
    steep = wp.clamp(wp.abs(sine), 1e-3, 1.0)
    angle = wp.asin(steep)
    if angle < STALL:
        return PEAK * angle / STALL / steep
    return 1.0 / steep


@wp.func
def pressure_point(across: wp.vec3, extent: wp.vec3, normal: wp.vec3) -> wp.vec3:
    """Place of the force on a plate [m] from its middle, body frame; `across`: unit vector of the air against it."""
    sine = wp.dot(across, normal)
    angle = wp.asin(wp.clamp(wp.abs(sine), 0.0, 1.0)) * 57.29578  # [degrees]
    ahead = float(0.0)
    if angle < 38.0:
        ahead = 0.3 - 0.22 * angle / 38.0
    elif angle < 82.5:
        ahead = 0.08 * wp.cos(2.0 * (angle - 38.0) / 57.29578)
    return -ahead * wp.cw_mul(extent, unit(across - sine * normal))


@wp.func
def logarithmic(height: float, roughness: float) -> float:
    """Share of the wind at 10 m that blows at `height` [m] over ground of `roughness` [m], by the logarithmic law.

    It is 0 below the height of the roughness.
    """
    return wp.log(wp.max(height, roughness) / roughness) / wp.log(REFERENCE / roughness)


@wp.func
def profile(height: float, roughness: float, pavement: float) -> float:
    """Share of the wind at 10 m that blows at `height` [m] above the ground on which things lie.

    Above JOIN it is the profile of surroundings of `roughness` [m]; below, that of a pavement of roughness `pavement`
    [m], counted from TOPS of these lengths below the ground, so that the wind on the ground itself is not 0. Without
    a pavement, 0, the profile of the surroundings goes on to the ground.
    """
    if pavement == 0.0:
        return logarithmic(height, roughness)
    raised = wp.clamp(height, 0.0, JOIN) / pavement + TOPS
    return logarithmic(wp.max(height, JOIN), roughness) * wp.log(raised) / wp.log(JOIN / pavement + TOPS)


@wp.func
def gustiness(height: float, excess: float, roughness: float) -> float:
    """Wind at `height` [m] over its mean there, in a gust that is `excess` of the mean at 10 m above it at 10 m.

    The deviation of the wind's speed is the same at all heights of the surface layer, so in shares of the mean it is
    1 / ln(z / z0) [docs/physics.md 3.3]. The air below JOIN adapts to a gust faster than the gust passes: there it is
    the share at JOIN. A lull can bring the wind to a standstill, but does not turn it.
    """
    return wp.max(1.0 + excess / logarithmic(wp.max(height, JOIN), roughness), 0.0)


@wp.func
def share(
    e: int, point: wp.vec3, corner: wp.vec2, loss: wp.array3d(dtype=float), cause: wp.array3d(dtype=float)
) -> float:
    """Share of the wind that is left at a `point` [m] of environment `e`.

    The maps `loss` and `cause` and their `corner` [m] are those of hazard_ms.hazards.wind.shelter.
    """
    x, y = int(wp.floor((point[0] - corner[0]) / CELL)), int(wp.floor((point[1] - corner[1]) / CELL))
    if x < 0 or x >= loss.shape[2] or y < 0 or y >= loss.shape[1]:
        return 1.0
    return 1.0 - loss[e, y, x] * wp.clamp(2.0 - 2.0 * point[2] / wp.max(cause[e, y, x], LOWEST), 0.0, 1.0)
