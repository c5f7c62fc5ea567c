"""Episodes as rows of scores.csv, and the tables that follow from such rows, whatever machine they were played on."""

from __future__ import annotations

import csv
import dataclasses
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from hazard_ms.evaluation.comparison.pairing import Episode, difference, regret
from hazard_ms.evaluation.comparison.summary import ORACLE
from hazard_ms.evaluation.metrics import Tally, scores
from hazard_ms.evaluation.result import EpisodeResult

KEYS = ("task", "robot", "agent", "scene", "seed")
NUMBERS = ("value", "bound", "frames", "ended", "rescued", "targets", "last_rescue", "rescued_damaged")
COLUMNS = (*KEYS, *NUMBERS)
Row = dict[str, Any]


def row_of(task: str, robot: str, result: EpisodeResult, bound: float) -> Row:
    """The row of an episode; `bound`: the Value that no agent can exceed in it, 0 to 1."""
    tally = result.tally
    values = (tally.value, bound, result.frames, result.ended, tally.rescued, len(result.targets))
    numbers = dict(zip(NUMBERS, (*values, tally.last_rescue, tally.rescued_damaged), strict=True))
    keys = dict(zip(KEYS, (task, robot, result.agent, result.scene, result.seed), strict=True))
    return {**keys, **numbers, "value": round(tally.value, 6), "bound": round(bound, 6)}


def read(path: Path, task: str, robot: str) -> list[Row]:
    """The rows of a task and a robot in a file, as text; none without a file."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return [row for row in csv.DictReader(file) if (row["task"], row["robot"]) == (task, robot)]


def whole(rows: Iterable[Row]) -> list[Row]:
    """Those of `rows` from which every score follows, with numbers in place of text."""
    found = [row for row in rows if all(row.get(name) not in (None, "") for name in COLUMNS)]
    counts = ("seed", "frames", "rescued", "targets", "last_rescue", "rescued_damaged")
    shares = ("value", "bound")
    return [{**r, **{n: int(r[n]) for n in counts}, **{n: float(r[n]) for n in shares}} for r in found]


def merged(before: Iterable[Row], now: Iterable[Row]) -> list[Row]:
    """The rows of `before` and `now`, by agent and episode; those of `now` count where an episode was played twice."""
    found = {(row["agent"], row["seed"], row["scene"]): row for row in (*before, *now)}
    return [found[key] for key in sorted(found)]


def group(settings: str, rows: Sequence[Row]) -> dict[str, Any]:
    """The scores of `rows` and the differences of their agents, as `hazard-ms report --json` tells them of a group."""
    by_agent: dict[str, list[Row]] = {}
    for row in rows:
        by_agent.setdefault(row["agent"], []).append(row)
    values = {name: {(r["seed"], r["scene"]): r["value"] for r in own} for name, own in by_agent.items()}
    return {
        "settings": settings,
        "agents": {name: _agent(own, values[name], values.get(ORACLE)) for name, own in by_agent.items()},
        "differences": [
            {
                "agent": one,
                "other": other,
                "episodes": len(values[one].keys() & values[other].keys()),
                "value": dataclasses.asdict(difference(values[one], values[other])),
            }
            for one in values
            for other in sorted(values, key=lambda name: -sum(values[name].values()) / len(values[name]))
            if one != other
        ],
    }


def _agent(rows: Sequence[Row], own: Mapping[Episode, float], best: Mapping[Episode, float] | None) -> dict[str, Any]:
    tallies = [Tally(r["value"], 1.0, r["rescued"], r["rescued_damaged"], r["last_rescue"]) for r in rows]
    found = scores(tallies, [r["scene"] for r in rows])
    made: dict[str, Any] = {name: dataclasses.asdict(score) for name, score in found.items()}
    if best is not None:
        made["regret"] = dataclasses.asdict(regret(own, best))
    counts = {name: sum(row[name] for row in rows) for name in ("rescued", "targets")}
    return {**made, **counts, "episodes": len(rows)}
