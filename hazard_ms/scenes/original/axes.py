"""Converts between the original's frame and ours.

The original (TDW, Unity) is left-handed: x right, y up, z forward; its angles are in degrees, clockwise seen along the
axis. Ours is right-handed: x right, y forward, z up. So (x, y, z) there is (x, z, y) here, and as that mirrors space, a
turn by an angle about an axis becomes one by minus the angle about the exchanged axis. Then the room's south-west floor
corner is moved to our origin. Quaternions of both are (w, x, y, z).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from hazard_ms.spec import UPRIGHT, Quat, Vec2, Vec3

AXES = {"pitch": (1.0, 0.0, 0.0), "yaw": (0.0, 1.0, 0.0), "roll": (0.0, 0.0, 1.0)}  # TDW's names of its axes


@dataclass(frozen=True)
class SouthWestCorner:
    """The origin of our frame in the original's: the south-west corner of the floor [m]."""

    x: float
    y: float  # up
    z: float

    def ours(self, position: Vec3) -> Vec3:
        """A point of the original's frame in ours [m]."""
        return position[0] - self.x, position[2] - self.z, position[1] - self.y

    def original(self, position: Vec3) -> Vec3:
        """A point of our frame in the original's [m]."""
        return position[0] + self.x, position[2] + self.y, position[1] + self.z


def our_direction(velocity: Vec3) -> Vec2:
    """The horizontal part of a vector of the original's frame, in our frame."""
    return velocity[0], velocity[2]


def our_rotation(rotation: Quat) -> Quat:
    """A rotation of the original's frame in ours. The function is its own inverse."""
    w, x, y, z = rotation
    return w, -x, -z, -y


def from_euler(degrees: Vec3) -> Quat:
    """The rotation by Unity's Euler angles: about z first, then x, then y, all axes of the original's frame."""
    x, y, z = (about(axis, angle) for axis, angle in zip(AXES.values(), degrees, strict=True))
    return times(y, times(x, z))


def about(axis: Vec3, degrees: float) -> Quat:
    """The rotation about a unit axis of the original's frame."""
    half = math.radians(degrees) / 2
    s = math.sin(half)
    return math.cos(half), axis[0] * s, axis[1] * s, axis[2] * s


def looking(from_: Vec3, to: Vec3) -> Quat:
    """The rotation of a thing at `from_` whose forward axis, z, points to `to`; its y is as upright as possible."""
    x, y, z = (b - a for a, b in zip(from_, to, strict=True))
    level = math.hypot(x, z)
    if level < 1e-9 and abs(y) < 1e-9:
        return UPRIGHT
    return times(
        about(AXES["yaw"], math.degrees(math.atan2(x, z))), about(AXES["pitch"], -math.degrees(math.atan2(y, level)))
    )


def times(a: Quat, b: Quat) -> Quat:
    """The rotation `b`, followed by the rotation `a`."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def inverse(q: Quat) -> Quat:
    """The inverse of a rotation."""
    return q[0], -q[1], -q[2], -q[3]


def turn(q: Quat, v: Vec3) -> Vec3:
    """The vector `v`, turned by `q`."""
    _, x, y, z = times(times(q, (0.0, *v)), inverse(q))
    return x, y, z
