"""Robots by name, by the uid that ManiSkill knows them by, or as a tuple of several: the class and mode of each."""

from __future__ import annotations

from typing import Any

from hazard_ms.spec.checks import one_of
from hazard_ms.spec.registry import MOST_ROBOTS, ROBOTS, load


def robot_name(value: Any) -> str:
    """The name of a registered robot. `value` is that name, ManiSkill's uid of it, or a tuple of one of these.

    Raises ValueError for an unknown name.
    """
    if isinstance(value, (tuple, list)) and len(value) == 1:
        value = value[0]
    by_uid = {entry.uid: name for name, entry in ROBOTS.items()}
    return one_of(by_uid.get(value, value) if isinstance(value, str) else value, ROBOTS, "robot_uids")


def robot_names(value: Any) -> tuple[str, ...]:
    """The names of the robots of an environment; `value` is one robot (see `robot_name`), or a tuple of some.

    Raises ValueError for unknown names, and for more than MOST_ROBOTS.
    """
    if not isinstance(value, (tuple, list)) or len(value) <= 1:
        return (robot_name(value),)
    if len(value) > MOST_ROBOTS:
        raise ValueError(f"robot_uids must be at most {MOST_ROBOTS} robots, got {len(value)}")
    return tuple(robot_name(one) for one in value)


def robot_uid(value: Any) -> str | tuple[str, ...]:
    """ManiSkill's uid of the robot `value`, or those of several (see `robot_names`).

    Raises ValueError as `robot_names` does.
    """
    uids = tuple(ROBOTS[name].uid for name in robot_names(value))
    return uids[0] if len(uids) == 1 else uids


def robot_class(value: Any) -> Any:
    """The class of the robot `value` (see `robot_name`). Raises ValueError for an unknown name."""
    return load(ROBOTS[robot_name(value)].robot)


def skill_control_mode(value: Any) -> str:
    """The `control_mode` of gym.make that skills need of the robot `value`. Raises ValueError for an unknown name."""
    mode: str = robot_class(value).skill_control_mode
    return mode
