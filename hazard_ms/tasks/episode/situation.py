"""The situation that the functions of a task read: everything as it is now, in all E environments."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from hazard_ms.simulation.mitigation.door_grip import DoorGrip
from hazard_ms.simulation.robot import Robot
from hazard_ms.simulation.world import World
from hazard_ms.tasks.episode.episode import Episode


@dataclass(frozen=True)
class Situation:
    """The running episodes, and the robot that plays in them.

    `affects_agent` tells whether the hazards act on the robot.
    """

    episode: Episode
    agent: Robot
    affects_agent: bool = False
    known: dict[str, Any] | None = None  # what was worked out of this frame already; None: nothing is kept

    @property
    def world(self) -> World:
        """All things of the scenes, as tensors."""
        return self.episode.world

    @property
    def grip(self) -> DoorGrip:
        """The hands at the handles of doors. Raises ValueError in a task without `Task.doors_by_hand`."""
        if self.world.door_grip is None:
            raise ValueError("doors_by_hand must be True in a task of doors, got False")
        return self.world.door_grip
