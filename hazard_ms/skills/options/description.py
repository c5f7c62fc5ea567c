"""Descriptions of environments, of tasks and of their skills, row by row, and how rows are told."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import gymnasium as gym

from hazard_ms.env import interface
from hazard_ms.sensing.modes import needs_pictures
from hazard_ms.sensing.observation_table import Row
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.fires import measured
from hazard_ms.skills.options.interface import describe as describe_skills
from hazard_ms.spec.registry.robots import robot_class
from hazard_ms.tasks import task_of

SKILLS = "Skills-v"  # in the ids of environments of skills


def sections_of(env_id: str, obs_mode: str, robot_uids: str, **settings: Any) -> dict[str, list[Row]]:
    """Rows of observation, action, reward and info of an environment, by section.

    Raises ValueError for unknown names.
    """
    if SKILLS in env_id:
        name = env_id.replace(SKILLS, "-v")
        task = task_of(name, "paper")
        fire = measured(task.mitigations, [hazard.name for hazard in task.hazards])
        radius = robot_class(robot_uids).build.radius
        return describe_skills(Encoder(interface.ranges(name), radius, fire is not None))
    backend = "auto" if needs_pictures(obs_mode) else "none"
    settings = {key: value for key, value in settings.items() if value is not None}
    made = gym.make(env_id, obs_mode=obs_mode, robot_uids=robot_uids, render_backend=backend, **settings)
    try:
        return interface.describe(made.unwrapped)  # type: ignore[arg-type]
    finally:
        made.close()


def lines(row: Row) -> list[str]:
    """A row as text: one line, and one for each number where they differ."""
    shape = "x".join(map(str, row.shape)) or "number"
    told = [f"{shape} {row.dtype}", row.unit and f"[{row.unit}]", row.frame and f"frame: {row.frame}", bounds(row)]
    if row.entries:
        told[1] = ""
    made = [f"  {row.key:<44} {row.meaning}", " " * 6 + "  ".join(part for part in told if part)]
    numbers = entries(row)
    step = f" +{len(numbers)} i" if numbers and row.shape[-1] > len(numbers) else ""
    return made + [f"      {index:>4}{step}  {text}" for index, text in numbers]


def entries(row: Row) -> list[tuple[int, str]]:
    """Index and description of each number along the last axis, where they differ."""
    if not row.entries:
        return []
    units = row.unit.split(", ") if ", " in row.unit else [row.unit] * len(row.entries)
    start = int(row.key.partition("[")[2].partition(":")[0]) if row.key.startswith(("state[", "[")) else 0
    made = []
    for k, name in enumerate(row.entries):
        unit = f" [{units[k]}]" if units[k] not in ("", "-") else ""
        made.append((start + k, f"{name}{unit} {bounds(row, k)}"))
    return made


def bounds(row: Row, entry: int | None = None) -> str:
    """The range of a row, or of one of its entries."""
    ends = []
    for bound in (row.low, row.high):
        if isinstance(bound, tuple) and entry is None:
            return ""
        ends.append(f"{bound[entry] if isinstance(bound, tuple) and entry is not None else bound:.5g}")
    return f"{ends[0]} to {ends[1]}"


def plain(row: Row) -> dict[str, Any]:
    """A row as JSON holds it: null for an end that is open."""

    def closed(bound: Any) -> Any:
        if isinstance(bound, tuple):
            return [closed(b) for b in bound]
        return None if abs(bound) == float("inf") else bound

    return {**asdict(row), "low": closed(row.low), "high": closed(row.high)}
