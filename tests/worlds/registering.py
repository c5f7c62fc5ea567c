"""Tasks, hazards, robots and agents that are registered for a while."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

from hazard_ms.spec import registry


@contextmanager
def registered_task(
    name: str, maker: Any, max_frames: int = 1500, split_frames: Mapping[str, int] | None = None
) -> Iterator[str]:
    """The task `name` is registered as long as the context lasts."""
    registry.register_task(name, maker, max_frames, split_frames)
    try:
        yield name
    finally:
        registry.unregister(registry.TASKS[name])


@contextmanager
def loaded(path: Path) -> Iterator[ModuleType]:
    """The module in the file `path` with all that it registers, as long as the context lasts."""
    tables: tuple[Mapping[str, Any], ...] = (registry.TASKS, registry.HAZARDS, registry.ROBOTS, registry.AGENTS)
    before = [set(table) for table in tables]
    module = registry.load_plugin(str(path))
    try:
        yield module
    finally:
        for table, names in zip(tables, before, strict=True):
            for name in set(table) - names:
                registry.unregister(table[name])
        del sys.modules[module.__name__]


@contextmanager
def practising() -> Iterator[ModuleType]:
    """The practice tasks are registered under the name that users give, as long as the context lasts."""
    module = importlib.import_module("hazard_ms.tasks.practice")
    try:
        yield module
    finally:
        for entry in [entry for entry in registry.TASKS.values() if entry.maker in vars(module).values()]:
            registry.unregister(entry)
        del sys.modules[module.__name__]
