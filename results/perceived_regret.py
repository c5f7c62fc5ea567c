"""What agents with their own eyes lose, and why: `./run python results/perceived_regret.py [TASK-AGENT...] [SCENES]`.

Plays the first scenes, 5 by default, of each task's split `test` with `--perception small`, and judges every decision
(docs/regret.md); resumes where it stopped. Writes perceived_regret.md and perceived_regret.csv beside this file.
Episodes in perceived_regret.csv are not judged again. With `tables` alone it plays nothing.
"""

from __future__ import annotations

import csv
import os
import subprocess
import sys

import numpy as np

from hazard_ms.evaluation.regret.causes import MEMORY, MITIGATION, PARTS, PERCEPTION, EpisodeRegret
from results.tables import COMMAND, HERE, TASKS, asked, evaluate, machine, write_rows

RAW, FILE = HERE.parent / "build" / "perceived_regret", HERE / "perceived_regret.csv"
AGENTS, SCENES = ("greedy", "planner"), 5
SHOWN = tuple(part for part in PARTS if part != MITIGATION)  # which is a cause in homes alone
KEYS = ("task", "agent", "seed", "scene")
COLUMNS = (*KEYS, "start", "value", *SHOWN)
EYES = (PERCEPTION, MEMORY)
HEAD = """# What is lost with perception, and why

Made by `./run python results/perceived_regret.py`: decisions of agents with `--perception small` in the first scenes of
`test`, Fetch, presets `paper`, judged with hindsight (docs/regret.md). In percent of the value of all targets, means
over episodes: "best" is what the best plan from the start rescues, and what is lost is that less Value. "eyes": the
share of what is lost whose cause is perception or memory, with a 95 % bootstrap interval over scenes. Negative numbers:
skills went better than usual. perceived_regret.csv has every episode; they were judged at several commits.
Written at
{machine}.

| task | agent | best | Value | {parts} | eyes | episodes |
|---|---|---|---|{rules}|---|---|
"""
Row = dict[str, str]


def judge(task: str, agent: str, scenes: int) -> None:
    """Play and judge what is missing of an agent in the first `scenes` of a task."""
    there = {int(row["seed"]) for row in judged() if (row["task"], row["agent"]) == (task, agent)}
    folder = RAW / task / agent
    for seed in sorted(set(range(scenes)) - there):
        options = ("--split", "test", "--perception", "small", "--agents", agent, "-s", str(seed), "--episodes", "1")
        evaluate(task, folder, *options)
    if folder.is_dir():
        subprocess.run([*COMMAND, "regret", str(folder)], cwd=HERE.parent, check=True)


def judged() -> list[Row]:
    """All episodes: those of perceived_regret.csv, and those judged here, which take the place of the same."""
    made: dict[tuple[str, ...], Row] = {}
    if FILE.exists():
        with FILE.open(newline="", encoding="utf-8") as file:
            made = {tuple(row[name] for name in KEYS): row for row in csv.DictReader(file)}
    for task in TASKS:
        for path in sorted((RAW / task).glob("*/*.regret.json")):
            one = EpisodeRegret.read(path)
            keys = dict(zip(KEYS, (task, one.agent, str(one.seed), one.scene), strict=True))
            numbers = {"start": one.start, "value": one.value, **{part: one.lost[part] for part in SHOWN}}
            made[tuple(keys.values())] = {**keys, **{name: f"{number:.6f}" for name, number in numbers.items()}}
    tasks = list(TASKS)
    return sorted(made.values(), key=lambda r: (tasks.index(r["task"]), AGENTS.index(r["agent"]), int(r["seed"])))


def share_of_eyes(mine: list[Row]) -> str:
    """The share [%] of all that is lost which perception and memory cause, with its interval over episodes."""
    causes = np.array([sum(float(row[cause]) for cause in EYES) for row in mine])
    lost = np.array([float(row["start"]) - float(row["value"]) for row in mine])
    drawn = np.random.default_rng(0).integers(0, len(mine), (10_000, len(mine)))
    low, high = np.percentile(100.0 * causes[drawn].sum(1) / lost[drawn].sum(1), (2.5, 97.5))
    return f"{100.0 * causes.sum() / lost.sum():.0f} [{low:.0f}, {high:.0f}]"


def line(task: str, agent: str, mine: list[Row]) -> str:
    """The line of an agent in a task."""
    means = [100.0 * np.mean([float(row[name]) for row in mine]) for name in ("start", "value", *SHOWN)]
    cells = [f"{mean:.1f}" for mean in means]
    return f"| {task} | {agent} | {' | '.join(cells)} | {share_of_eyes(mine)} | {len(mine)} |\n"


def main(wanted: list[str]) -> None:
    """Judge the agents called `wanted`, or all, and write the table. Raises ValueError for unknown names."""
    chosen, scenes = asked(wanted, AGENTS, SCENES)
    for task, agent in chosen:
        judge(task, agent, scenes)
    every = judged()
    write_rows(FILE, COLUMNS, every)
    text = HEAD.format(machine=machine(), parts=" | ".join(SHOWN), rules="|".join("---" for _ in SHOWN))
    for task, agent in asked((), AGENTS, SCENES)[0]:
        mine = [row for row in every if (row["task"], row["agent"]) == (task, agent)]
        text += line(task, agent, mine) if mine else ""
    (HERE / "perceived_regret.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(sys.argv[1:])
