"""The scene as text: one JSON block with all that a model is told of a decision.

Whatever comes from a scene stands in this block, in quotes. Tables are lists of rows, the first of which names the
columns; what can be chosen has its letter in the column `option`.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from typing import Any

from hazard_ms.agents.base import distance, known, open_targets
from hazard_ms.agents.llm.choices import BRING, FETCH, PICK, PUT, SEARCH, Menu
from hazard_ms.agents.llm.homes import tables
from hazard_ms.agents.llm.memory import Memory
from hazard_ms.agents.search.forecast import Forecast
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Decision

LONGEST_NAME = 40  # characters of a thing's name that are told [ours]
OTHER_SIGNS = re.compile(r"[^A-Za-z0-9_ -]")
UNITS = {"°C": "C", "m/s": "m_s"}  # as names of columns have them
FIRE, FLOOD = "fire", "flood"  # hazards whose limits are in the catalogue
SAFE = "safe"  # a target that no forecast sees harmed

Block = dict[str, Any]


def plain_names(names: Sequence[str]) -> dict[str, str]:
    """Each name as a model reads it: short, without special signs, and still different from all others."""
    made: dict[str, str] = {}
    taken: set[str] = set()
    for number, name in enumerate(names):
        text = OTHER_SIGNS.sub("_", name)[:LONGEST_NAME] or "thing"
        if text in taken:
            text = f"{text[: LONGEST_NAME - 6]}_{number}"
        taken.add(text)
        made[name] = text
    return made


def block(
    brief: Brief, decision: Decision, memory: Memory, menu: Menu, histories: bool = False, forecast: bool = False
) -> Block:
    """All that is told of a decision; with `histories`, earlier sightings, too, and with `forecast`, our forecast."""
    names = plain_names(decision.names)
    failed = memory.believed.failures
    told: Block = {
        "wanted": _wanted(brief, decision),
        "frame": decision.frame,
        "frames_left": decision.max_frames - decision.frame,
        "saved": sum(target.rescued for target in decision.targets),
        "held": None if decision.held is None else names[decision.held],
        "last_actions": [["action", "result", "frames"], *map(list, memory.done)],
        "targets": _targets(brief, decision, memory, menu, names, forecast),
    }
    if decision.containers:
        rows = []
        for name, seen in sorted(known(decision, decision.containers).items(), key=lambda e: decision.index(e[0])):
            letter = menu.letter(BRING, name) or menu.letter(PUT, name)
            rows.append([letter, names[name], _metres(distance(decision, seen)), failed.get(name, 0)])
        told["carts"] = [["option", "thing", "metres", "failures"], *rows]
    sighted = decision.map.objects
    told["places_to_search"] = [
        ["option", "near", "metres", "unexplored_metres", "visits"],
        *(
            [
                menu.letter(SEARCH, mark.name),
                names[mark.name],
                _metres(distance(decision, sighted[decision.index(mark.name)])),
                _metres(mark.edge),
                mark.visits,
            ]
            for mark in sorted(menu.places, key=lambda mark: decision.index(mark.name))
        ),
    ]
    told |= _mitigation(brief, decision, memory, menu, names)
    told["options"] = {
        choice.letter: choice.move if choice.thing is None else f"{choice.move} {names.get(choice.thing, choice.thing)}"
        for choice in menu.choices
    }
    if histories:
        told["seen_before"] = _histories(decision, memory, names)
    return told


def _mitigation(brief: Brief, decision: Decision, memory: Memory, menu: Menu, names: dict[str, str]) -> Block:
    """What tasks with mitigations add: where the robot is, doors, tools and what is hot; empty in others."""
    if not brief.mitigations:
        return {}
    rooms = memory.rooms
    columns = [_column(h.title, h.unit) for h in brief.hazards]
    made: Block = {"here": tables.here(brief, decision, rooms, columns, _rounded)}
    if decision.openings:
        made["doors"] = _without_zeros(tables.doors(decision, rooms), ("broken",))
    if decision.tools:
        made["tools"] = tables.tools(decision, menu, names, rooms)
    if found := tables.hot(brief, decision, menu, names, rooms):
        made["hot"] = found
    return made


def as_text(told: Block) -> str:
    """A block as JSON, one entry a line."""
    lines = (f"{json.dumps(key)}: {json.dumps(value, separators=(',', ':'))}" for key, value in told.items())
    return "{\n" + ",\n".join(lines) + "\n}"


def shortened(told: Block) -> Block | None:
    """The same block without its oldest sighting, action or message; None if nothing can be left out."""
    before = {name: rows for name, rows in told.get("seen_before", {}).items() if rows}
    if before:
        oldest = min(before, key=lambda name: before[name][0][0])
        rest = {name: rows[1:] if name == oldest else rows for name, rows in before.items()}
        return {**told, "seen_before": {name: rows for name, rows in rest.items() if rows}}
    for table in ("last_actions", "radio"):
        header, *old = told.get(table, [[]])
        if len(old) > 1:
            return {**told, table: [header, *old[1:]]}
    return None


def _wanted(brief: Brief, decision: Decision) -> list[list[Any]]:
    """The kinds of targets that are still to be saved, with what the catalogue says of each."""
    hazards = {hazard.name for hazard in brief.hazards}
    header = ["kind", "value", "left"]
    header += ["burns_at_C"] if FIRE in hazards else []
    header += ["waterproof"] if FLOOD in hazards else []
    counts: dict[tuple[Any, ...], int] = {}
    for target in decision.targets:
        if target.rescued:
            continue
        limits: list[Any] = []
        if FIRE in hazards:
            limits.append(round(target.ignition_temperature) if target.flammable else "never")
        if FLOOD in hazards:
            limits.append("yes" if target.waterproof else "no")
        key = (OTHER_SIGNS.sub("_", target.category), _short(target.value), *limits)
        counts[key] = counts.get(key, 0) + 1
    return [header, *([kind, value, count, *limits] for (kind, value, *limits), count in counts.items())]


def _targets(
    brief: Brief, decision: Decision, memory: Memory, menu: Menu, names: dict[str, str], forecast: bool
) -> list[list[Any]]:
    """The known targets: those on offer, and those that are not, as while something is held."""
    header = [
        "option",
        "thing",
        "value",
        *(["belief"] if brief.looks else []),
        "metres",
        *(_column(h.title, h.unit) for h in brief.hazards),
    ]
    header += ["frames_ago", "damaged", "failures"] + (["damaged_from_frame"] if forecast else [])
    rises = [f"{_column(h.title, h.unit)}{tables.RISE}" for h in brief.hazards if brief.mitigations]
    header += [*rises, *(["room"] if brief.mitigations and brief.several_rooms else [])]
    ahead = Forecast(brief, decision, memory.believed.fire) if forecast else None
    rows: list[list[Any]] = []
    for name, seen in sorted(known(decision, open_targets(decision)).items(), key=lambda each: decision.index(each[0])):
        letter, target = menu.letter(FETCH, name) or menu.letter(PICK, name), decision.target(name)
        if letter is None and decision.held is None:
            continue  # given up, or too far for the menu
        row = [letter, names[name], _short(target.value), *([round(target.belief, 2)] if brief.looks else [])]
        row.append(_metres(distance(decision, seen)))
        row += [_level(seen, number, hazard.unit) for number, hazard in enumerate(brief.hazards)]
        row += [decision.frame - seen.frame, int(target.damaged), memory.believed.failures.get(name, 0)]
        if ahead is not None:
            until = ahead.whole_until(target, seen)
            row.append(round(until) if math.isfinite(until) else SAFE)
        row += [tables.rise(seen, number, brief.hazards[number].unit, _rounded) for number in range(len(rises))]
        row += [memory.rooms.at(seen.position)] if brief.mitigations and brief.several_rooms else []
        rows.append(row)
    return _without_zeros([header, *rows], ("damaged", "failures", *rises))


def _without_zeros(table: list[list[Any]], columns: Sequence[str]) -> list[list[Any]]:
    """A table without those of its `columns` that hold nothing but 0."""
    header, *rows = table
    gone = {number for number, name in enumerate(header) if name in columns and not any(row[number] for row in rows)}
    return [[entry for number, entry in enumerate(row) if number not in gone] for row in table]


def _histories(decision: Decision, memory: Memory, names: dict[str, str]) -> dict[str, list[list[Any]]]:
    """Earlier sightings of the targets in `decision` that are still to be saved: frame, distance, levels."""
    made = {}
    for name in known(decision, open_targets(decision)):
        rows = [[s.frame, _metres(s.metres), *(round(v, 1) for v in s.levels)] for s in memory.history(name)]
        if rows:
            made[names[name]] = rows
    return made


def _column(title: str, unit: str) -> str:
    """The name of the column of a hazard's level: "temperature_C"."""
    return f"{title}_{UNITS.get(unit, unit)}".replace(" ", "_")


def _level(seen: Sighting, number: int, unit: str) -> float | int | None:
    """A level as it is told: whole degrees, else to 0.01 of its unit; None where it is unknown."""
    return _rounded(seen.levels[number] if number < len(seen.levels) else math.nan, unit)


def _rounded(level: float, unit: str) -> float | int | None:
    """The same of a level in its unit."""
    if not math.isfinite(level):
        return None
    return round(level) if unit == "°C" else round(level, 2)


def _metres(length: float) -> float:
    return round(length, 1)


def _short(value: float) -> float | int:
    return int(value) if value == int(value) else value
