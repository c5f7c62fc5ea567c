"""Tasks by their registered names."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Sequence
from typing import Any

from hazard_ms.hazards.presets import severity_for
from hazard_ms.spec import Task
from hazard_ms.spec.registry import TASKS, find, load
from hazard_ms.spec.severity import USUAL


def task_of(name: str, physics: str, hazards: Sequence[str] | None = None, severity: str = USUAL) -> Task:
    """The registered task called `name` with the `physics` of a preset, and with `hazards` if they can be chosen.

    Raises ValueError for an unknown name, preset or severity, and for `hazards` or a severity that the task does not
    let one choose.
    """
    entry = find(TASKS, name, "task")
    maker = load(entry.maker)
    if hazards is not None and "hazards" not in inspect.signature(maker).parameters:
        raise ValueError(f"hazards must be None for {name}, whose hazards are fixed, got {hazards!r}")
    options: dict[str, Any] = severity_for(maker, name, physics, severity)
    made = maker(physics, **options) if hazards is None else maker(physics, hazards=hazards, **options)
    if not isinstance(made, Task):
        raise ValueError(f"the maker of {name!r} must return a Task, got {type(made).__name__}")
    return dataclasses.replace(made, name=name, max_frames=entry.max_frames)
