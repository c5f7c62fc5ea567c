"""Upright boxes, turned about the vertical: the space that furniture and objects occupy.

All lengths are in metres, all angles in radians.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.spec import Body, Fixture, Quat, Vec2, Vec3

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Box:
    """An upright box from height `low` to `high` [m].

    Its half lengths are along its own axes, which are turned by `yaw` [rad] about the vertical.
    """

    x: float
    y: float
    half_x: float
    half_y: float
    yaw: float
    low: float
    high: float

    @property
    def row(self) -> tuple[float, ...]:
        """The box as a row of the arrays that `free_of` takes."""
        return self.x, self.y, self.half_x, self.half_y, math.cos(self.yaw), math.sin(self.yaw), self.low, self.high

    def local(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Points of the world [m], [...], in the frame of the box."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return c * (x - self.x) + s * (y - self.y), -s * (x - self.x) + c * (y - self.y)

    def world(self, along: float, across: float) -> Vec2:
        """The point (along, across) of the box's own axes [m], in the world frame."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return self.x + c * along - s * across, self.y + s * along + c * across

    def corners(self, margin: float = 0.0) -> list[Vec2]:
        """The four corners of the footprint, grown by `margin` [m]."""
        a, b = self.half_x + margin, self.half_y + margin
        return [self.world(sx * a, sy * b) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]

    def distance(self, x: Array, y: Array) -> Array:
        """Horizontal distances of points from the footprint [m], [...]; 0 inside."""
        u, v = self.local(x, y)
        beyond_u, beyond_v = np.maximum(np.abs(u) - self.half_x, 0.0), np.maximum(np.abs(v) - self.half_y, 0.0)
        return np.hypot(beyond_u, beyond_v)


def yaw_of(rotation: Quat) -> float:
    """The turn about the vertical of an upright pose [rad]."""
    w, _, _, z = rotation
    return 2.0 * math.atan2(z, w)


def turned(yaw: float) -> Quat:
    """The quaternion of a turn about the vertical by `yaw` [rad], rounded to the same digits on every machine."""
    yaw = math.remainder(yaw, 2.0 * math.pi)
    return round(math.cos(yaw / 2), 7), 0.0, 0.0, round(math.sin(yaw / 2), 7)


def matrix_of(rotation: Quat) -> Array:
    """The matrix of a rotation, [3, 3]."""
    w, x, y, z = rotation
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def box_of(thing: Body | Fixture, extent: Vec3) -> Box:
    """The box that `thing` occupies, or the upright box around it if it is tilted; `extent`: size of its asset [m]."""
    size = np.array(extent) * thing.scale
    _, x, y, _ = thing.rotation
    if abs(x) < 1e-4 and abs(y) < 1e-4:
        px, py, pz = thing.position
        return Box(px, py, size[0] / 2, size[1] / 2, yaw_of(thing.rotation), pz, pz + size[2])
    turn = matrix_of(thing.rotation)
    centre = np.array(thing.position) + turn @ [0.0, 0.0, size[2] / 2]
    half = np.abs(turn) @ (size / 2)
    return Box(centre[0], centre[1], half[0], half[1], 0.0, centre[2] - half[2], centre[2] + half[2])


def rows(boxes: Iterable[Box]) -> Array:
    """Boxes as an array with a row for each, [N, 8]; see `Box.row`."""
    return np.array([b.row for b in boxes], dtype=np.float64).reshape(-1, 8)


def free_of(box: Box, others: Array, gap: float) -> bool:
    """Whether `box` keeps `gap` [m] from each of `others`, [N, 8]: in height, or along an axis of either footprint."""
    if len(others) == 0:
        return True
    x, y, a, b, c, s, low, high = others.T
    dx, dy = x - box.x, y - box.y
    bc, bs = math.cos(box.yaw), math.sin(box.yaw)
    dot, cross = np.abs(bc * c + bs * s), np.abs(bc * s - bs * c)  # of the two boxes' axes
    apart = (
        (low >= box.high)
        | (high <= box.low)
        | (np.abs(bc * dx + bs * dy) >= box.half_x + a * dot + b * cross + gap)
        | (np.abs(-bs * dx + bc * dy) >= box.half_y + a * cross + b * dot + gap)
        | (np.abs(c * dx + s * dy) >= a + box.half_x * dot + box.half_y * cross + gap)
        | (np.abs(-s * dx + c * dy) >= b + box.half_x * cross + box.half_y * dot + gap)
    )
    return bool(apart.all())
