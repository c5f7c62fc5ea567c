"""Homes and streets in which decisions count: `./run python results/homes.py [TASK...] [SCENES]`; resumes.

Every agent plays so many scenes, 4 by default, of the split `test` of each task with measures, from number FIRST on.
Writes homes.md and homes.csv beside this file; episodes in homes.csv are not played again: those that a change would
touch are to be deleted there. With `tables` alone it plays nothing.
"""

from __future__ import annotations

import csv
import os
import subprocess
import sys
from collections.abc import Mapping

from hazard_ms.evaluation.comparison.pairing import Episode, difference, regret
from hazard_ms.evaluation.metrics import Score
from hazard_ms.spec.checks import one_of
from results.tables import COMMAND, HERE, machine, results_in, words

RAW, FILE = HERE.parent / "build" / "homes", HERE / "homes.csv"
TASKS = {"house fire": "HazardHouseFire-v1", "house flood": "HazardHouseFlood-v1", "gale": "HazardGale-v1"}
SCENES = 4
FIRST = 11  # what happened in those before was read while the agents were made
PLAIN = "oracle:mitigate=false"
AGENTS = ("random", "rule", "greedy", "mcts", "planner", PLAIN, "oracle")
# (the one that should be above, the other): docs/benchmark.md
PAIRS = (
    ("rule", "random"),
    ("greedy", "rule"),
    ("planner", "greedy"),
    ("oracle", "planner"),
    ("oracle", "greedy"),
    ("oracle", PLAIN),
)
COLUMNS = ("task", "agent", "seed", "scene", "averted", "averted_of_all", "value", "wall_seconds")
Row = dict[str, str]
HEAD = """# Homes and gales

Made by `./run python results/homes.py`. Scenes of the split `test` from number {first} on, Fetch, presets `paper`, one
episode a scene; decisions in those before were read while the agents were made, and those of `planner` in house fires
11 to 19 while its search was made for dfd77f3, and in house floods 11 to 13, 15, 16 and 20 for 563fcc0. House fires:
`planner` and `greedy` of dfd77f3, `oracle` of 38eff11, `{plain}` of ee7150e, others of 563fcc0. House
floods: `greedy` of 2b85e1a in 11 to 20, all else of 563fcc0. Gales: `greedy` and `planner` of ee7150e, all others of
27eb575, before things ended in carts as surely as now.
`averted` is the share of the targets' value that would be lost if nobody acted and is not lost at the end, in percent,
with 95 % bootstrap intervals over scenes; differences are paired by scene. `{plain}` is the oracle that
takes no measures. homes.csv has every episode. Written at
{machine}.

| task | agent | averted | Value | s an episode | episodes |
|---|---|---|---|---|---|
"""
APART = """
| task | averted, less that of another | difference | episodes |
|---|---|---|---|
"""
SHARES = """
| task | agent | share of the oracle's averted | episodes |
|---|---|---|---|
"""


def play(task: str, scenes: int) -> None:
    """Play what is missing of so many `scenes` of a task from FIRST on, one scene after the other."""
    folder = RAW / task.replace(" ", "_")
    options = ["-e", TASKS[task], "-o", str(folder), "--split", "test", "--timeout", "1800"]
    there = {(row["agent"], int(row["seed"])) for row in rows() if row["task"] == task}
    for seed in range(FIRST, FIRST + scenes):
        agents = [agent for agent in AGENTS if (agent, seed) not in there]
        if not agents:
            continue
        one = ["-s", str(seed), "--episodes", "1", "--agents", *agents]
        subprocess.run([*COMMAND, "evaluate", *options, *one], cwd=HERE.parent, check=False)


def rows() -> list[Row]:
    """All episodes: those of homes.csv, and those of the raw results here, which take the place of the same there."""
    made: dict[tuple[str, str, str, str], Row] = {}
    if FILE.exists():
        with FILE.open(newline="", encoding="utf-8") as file:
            made = {(row["task"], row["agent"], row["seed"], row["scene"]): row for row in csv.DictReader(file)}
    for task in TASKS:
        folder = RAW / task.replace(" ", "_")
        for result in results_in(folder) if folder.is_dir() else []:
            told = result.to_dict()["score"] | {"task": task, "agent": result.agent, "seed": result.seed}
            told |= {"scene": result.scene, "wall_seconds": round(result.wall_seconds, 1)}
            row = {name: "" if told.get(name) is None else str(told[name]) for name in COLUMNS}
            made[row["task"], row["agent"], row["seed"], row["scene"]] = row
    order = {task: number for number, task in enumerate(TASKS)}
    return sorted(made.values(), key=lambda row: (order[row["task"]], AGENTS.index(row["agent"]), int(row["seed"])))


def column(every: list[Row], task: str, agent: str, name: str) -> dict[Episode, float]:
    """A column of each episode of an agent in a task, of those for which it is defined."""
    mine = [row for row in every if (row["task"], row["agent"]) == (task, agent) and row[name]]
    return {(int(row["seed"]), row["scene"]): float(row[name]) for row in mine}


def mean(own: Mapping[Episode, float]) -> Score:
    """The mean of shares, one of each scene."""
    return difference(own, dict.fromkeys(own, 0.0))


def tables(every: list[Row]) -> str:
    """The three tables."""
    text, apart, shares = "", APART, SHARES
    for task in TASKS:
        averted = {agent: own for agent in AGENTS if (own := column(every, task, agent, "averted"))}
        for agent, own in averted.items():
            value, seconds = (column(every, task, agent, name) for name in ("value", "wall_seconds"))
            cost = sum(seconds.values()) / len(seconds)
            text += f"| {task} | {agent} | {words(mean(own))} | {words(mean(value))} | {cost:.0f} | {len(own)} |\n"
            if agent != "oracle" and (both := own.keys() & averted.get("oracle", {}).keys()):
                left = regret(own, averted["oracle"])
                ends = (None if end is None else 1.0 - end for end in (left.mean, left.high, left.low))
                shares += f"| {task} | {agent} | {words(Score(*ends))} | {len(both)} |\n"
        for one, other in PAIRS:
            if both := averted.get(one, {}).keys() & averted.get(other, {}).keys():
                told = words(difference(averted[one], averted[other]))
                apart += f"| {task} | {one} less {other} | {told} | {len(both)} |\n"
    return text + apart + shares


def main(wanted: list[str]) -> None:
    """Play the tasks called `wanted`, or all, and write the tables. Raises ValueError for an unknown task."""
    scenes = int(wanted.pop()) if wanted and wanted[-1].isdecimal() else SCENES
    for task in [] if wanted == ["tables"] else [one_of(each, TASKS, "a task") for each in wanted] or [*TASKS]:
        play(task, scenes)
    every = rows()
    with FILE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(every)
    text = HEAD.format(machine=machine(), plain=PLAIN, first=FIRST) + tables(every)
    (HERE / "homes.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(sys.argv[1:])
