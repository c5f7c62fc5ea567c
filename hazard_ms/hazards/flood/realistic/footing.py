"""Robots that moving water throws over (Warp).

    F d / 2 >= N b / 2          F = min(rho Cd w d u^2 / 2, mu N),   N = (m - rho w^2 d) g

d is the depth, u the speed of the water, w the width of the robot, an upright watertight box, and b the width of its
stance. The drag acts at half the depth and the lift in the middle of the stance. One that slides at a steady speed is
dragged by mu N, so it falls where the water is deeper than b / mu. Afloat, N = 0, it keels over: robots are top-heavy
[ours]. Limits: it is stiff and does not lean against the water.
"""

from __future__ import annotations

import functools

import torch
import warp as wp
from torch import Tensor

from hazard_ms.hazards.flood.realistic.basin import Basin, here
from hazard_ms.hazards.flood.wading import DRAG_COEFFICIENT
from hazard_ms.simulation.kernels.launch import OPTIONS, Launches
from hazard_ms.spec import Build

wp.set_module_options(OPTIONS)

DRAG = wp.constant(DRAG_COEFFICIENT)
STEADY = wp.constant(1e9)  # moment per newton of a robot that declares no stance [m]; also a time [s]


@wp.struct
class Footing:
    """The build of a robot in a liquid; the moment is that which it withstands per newton on the ground."""

    mass: float  # [kg]
    width: float  # [m]
    friction: float  # [-]
    moment: float  # [m]
    rising: float  # time until it stands up [s]
    density: float  # [kg/m^3]
    gravity: float  # [m/s^2]


@wp.func
def falls(depth: float, speed: float, build: Footing) -> bool:
    """Whether water `depth` [m] deep, `speed` [m/s] fast, throws over what stands in it; never without a stance."""
    if build.moment >= STEADY:
        return False
    wet = wp.max(depth, 0.0)
    weight = build.gravity * wp.max(build.mass - build.density * build.width * build.width * wet, 0.0)
    dragged = 0.5 * build.density * DRAG * build.width * wet * speed * speed
    return 0.5 * wet * wp.min(dragged, build.friction * weight) >= build.moment * weight


@wp.kernel
def each(build: Footing, depth: wp.array(dtype=float), speed: wp.array(dtype=float), found: wp.array(dtype=bool)):
    """Write whether water of each `depth` [m] and `speed` [m/s] throws a robot over."""
    k = wp.tid()
    found[k] = falls(depth[k], speed[k], build)


@wp.kernel
def stand(
    dt: float,
    rows: int,
    columns: int,
    build: Footing,
    basin: Basin,
    agent: wp.array(dtype=wp.vec3),
    lies: wp.array(dtype=bool),
    lain: wp.array(dtype=float),
):
    """Let agents fall, lie and stand up during `dt` [s]; those that stand up fall again if the water is as strong."""
    e = wp.tid()
    place, time = agent[e], lain[e] + dt
    if not lies[e] or time >= build.rising:
        water = here(e, place[0], place[1], rows, columns, basin)
        time = 0.0
        lies[e] = falls(water.level - place[2], wp.length(water.velocity), build)
    lain[e] = time


@functools.cache
def footing(robot: Build, density: float, gravity: float) -> Footing:
    """The build of `robot` in a liquid of `density` [kg/m^3] under `gravity` [m/s^2], as kernels take it."""
    made = Footing()
    made.mass, made.width, made.friction = robot.mass, robot.width, robot.friction
    made.moment, made.rising = min(robot.upright_moment(1.0), 1e9), min(robot.rising, 1e9)
    made.density, made.gravity = density, gravity
    return made


def topples(depth: Tensor, speed: Tensor, robot: Build, density: float, gravity: float) -> Tensor:
    """Whether water of each `depth` [m], [P], and `speed` [m/s], [P], throws over a standing robot.

    The result is bool, [P]. A robot that declares no stance never falls.
    """
    deep, fast = torch.broadcast_tensors(depth.float(), speed.float())
    found = torch.zeros(deep.shape, dtype=torch.bool, device=deep.device)
    launches, build = Launches(), footing(robot, density, gravity)
    launches.run(each, tuple(deep.shape), build, deep.contiguous(), fast.contiguous(), found)
    return found
