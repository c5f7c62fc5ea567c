"""Plays the splits that nobody trains on: `./run python results/splits.py [TASK...]`; resumes where it stopped.

With `tables` alone it plays nothing. The agents that are compared with `planner` play each scene of the splits
`new_objects`, `large` and `hard` once, with Fetch; their episodes of `test` are those of scores.csv. Writes splits.md
and splits.csv beside this file; episodes in splits.csv that this machine has no raw results of stay.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Mapping, Sequence

from hazard_ms.evaluation.comparison.pairing import Episode, difference
from hazard_ms.evaluation.metrics import Score
from hazard_ms.spec.checks import one_of
from hazard_ms.tasks import task_of
from results.make import SCENES
from results.rows import COLUMNS, Row, merged, read, row_of
from results.tables import HERE, TASKS, evaluate, machine, results_in, words

RAW = HERE.parent / "build" / "splits"
FILE = HERE / "splits.csv"
AGENTS = ("planner", "greedy", "mcts")
TEST, OTHERS = "test", ("new_objects", "large", "hard")
HEAD = """# The planner on every split that nobody trains on

Made by `./run python results/splits.py`: the scenes of the splits `test`, `new_objects`, `large` and `hard`
([benchmark.md](../docs/benchmark.md)), physics `paper`, Fetch, one episode in each scene; those of `test` are the first
25 seeds of [the tables of all agents](README.md). Value in percent, with 95 % bootstrap intervals over scenes;
differences are paired by scene. In `all of these`, every scene counts the same. A task has no line for a split that
has none of its scenes, or that was not played by all three. `splits.csv` has every episode. Written at {machine}.

| task | split | scenes | planner | greedy | mcts | planner less greedy | planner less mcts |
|---|---|---|---|---|---|---|---|
"""
COLUMNS_HERE = tuple(name for name in COLUMNS if name != "bound")


def scenes(task: str, split: str) -> tuple[str, ...]:
    """The names of the scenes of a split; none in splits of rooms alone for a task in streets."""
    try:
        return tuple(task_of(TASKS[task], "paper").scenes(split))
    except ValueError:
        return ()


def play(task: str) -> None:
    """Play what is missing of a task."""
    folder = RAW / task
    folder.mkdir(parents=True, exist_ok=True)
    for split in OTHERS:
        if chosen := scenes(task, split):
            options = ["-r", "fetch", "--split", split, "--episodes", str(len(chosen)), "--workers", "2"]
            evaluate(task, folder, *options, "--agents", *AGENTS, check=False)


def rows_of(task: str) -> list[Row]:
    """The rows of splits.csv of a task: those of before, and those of the raw results here."""
    made = [row_of(task, "fetch", result, float("nan")) for result in results_in(RAW / task)]
    now = [{name: row[name] for name in COLUMNS_HERE} for row in made]
    before = [{**row, "seed": int(row["seed"])} for row in read(FILE, task, "fetch")]
    return merged(before, now)


def values(rows: Sequence[Row], agent: str, chosen: Sequence[str]) -> dict[Episode, float]:
    """The Value of each of an agent's episodes in the `chosen` scenes."""
    mine = [row for row in rows if row["agent"] == agent and row["scene"] in chosen]
    return {(int(row["seed"]), row["scene"]): float(row["value"]) for row in mine}


def line(task: str, split: str, rows: Sequence[Row], chosen: Sequence[str]) -> str:
    """The line of a table for the `chosen` scenes; empty unless every agent has played all of them."""
    played = {agent: values(rows, agent, chosen) for agent in AGENTS}
    if not chosen or any(len(own) != len(chosen) for own in played.values()):
        return ""
    cells = [str(len(chosen)), *(words(mean(own)) for own in played.values())]
    cells += [words(difference(played["planner"], played[other])) for other in AGENTS[1:]]
    return f"| {task} | {split} | {' | '.join(cells)} |\n"


def mean(own: Mapping[Episode, float]) -> Score:
    """The mean of Values, 0 to 1, one of each scene."""
    return difference(own, dict.fromkeys(own, 0.0))


def main(wanted: Sequence[str]) -> None:
    """Play the tasks called `wanted`, or all, and write the tables. Raises ValueError for an unknown task."""
    chosen = [] if list(wanted) == ["tables"] else [one_of(task, TASKS, "a task") for task in wanted] or [*TASKS]
    for task in chosen:
        play(task)
    text, every = HEAD.format(machine=machine()), []
    for task in TASKS:
        rows = rows_of(task)
        every += rows
        once = [row for row in read(HERE / "scores.csv", task, "fetch") if int(row["seed"]) < SCENES]
        by = {split: scenes(task, split) for split in (TEST, *OTHERS)}
        lines = {split: line(task, split, [*once, *rows], names) for split, names in by.items()}
        played = [split for split, told in lines.items() if told]
        text += "".join(lines.values())
        if len(played) > 1:
            text += line(task, "all of these", [*once, *rows], [name for split in played for name in by[split]])
    with FILE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS_HERE, lineterminator="\n")
        writer.writeheader()
        writer.writerows(every)
    (HERE / "splits.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main(sys.argv[1:])
