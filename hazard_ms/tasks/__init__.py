"""Tasks by the name under which gymnasium knows them: preset of physics -> task."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from hazard_ms.spec import Task
from hazard_ms.tasks.compound import NAME, hazard_compound
from hazard_ms.tasks.fire import hazard_fire
from hazard_ms.tasks.flood import hazard_flood
from hazard_ms.tasks.wind import hazard_wind

TASKS: dict[str, Callable[[str], Task]] = {
    "HazardFire-v1": hazard_fire,
    "HazardFlood-v1": hazard_flood,
    "HazardWind-v1": hazard_wind,
    NAME: hazard_compound,
}


def task_of(name: str, physics: str, hazards: Sequence[str] | None = None) -> Task:
    """The task called `name`; `hazards` only for HazardCompound-v1."""
    if hazards is None:
        return TASKS[name](physics)
    if name != NAME:
        raise ValueError(f"hazards is {hazards!r} for {name}; it is allowed for {NAME} only")
    return hazard_compound(physics, tuple(hazards) if isinstance(hazards, list) else hazards)
