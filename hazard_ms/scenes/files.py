"""Scenes from files: JSON as `hazard_ms.scenes.schema` writes it, in place of the scenes that a task comes with."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hazard_ms.scenes.schema import LARGEST_FILE, from_json
from hazard_ms.spec import SceneSpec, Task
from hazard_ms.spec.foreign.files import printable, read_foreign
from hazard_ms.spec.names import natural

MOST_FILES = 2000  # that one folder may hold


def playing(task: Task, scenes: Any) -> Task:
    """The task, played in the scenes of files in every split; in its own scenes if `scenes` is None.

    `scenes`: a JSON file, a folder of them, or a list of both.
    """
    if scenes is None:
        return task
    found = read_scenes(scenes)
    names = tuple(found)
    return dataclasses.replace(task, scenes=lambda split: names, build=found.__getitem__)


def read_scenes(scenes: Any) -> dict[str, SceneSpec]:
    """The scenes of JSON files by name; folders give all of theirs, in the order of their names.

    Raises ValueError that names the file for anything that is not a valid scene, and for two scenes of one name.
    """
    paths = [scenes] if isinstance(scenes, (str, os.PathLike)) else scenes
    if not isinstance(paths, Sequence) or not paths or not all(isinstance(p, (str, os.PathLike)) for p in paths):
        raise ValueError(f"scenes must be a JSON file, a folder of them, or a list of both, got {scenes!r:.200}")
    found: dict[str, SceneSpec] = {}
    for path in (p for given in paths for p in _files(Path(given))):
        spec = read_scene(path)
        if spec.name in found:
            raise ValueError(f"{printable(str(path))}: names of scenes must differ, got {spec.name!r} twice")
        found[spec.name] = spec
    return found


def read_scene(path: Path) -> SceneSpec:
    """The scene in a JSON file. Raises ValueError that names the file and what is wrong with it."""
    raw = read_foreign(path, LARGEST_FILE)
    try:
        return from_json(raw)
    except ValueError as error:
        raise ValueError(f"{printable(str(path))}: {error}") from None


def _files(given: Path) -> list[Path]:
    """The JSON files that a path means, at least one."""
    found = sorted(given.glob("*.json"), key=lambda path: natural(path.stem)) if given.is_dir() else [given]
    if not found or len(found) > MOST_FILES:
        raise ValueError(f"{given} must hold 1 to {MOST_FILES} files *.json, got {len(found)}")
    return found
