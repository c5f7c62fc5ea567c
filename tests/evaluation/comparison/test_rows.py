"""Tables out of rows of scores.csv: the numbers of `hazard-ms report`, also for episodes of another machine."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from hazard_ms.evaluation.comparison.folders import groups, title
from hazard_ms.evaluation.comparison.summary import summary
from hazard_ms.evaluation.result import EpisodeResult
from results.make import section
from results.rows import COLUMNS, group, merged, read, row_of, whole
from tests.worlds.courses import course, fate

PLAYED = {  # frames at which two targets are rescued, of every agent in its episodes
    "oracle": [(100, 300), (200, 500), (250, None)],
    "planner": [(150, 400), (700, None), (None, None)],
    "greedy": [(120, None), (900, 1000), (None, 80)],
}


def episodes() -> list[EpisodeResult]:
    return [
        course(agent, seed, [fate(1, first), fate(5, second)])
        for agent, made in PLAYED.items()
        for seed, (first, second) in enumerate(made)
    ]


def through_a_file(rows: list[dict[str, Any]], path: Path) -> list[dict[str, Any]]:
    """Rows as they come back from scores.csv."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)
    return read(path, "fire", "fetch")


def test_the_tables_of_rows_are_those_of_the_report(tmp_path: Path) -> None:
    played = episodes()
    for n, result in enumerate(played):
        result.write(tmp_path / f"{n}.json")
    wanted = section(summary(groups([tmp_path])[0][0]))
    rows = [row_of("fire", "fetch", result, 1.0) for result in played]
    found = section(group(title(played[0]), whole(through_a_file(rows, tmp_path / "scores.csv"))))
    assert found == wanted and any("[" in line for line in wanted)


def test_episodes_of_another_machine_stay_until_they_are_played_anew(tmp_path: Path) -> None:
    rows = [row_of("fire", "fetch", result, 1.0) for result in episodes()]
    before = whole(through_a_file([{**row, "frames": 7} for row in rows], tmp_path / "scores.csv"))
    both = merged(before, rows[:4])
    assert [row["frames"] == 7 for row in both if row["agent"] == "oracle"] == [False] * 3
    assert [row["frames"] == 7 for row in both if row["agent"] == "planner"] == [False, True, True]
    assert len(both) == len(rows)


def test_rows_without_all_columns_make_no_table(tmp_path: Path) -> None:
    row = row_of("fire", "fetch", episodes()[0], 1.0)
    old = {name: value for name, value in row.items() if name != "last_rescue"}
    assert whole(through_a_file([old], tmp_path / "scores.csv")) == []
