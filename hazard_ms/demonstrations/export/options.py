"""Options of `hazard-ms demos export`, as plain data: loading them for a help text imports nothing heavy."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from hazard_ms.evaluation.choices import flag, offer

FORMATS = ("maniskill", "lerobot", "minari", "chat", "tar")


@dataclass(frozen=True)
class ExportOptions:
    """Options of `hazard-ms demos export`."""

    folder: tyro.conf.Positional[Path]
    """Dataset that `hazard-ms demos record` wrote."""
    format: Annotated[str, offer(FORMATS), flag("-f")]
    """Format to write: trajectories of ManiSkill, a LeRobot or a Minari dataset, chats for language models, or tar
    files for WebDataset."""
    output: Annotated[Path, flag("-o")]
    """Folder to write; it must be new or empty."""
    obs: str | None = None
    """Observation mode of ManiSkill whose observations are written, by simulating the episodes again; without it, those
    that were recorded. For maniskill and minari."""
    states: bool = False
    """Write the state of everything in every frame, by simulating the episodes again. For maniskill."""
    privileged: bool = False
    """Write what only a privileged teacher knows, too: policies that learn from it cannot act without it. For
    maniskill, chat and tar."""
    language: bool = False
    """Write the skills that run as the column `language_persistent`, which LeRobot reads from 0.6 on, in place of
    `subtask_index`; earlier ones cannot read it. For lerobot."""
    load: tuple[str, ...] = ()
    """Modules, or files NAME.py, that register what the episodes need."""
