"""Cameras that robots carry beside that of the head: which there are, and ManiSkill's settings of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import sapien
from mani_skill.sensors.camera import CameraConfig

from hazard_ms.spec.checks import one_of
from hazard_ms.spec.registry.robots import robot_class

SIDE = 256  # width and height of a picture if nothing else is asked for, as of the head [pixels]
NEAR, FAR = 0.01, 100.0  # that are seen [m]


def check_cameras(names: Sequence[str], robots: Sequence[Any]) -> tuple[str, ...]:
    """`names`, each once. Raises ValueError where one of the `robots`, by name, has no cameras that are called so."""
    for robot in robots:
        known = robot_class(robot).mounted_cameras
        if isinstance(names, str) or not isinstance(names, Sequence):
            raise ValueError(f"cameras must be a list of some of {', '.join(known) or 'none'}, got {names!r}")
        for name in names:
            one_of(name, known, "cameras" if len(robots) == 1 else f"cameras of {robot}")
    return tuple(dict.fromkeys(names))


def mounted(names: Sequence[str], robots: Mapping[str, Any]) -> list[CameraConfig]:
    """The cameras `names` of each of the `robots`, by name, of a scene; those of a team begin with the robot's name."""
    prefixes = [f"{owner}-" if len(robots) > 1 else "" for owner in robots]
    return [_mounted(name, robot, p) for p, robot in zip(prefixes, robots.values(), strict=True) for name in names]


def _mounted(name: str, robot: Any, prefix: str) -> CameraConfig:
    link, position, rotation, fov = robot.mounted_cameras[name]
    mount = robot.robot.links_map[link]
    return CameraConfig(
        prefix + name, sapien.Pose(position, rotation), SIDE, SIDE, fov, near=NEAR, far=FAR, mount=mount
    )
