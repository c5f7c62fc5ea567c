"""The fields of results that teams alone have: the robot of each decision, loads of each, how often they collided."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from hazard_ms.evaluation.choices import team_names

OWN = ("robot_loads", "robot_collisions")
TEAM_FORMAT = 4  # of results of teams; those of one robot have none of their fields, and keep theirs


def told(row: dict[str, Any]) -> dict[str, Any]:
    """The plain data of a result; without the fields of teams where there is none."""
    if team_names(row["settings"].get("robot_uids")):
        return row
    decisions = [{name: value for name, value in decision.items() if name != "robot"} for decision in row["decisions"]]
    return {name: value for name, value in row.items() if name not in OWN} | {"decisions": decisions}


def check(settings: dict[str, Any], format_number: int, robots: Iterable[str], collisions: int | None) -> None:
    """Check that what a result tells of a team is that of the team of its settings; `robots`: those that it names.

    Raises ValueError where it is not.
    """
    names = team_names(settings.get("robot_uids"))
    if (format_number == TEAM_FORMAT) != bool(names) or (collisions is None) != (not names):
        raise ValueError(
            f"a result must have format {TEAM_FORMAT} and robot_collisions if several robots played, else neither, "
            f"got format {format_number} and {collisions!r} for {max(1, len(names))} robots"
        )
    for robot in robots:
        if robot not in (names or ("",)):
            raise ValueError(f"a robot of a result must be one of {', '.join(names) or 'none'}, got {robot!r:.100}")
