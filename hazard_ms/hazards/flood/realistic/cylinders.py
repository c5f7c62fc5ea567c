"""The part of a body that is under water, with cylinders on their side cut into discs (Warp).

hazard_ms.hazards.flood.buoyancy cuts cylinders into columns, which is up to 1.7 % of the volume wrong where one lies.
Here the part of a disc under the surface is a segment of a circle, which is exact for a cylinder that lies level.
Tilted ones are the sum over discs at Gauss-Legendre nodes along the axis. Columns serve where the axis is steeper than
the radius.
"""

from __future__ import annotations

import math

import numpy as np
import warp as wp

from hazard_ms.hazards.flood.buoyancy import CYLINDER, Immersion, immersion
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

DISCS = wp.constant(4)  # discs of a cylinder [ours]
_nodes, _weights = np.polynomial.legendre.leggauss(4)
_PLACES = wp.constant(wp.vec4(*_nodes))  # where they are along the axis, from -1 to 1
_SHARES = wp.constant(wp.vec4(*(0.5 * _weights)))  # of the volume
_PI = wp.constant(math.pi)
_THIN = wp.constant(1e-6)  # least span [m] and fraction [-], so that 0 / 0 cannot occur


@wp.func
def immersed(height: float, slope: wp.vec2, axes: wp.mat33, half: wp.vec3, shape: int) -> Immersion:
    """The part of a body that is under a plane surface; the arguments are those of buoyancy.immersion."""
    if shape == CYLINDER:
        upward = wp.cw_mul(wp.vec3(-slope[0], -slope[1], 1.0) * axes, half)
        if upward[0] * upward[0] + upward[1] * upward[1] > upward[2] * upward[2]:
            return _discs(height, upward, axes, half)
    return immersion(height, slope, axes, half, shape)


@wp.func
def _discs(height: float, upward: wp.vec3, axes: wp.mat33, half: wp.vec3) -> Immersion:
    """Immersion of a cylinder, as the sum of its discs; `upward`: how far above the surface its axes' ends lead [m]."""
    radius = wp.max(wp.sqrt(upward[0] * upward[0] + upward[1] * upward[1]), _THIN)
    fraction, beside, along, cut = float(0.0), float(0.0), float(0.0), float(0.0)
    for k in range(DISCS):
        level = wp.clamp((height - upward[2] * _PLACES[k]) / radius, -1.0, 1.0)
        chord = wp.sqrt(1.0 - level * level)
        under = 1.0 - (wp.acos(level) - level * chord) / _PI
        fraction += _SHARES[k] * under
        along += _SHARES[k] * under * _PLACES[k]
        beside -= _SHARES[k] * chord * chord * chord
        cut += _SHARES[k] * chord
    beside = beside * (2.0 / (3.0 * _PI))  # segments of discs lie below their centres
    middle = wp.vec3(beside * upward[0] / radius, beside * upward[1] / radius, along)
    found = Immersion()
    found.fraction = fraction
    found.arm = axes * wp.cw_mul(middle / wp.max(fraction, _THIN), half)
    found.waterline = cut * 2.0 / (_PI * radius)
    found.steepest = 2.0 / (_PI * radius)
    return found
