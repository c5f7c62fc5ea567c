"""Tables of a prompt for tasks with mitigations: what the robot bears where it is, doors, tools, and what is hot."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from hazard_ms.agents.base import distance
from hazard_ms.agents.llm.choices import FETCH, Menu
from hazard_ms.agents.llm.homes.rooms import Rooms
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Decision

FIRE, EXTINGUISH = "fire", "extinguish"
HOT = 100.0  # level from which a thing is told of as hot: boiling water, as the skill has it [C]
MOST_HOT = 6  # hot things that are told, the nearest [ours]
REACH = 0.8  # distance from the robot within which levels are taken as those that it bears [m] [ours]
PER = 100  # frames for which a level's rise is told
RISE = f"_per_{PER}_frames"  # ends the name of a column that holds one

Row = list[Any]
Told = Callable[[float, str], float | int | None]  # a level in its unit, as prompts tell it


def here(brief: Brief, decision: Decision, rooms: Rooms, columns: Sequence[str], told: Told) -> dict[str, Any]:
    """The room that the robot of `decision` is in, and the highest levels seen within REACH; `columns`: their names."""
    made: dict[str, Any] = {"room": rooms.at(decision.agent_position)} if brief.several_rooms else {}
    seen = decision.map
    for number, (column, hazard) in enumerate(zip(columns, brief.hazards, strict=True)):
        if number < len(seen.levels):
            made[column] = told(_most_around(decision, number), hazard.unit)
    return made


def _most_around(decision: Decision, number: int) -> float:
    """The highest level of the hazard `number` that was seen around the robot, in its unit; NaN for none."""
    seen = decision.map
    x, y = ((np.asarray(decision.agent_position) - seen.origin) / seen.cell).astype(int)
    far = round(REACH / seen.cell)
    part = np.asarray(seen.levels[number])[max(y - far, 0) : y + far + 1, max(x - far, 0) : x + far + 1]
    known = part[np.isfinite(part)]
    return float(known.max()) if known.size else math.nan


def rise(seen: Sighting, number: int, unit: str, told: Told) -> float | int | None:
    """The rise of the level of hazard `number` in PER frames between the last two looks, in `unit`; None after one."""
    looks = [(frame, levels[number]) for frame, levels in seen.history if number < len(levels)]
    if len(looks) < 2 or looks[-1][0] == looks[-2][0]:
        return None
    (before, low), (after, high) = looks[-2:]
    return told(PER * (high - low) / (after - before), unit)


def doors(decision: Decision, rooms: Rooms) -> list[Row]:
    """The doors, windows and doorways that were seen."""
    x, y = decision.agent_position
    header = ["door", "metres", "percent_open", "joins", "frames_ago", "broken"]
    return [
        header,
        *(
            [
                o.name,
                round(math.hypot(o.position[0] - x, o.position[1] - y), 1),
                round(100 * o.open),
                rooms.joined(o),
                decision.frame - o.frame,
                int(o.broken),
            ]
            for o in decision.openings
        ),
    ]


def tools(decision: Decision, menu: Menu, names: dict[str, str], rooms: Rooms) -> list[Row]:
    """The tools that were seen, and the one in the hand."""
    rows: list[Row] = []
    for tool in decision.tools:
        seen = decision.map.objects.get(decision.index(tool.name))
        if seen is None and not tool.held:
            continue
        far = 0.0 if seen is None or tool.held else round(distance(decision, seen), 1)
        place = decision.agent_position if seen is None or tool.held else seen.position
        left = round(100 * tool.left)
        rows.append([menu.letter(FETCH, tool.name), names[tool.name], tool.kind, left, far, rooms.at(place)])
    return [["option", "tool", "kind", "percent_left", "metres", "room"], *rows]


def hot(brief: Brief, decision: Decision, menu: Menu, names: dict[str, str], rooms: Rooms) -> list[Row]:
    """The nearest things that were hot when last seen, where a fire can be fought."""
    number = next((n for n, hazard in enumerate(brief.hazards) if hazard.name == FIRE), None)
    if number is None or EXTINGUISH not in brief.mitigations:
        return []
    found = [
        (distance(decision, seen), index, seen)
        for index, seen in decision.map.objects.items()
        if len(seen.levels) > number and seen.levels[number] >= HOT
    ]
    rows: list[Row] = []
    for far, index, seen in sorted(found, key=lambda each: each[:2])[:MOST_HOT]:
        name = decision.names[index]
        letter, level = menu.letter(EXTINGUISH, name), round(seen.levels[number])
        rows.append([letter, names[name], round(far, 1), level, rooms.at(seen.position), decision.frame - seen.frame])
    return [["option", "thing", "metres", "temperature_C", "room", "frames_ago"], *rows] if rows else []
