"""The room between robots of a team: whether what one is about to do brings its arm to another's body or arm."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.simulation.robot import Robot
from hazard_ms.skills.context import Stage
from hazard_ms.skills.motor.surface import OTHERS_TOP

APART = 2.5  # distance of two bases beyond which arms cannot meet: both are 1.1 m long at most [m] [ours]
AHEAD = 4  # frames that are looked ahead: a hand moves by up to 0.08 m in each, and needs two to stop [ours]
GAP = 0.15  # room that an arm's middle keeps to a base and to another arm's middle; arms are 0.12 m thick [m] [ours]
TUCKED = 0.1  # joints that are all this close to those of the tucked arm leave it within the base [rad] [ours]
SPACING = 5  # points on each link of an arm that are looked at [ours]


def along(joints: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points on the lines between `joints`, [P, 3] [m], and these themselves, [N, 3]."""
    shares = np.linspace(0.0, 1.0, SPACING)[:, None, None]
    between = joints[:-1] + shares * (joints[1:] - joints[:-1])
    return np.asarray(between.reshape(-1, 3))


def gap(points: NDArray[np.float64], other: Robot) -> float:
    """Smallest distance [m] of `points`, [N, 3] [m], world frame, from a robot's base and from its arm's middle."""
    x, y, _ = other.base()
    low = points[points[:, 2] < OTHERS_TOP]
    base = float(np.hypot(low[:, 0] - x, low[:, 1] - y).min(initial=np.inf)) - other.build.radius
    arm = along(other.arm_places(other.arm()))
    return min(base, float(np.linalg.norm(points[:, None] - arm[None], axis=-1).min()))


def would_touch(stage: Stage) -> bool:
    """Whether the last move of `stage`, gone on with, brings the robot's arm closer than GAP to another of its team."""
    robot, (x, y, heading) = stage.robot, stage.robot.base()
    near = [o for o in stage.others if np.hypot(o.base()[0] - x, o.base()[1] - y) < APART]
    if not near:
        return False
    forward, turn, arm = stage.last_move
    actual = robot.arm()
    if max(np.abs(joints - robot.tucked).max() for joints in (actual, arm)) < TUCKED:
        return False
    now = along(robot.arm_places(actual))
    step = robot.build.arm_step
    reach = actual + np.clip(arm - actual, -AHEAD * step, AHEAD * step)
    soon = along(robot.arm_places(reach)) - (x, y, 0.0)
    cos, sin = np.cos(AHEAD * turn), np.sin(AHEAD * turn)
    soon[:, :2] = soon[:, :2] @ np.array([[cos, sin], [-sin, cos]])
    soon += (x + AHEAD * forward * np.cos(heading), y + AHEAD * forward * np.sin(heading), 0.0)
    return any(gap(soon, other) < min(GAP, gap(now, other) - 1e-3) for other in near)
