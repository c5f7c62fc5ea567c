"""Inverse kinematics by damped least squares: the arm joints that bring the hand to a point.

    dq = J^T (J J^T + damping^2 I)^-1 e,   e = (position error, WEIGHT x direction error)

The hand's x axis, along which its fingers point, should have a given direction, but the point matters more. The search
is deterministic: it begins from a fixed list of postures, without random restarts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.simulation.robot import Robot

DAMPING = 0.05  # damping [m]; a smaller value is faster but shakes near singular postures
WEIGHT = 0.15  # position error that weighs as much as a radian of direction error [m]
ITERATIONS = 60  # greatest number of iterations from one start
STRIDE = 0.3  # greatest change of a joint in one iteration [rad]
GOOD_ERROR, GOOD_TILT = 0.02, 0.2  # errors [m], [rad] below which no other start is tried
WITHOUT_GAIN = 8  # iterations without gain after which the search ends
GAIN = 0.95  # share of the best cost below which a lower one counts as a gain
CONVERGED = 0.005  # position error at which the search ends [m]


@dataclass(frozen=True)
class Posture:
    """A posture of the arm that brings the hand near a point."""

    arm: NDArray[np.float64]  # [J] [rad]
    error: float  # distance left between hand and point [m]
    tilt: float  # angle between the fingers and the direction that they should have [rad]


def solve(robot: Robot, point: NDArray[np.float64], pointing: NDArray[np.float64]) -> Posture:
    """The best posture found for the hand at `point`, [3] [m], world frame; there always is one.

    `pointing`: the direction of the fingers, a unit vector, [3], world frame.
    """
    limits = robot.arm_limits
    best: Posture | None = None
    for start in robot.stretched:
        found = _descend(robot, _facing(robot, start, point), point, pointing, limits)
        if best is None or found.error + WEIGHT * found.tilt < best.error + WEIGHT * best.tilt:
            best = found
        if best.error < GOOD_ERROR and best.tilt < GOOD_TILT:
            break
    assert best is not None
    return best


def lifted(robot: Robot, arm: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """The joints [rad], [..., J], near `arm` that bring the hand `height` [m] higher, its fingers pointing alike."""
    return shifted(robot, arm, np.array([0.0, 0.0, height]))


def shifted(robot: Robot, arm: NDArray[np.float64], shift: NDArray[np.float64]) -> NDArray[np.float64]:
    """The joints [rad], [..., J], near `arm` that move the hand by `shift` [m], [3], its fingers pointing alike."""
    hand, turn, _ = robot.kinematics(arm)
    return _descend(robot, arm, hand + shift, turn[:, 0], robot.arm_limits).arm


def _facing(robot: Robot, start: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
    """`start` with its first joint, the shoulder's pan, turned towards `point`."""
    heading = robot.base()[2]
    shoulder = robot.shoulder()
    pan = np.arctan2(point[1] - shoulder[1], point[0] - shoulder[0]) - heading
    turned = start.copy()
    turned[0] = np.arctan2(np.sin(pan), np.cos(pan))
    return turned


def _descend(
    robot: Robot,
    start: NDArray[np.float64],
    point: NDArray[np.float64],
    pointing: NDArray[np.float64],
    limits: NDArray[np.float64],
) -> Posture:
    low, high = limits.T
    arm = np.minimum(np.maximum(start, low), high)  # as np.clip, in a third of the time
    best, since = Posture(arm, np.inf, np.pi), 0
    damping = DAMPING**2 * np.eye(6)
    rows, aim = np.empty((6, len(arm))), np.empty(6)
    for iteration in range(ITERATIONS):
        hand, turn, jacobian = robot.kinematics(arm)
        off, axis = point - hand, turn[:, 0]
        error, tilt = float(np.sqrt(off @ off)), float(np.arccos(min(1.0, max(-1.0, float(axis @ pointing)))))
        cost = best.error + WEIGHT * best.tilt
        if error + WEIGHT * tilt < cost:
            since = since if error + WEIGHT * tilt > GAIN * cost else iteration
            best = Posture(arm, error, tilt)
        if (error < CONVERGED and tilt < CONVERGED / WEIGHT) or iteration - since > WITHOUT_GAIN:
            break
        rows[:3], rows[3:] = jacobian[:3], WEIGHT * jacobian[3:]
        aim[:3], aim[3:] = off, WEIGHT * _cross(axis, pointing)
        step = rows.T @ np.linalg.solve(rows @ rows.T + damping, aim)
        step *= min(1.0, STRIDE / max(float(np.abs(step).max()), 1e-9))
        arm = np.minimum(np.maximum(arm + step, low), high)
    return best


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """The vector product of `a` and `b`, [3] each; numpy's own takes ten times as long."""
    (x, y, z), (u, v, w) = a.tolist(), b.tolist()
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])
