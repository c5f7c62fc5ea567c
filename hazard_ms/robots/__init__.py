"""The robots that can play, by the name that users give as `robot_uids`."""

from __future__ import annotations

from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.robots.g1 import HazardG1
from hazard_ms.robots.planar import PlanarRobot
from hazard_ms.robots.robot import Build, Robot

ROBOTS: dict[str, type[PlanarRobot]] = {"fetch": HazardFetch, "g1": HazardG1}

__all__ = ["ROBOTS", "Build", "HazardFetch", "HazardG1", "PlanarRobot", "Robot", "robot_uid"]


def robot_uid(name: str) -> str:
    """ManiSkill's uid of the robot that users call `name`."""
    if name not in ROBOTS:
        raise ValueError(f"no robot is called {name!r}; there are {', '.join(ROBOTS)}")
    return ROBOTS[name].uid
