"""The plain frozen data that scenes, tasks and robots are made of, and the catalogue of things. No torch, no SAPIEN."""

from hazard_ms.spec.robot import Build
from hazard_ms.spec.scene import (
    UPRIGHT,
    AgentStart,
    Area,
    Body,
    Fixture,
    Opening,
    Parameter,
    Partition,
    Patch,
    Quat,
    Room,
    SceneSpec,
    Vec2,
    Vec3,
)
from hazard_ms.spec.task import Bound, Goal, Level, Quantity, SafePlace, Task, Term

__all__ = [
    "UPRIGHT",
    "AgentStart",
    "Area",
    "Body",
    "Bound",
    "Build",
    "Fixture",
    "Goal",
    "Level",
    "Opening",
    "Parameter",
    "Partition",
    "Patch",
    "Quantity",
    "Quat",
    "Room",
    "SafePlace",
    "SceneSpec",
    "Task",
    "Term",
    "Vec2",
    "Vec3",
]
