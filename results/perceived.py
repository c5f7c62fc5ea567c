"""The track with perception: `./run python results/perceived.py [TASK-AGENT...] [SCENES]`; resumes where it stopped.

Every agent plays the first scenes, 25 by default, of each task's split `test` and sees through our small detector.
Writes perceived.md and perceived.csv beside this file, with the same agents' scores of scores.csv and the paper's.
Episodes in perceived.csv are not played again; those with other eyes than the detector has today stay beside them.
With `tables` alone it plays nothing.
"""

from __future__ import annotations

import csv
import os
import sys
from dataclasses import asdict

from hazard_ms.evaluation.comparison.pairing import Episode, difference
from hazard_ms.evaluation.metrics import Tally, scores
from hazard_ms.sensing.detection.perception import eyes_of
from results.tables import HERE, TASKS, asked, evaluate, machine, results_in, words, write_rows

RAW, FILE = HERE.parent / "build" / "perceived", HERE / "perceived.csv"
AGENTS = ("random", "rule", "greedy", "mcts", "planner")
DETECTOR, SCENES = "small", 25
KEYS = ("task", "agent", "eyes", "seed", "scene")
COLUMNS = (*KEYS, "value_rescued", "value_total", "rescued", "rescued_damaged", "last_rescue", "wall_seconds")
Row = dict[str, str]
# Value with perception in fire, flood and wind: Zhou et al. 2024, docs/benchmark.md section 4.1
PAPER = {
    "greedy": (35.5, 21.5, 0.2),
    "random": (41.3, 26.7, 5.0),
    "rule": (34.5, 22.6, 0.0),
    "RL": (45.8, 33.1, 8.5),
    "MCTS": (59.2, 30.6, 18.0),
    "Llama": (56.2, 34.1, 16.2),
    "GPT-3.5": (63.5, 38.5, 16.2),
    "GPT-4": (67.7, 38.2, 33.9),
}
HEAD = """# With perception

Made by `./run python results/perceived.py`. Agents see through `--perception small`: segmentation is withheld, things
are found by the package's detector and followed by tracks of our own. First scenes of `test`, Fetch, presets `paper`.
Values are in percent, with 95 % bootstrap intervals over scenes; "less the truth" is the difference from the same
agent that is told what its camera sees, paired by episode (results/README.md). "eyes": the camera's picture, in pixels,
and its angle; today the detector's are {eyes}, and rows of others were played with earlier agents. A dash: not played.
An episode has one of two busy cores, or less. perceived.csv has every episode; they were played at several commits,
with the weights of the time. Written at
{machine}.

| task | agent | eyes | Value | less the truth | Step | Damage | s an episode | episodes |
|---|---|---|---|---|---|---|---|---|
"""
OTHERS = """
The paper's agents with its own detector (Mask R-CNN, tuned on pictures of its training scenes), in the original's
simulator, Value:

| agent | fire | flood | wind |
|---|---|---|---|
"""


def play(task: str, agent: str, scenes: int = SCENES) -> None:
    """Play what is missing of an agent in the first `scenes` of a task."""
    mine = (task, agent, eyes_of(DETECTOR))
    there = {int(row["seed"]) for row in episodes() if (row["task"], row["agent"], row["eyes"]) == mine}
    for seed in set(range(scenes)) - there:
        options = ("--split", "test", "--perception", DETECTOR, "--agents", agent, "-s", str(seed), "--episodes", "1")
        evaluate(task, RAW / task, *options)


def episodes() -> list[Row]:
    """All episodes: those of perceived.csv, and those of the raw results here, which take the place of the same."""
    made: dict[tuple[str, ...], Row] = {}
    if FILE.exists():
        with FILE.open(newline="", encoding="utf-8") as file:
            made = {tuple(row[name] for name in KEYS): row for row in csv.DictReader(file)}
    for task in TASKS:
        for result in results_in(RAW / task) if (RAW / task).is_dir() else []:
            keys = dict(zip(KEYS, (task, result.agent, result.eyes, str(result.seed), result.scene), strict=True))
            told = {**asdict(result.tally), "wall_seconds": round(result.wall_seconds, 1)}
            made[tuple(keys.values())] = {**keys, **{name: str(value) for name, value in told.items()}}
    tasks = list(TASKS)
    return sorted(
        made.values(), key=lambda r: (tasks.index(r["task"]), AGENTS.index(r["agent"]), r["eyes"], int(r["seed"]))
    )


def tally_of(row: Row) -> Tally:
    """The tally of an episode of perceived.csv."""
    rescued, value, total = int(row["rescued"]), float(row["value_rescued"]), float(row["value_total"])
    return Tally(value, total, rescued, int(row["rescued_damaged"]), int(row["last_rescue"]))


def told(task: str, agent: str) -> dict[Episode, float]:
    """The Value of each episode of scores.csv that an agent of Fetch played in a task with the truth."""
    with (HERE / "scores.csv").open(newline="", encoding="utf-8") as file:
        mine = [
            row for row in csv.DictReader(file) if (row["task"], row["robot"], row["agent"]) == (task, "fetch", agent)
        ]
    return {(int(row["seed"]), row["scene"]): float(row["value"]) for row in mine}


def line(task: str, agent: str, eyes: str, mine: list[Row]) -> str:
    """The line of an agent in a task with some eyes."""
    tallies, scenes = [tally_of(row) for row in mine], [row["scene"] for row in mine]
    own = {(int(row["seed"]), row["scene"]): tally.value for row, tally in zip(mine, tallies, strict=True)}
    truth, every = told(task, agent), scores(tallies, scenes)
    step, damage = (every[name].mean for name in ("step", "damage"))
    less = words(difference(own, truth)) if set(own) & set(truth) else "-"
    cells = [words(every["value"]), less, "-" if step is None else f"{step:.0f}"]
    seconds = sum(float(row["wall_seconds"]) for row in mine) / len(mine)
    cells += ["-" if damage is None else f"{100 * damage:.1f}", f"{seconds:.0f}", str(len(mine))]
    return f"| {task} | {agent} | {eyes} | {' | '.join(cells)} |\n"


def lines(every: list[Row]) -> str:
    """The lines of all agents."""
    groups: dict[tuple[str, ...], list[Row]] = {}
    for row in every:
        groups.setdefault((row["task"], row["agent"], row["eyes"]), []).append(row)
    return "".join(line(task, agent, eyes, mine) for (task, agent, eyes), mine in groups.items())


def main(wanted: list[str]) -> None:
    """Play the agents called `wanted`, or all, and write the table. Raises ValueError for unknown names."""
    chosen, scenes = asked(wanted, AGENTS, SCENES)
    for task, agent in chosen:
        play(task, agent, scenes)
    every = episodes()
    write_rows(FILE, COLUMNS, every)
    text = HEAD.format(machine=machine(), eyes=eyes_of(DETECTOR)) + lines(every) + OTHERS
    text += "".join(f"| {name} | {' | '.join(map(str, values))} |\n" for name, values in PAPER.items())
    (HERE / "perceived.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(sys.argv[1:])
