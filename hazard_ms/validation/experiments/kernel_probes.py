"""Kernels that are one law each, for validation (Warp); their arguments: hazard_ms.validation.experiments.probes."""

from __future__ import annotations

import warp as wp

from hazard_ms.hazards.flood import buoyancy, slab
from hazard_ms.hazards.flood.realistic import cylinders
from hazard_ms.simulation.kernels import drag as drags
from hazard_ms.simulation.kernels.boxes import axes_of
from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)


@wp.kernel
def immersion(
    height: wp.array(dtype=float),
    slope: wp.array(dtype=wp.vec2),
    rotation: wp.array(dtype=wp.vec4),
    extent: wp.array(dtype=wp.vec3),
    shape: wp.array(dtype=wp.int64),
    fraction: wp.array(dtype=float),
    arm: wp.array(dtype=wp.vec3),
    waterline: wp.array(dtype=float),
    steepest: wp.array(dtype=float),
):
    """Write the immersion of every body."""
    n = wp.tid()
    found = buoyancy.immersion(height[n], slope[n], axes_of(rotation[n]), 0.5 * extent[n], int(shape[n]))
    fraction[n] = found.fraction
    arm[n] = found.arm
    waterline[n] = found.waterline
    steepest[n] = found.steepest


@wp.kernel
def immersed(
    height: wp.array(dtype=float),
    slope: wp.array(dtype=wp.vec2),
    rotation: wp.array(dtype=wp.vec4),
    extent: wp.array(dtype=wp.vec3),
    shape: wp.array(dtype=wp.int64),
    fraction: wp.array(dtype=float),
    arm: wp.array(dtype=wp.vec3),
    waterline: wp.array(dtype=float),
    steepest: wp.array(dtype=float),
):
    """Write the immersion of every body, as the preset `realistic` has it."""
    n = wp.tid()
    found = cylinders.immersed(height[n], slope[n], axes_of(rotation[n]), 0.5 * extent[n], int(shape[n]))
    fraction[n] = found.fraction
    arm[n] = found.arm
    waterline[n] = found.waterline
    steepest[n] = found.steepest


@wp.kernel
def drag(
    dt: float,
    slip: wp.array(dtype=wp.vec3),
    rotation: wp.array(dtype=wp.vec4),
    pull: wp.array(dtype=wp.vec3),
    mass: wp.array(dtype=float),
    ball: wp.array(dtype=bool),
    force: wp.array(dtype=wp.vec3),
):
    """Write the drag of every body."""
    n = wp.tid()
    force[n] = drags.drag(slip[n], axes_of(rotation[n]), pull[n], mass[n], dt, ball[n], wp.vec3())


@wp.kernel
def spin_drag(
    dt: float,
    density: float,
    spin: wp.array(dtype=wp.vec3),
    rotation: wp.array(dtype=wp.vec4),
    extent: wp.array(dtype=wp.vec3),
    mass: wp.array(dtype=float),
    torque: wp.array(dtype=wp.vec3),
):
    """Write the torque of drag on every turning body."""
    n = wp.tid()
    torque[n] = drags.spin_drag(spin[n], axes_of(rotation[n]), extent[n], mass[n], density, dt, 0.0)


@wp.kernel
def slab_push(
    dt: float,
    gravity: float,
    share: wp.array(dtype=float),
    box: wp.array(dtype=wp.vec3),
    slip: wp.array(dtype=wp.vec3),
    flow: wp.array(dtype=wp.vec2),
    mass: wp.array(dtype=float),
    force: wp.array(dtype=wp.vec3),
):
    """Write the original's lift and drag of every body."""
    n = wp.tid()
    force[n] = slab.push(share[n], box[n], slip[n], flow[n], mass[n], gravity, dt)
