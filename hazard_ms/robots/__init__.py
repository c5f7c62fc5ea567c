"""The robots that can play: `hazard_ms.registry.ROBOTS` names them, `robot_class` finds the class of each."""

from __future__ import annotations

from typing import Any

from hazard_ms.registry import ROBOTS, load
from hazard_ms.spec.checks import one_of


def robot_name(value: Any) -> str:
    """The name of a registered robot. `value` is that name, ManiSkill's uid of it, or a tuple of one of these.

    Raises ValueError for an unknown name.
    """
    if isinstance(value, (tuple, list)) and len(value) == 1:
        value = value[0]
    by_uid = {entry.uid: name for name, entry in ROBOTS.items()}
    return one_of(by_uid.get(value, value) if isinstance(value, str) else value, ROBOTS, "robot_uids")


def robot_uid(value: Any) -> str:
    """ManiSkill's uid of the robot `value` (see `robot_name`). Raises ValueError for an unknown name."""
    return ROBOTS[robot_name(value)].uid


def robot_class(value: Any) -> Any:
    """The class of the robot `value` (see `robot_name`). Raises ValueError for an unknown name."""
    return load(ROBOTS[robot_name(value)].robot)


def skill_control_mode(value: Any) -> str:
    """The `control_mode` of gym.make that skills need of the robot `value`. Raises ValueError for an unknown name."""
    mode: str = robot_class(value).skill_control_mode
    return mode
