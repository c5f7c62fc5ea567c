"""Cameras that robots carry beside that of the head: which there are, and ManiSkill's settings of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sapien
from mani_skill.sensors.camera import CameraConfig

from hazard_ms.robots import robot_class
from hazard_ms.spec.checks import one_of

SIDE = 256  # width and height of a picture if nothing else is asked for, as of the head [pixels]
NEAR, FAR = 0.01, 100.0  # that are seen [m]


def check_cameras(names: Sequence[str], robot: Any) -> tuple[str, ...]:
    """`names`, each once. Raises ValueError where the `robot` (see `robot_name`) has no cameras that are called so."""
    known = robot_class(robot).mounted_cameras
    if isinstance(names, str) or not isinstance(names, Sequence):
        raise ValueError(f"cameras must be a list of some of {', '.join(known) or 'none'}, got {names!r}")
    for name in names:
        one_of(name, known, "cameras")
    return tuple(dict.fromkeys(names))


def mounted(name: str, robot: Any) -> CameraConfig:
    """The camera `name` of a `robot` that stands in a scene."""
    link, position, rotation, fov = robot.mounted_cameras[name]
    mount = robot.robot.links_map[link]
    return CameraConfig(name, sapien.Pose(position, rotation), SIDE, SIDE, fov, near=NEAR, far=FAR, mount=mount)
