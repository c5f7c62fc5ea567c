"""Policies that were shown how: `./run python results/imitation.py [POLICY...] [--rescues WEIGHTS...] [--episodes 25]`.

Each POLICY is a folder that `examples/act_from_pictures.py train` has written, or one with folders `walk` and `take` of
`examples/fetch_from_pictures.py`. It plays the first seeds of the split `test` in calm, in fire and in flood, and so
does the agent that demonstrated. Each of WEIGHTS is one that
`examples/rescue/learn.py train` has written: it plays whole rescues, and so does the agent that decides for it. What is
in imitation.csv and rescues.csv is not played again; imitation.md, beside them, is the tables. Without a folder only
they are written.
"""

from __future__ import annotations

import argparse
import csv
import importlib
import json
import math
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from hazard_ms.evaluation.metrics import interval, resampled
from results.tables import COMMAND, HERE, evaluate, machine, results_in
from results.tables import words as written

FILE, EXAMPLES = HERE / "imitation.csv", HERE.parent / "examples"
RAW = HERE.parent / "build" / "imitation"
RESCUES, MOVING = HERE / "rescues.csv", EXAMPLES / "rescue" / "policies.py"
COLUMNS = ("task", "who", "hazards", "seed", "success")
RESCUE_COLUMNS = ("task", "who", "scene", "seed", "rescued", "frames")
RESCUE_TASKS = ("fire", "flood")
DECIDES = "greedy"
WORLDS = ("calm", "fire", "flood")
PARTS = ("walk", "take")  # of a policy that fetches
TEACHER = "oracle"
DONE = ("arrived", "in the hand", "in the bag")  # how episodes of practice end that succeed
Z = 1.959964  # of a 95 % interval
HEAD = """# Policies from pictures

Made by `./run python results/imitation.py` from `imitation.csv`. Success in percent with 95 % intervals (Wilson 1927)
in rooms of `test`, which no demonstration shows. The policies see pictures of head and wrist, and feel their joints;
`{teacher}`, which demonstrated, is told where things are. Hazards have the preset `paper`. The policies of pick-ups
learned from 396 demonstrations without and 440 with `--perturb control:2`: `pick_up-1` and `pick_up-2` for 18 minutes
with the seeds 1 and 2 (about 3,700 and 2,886 steps, beside other work), `pick_up-0` for 16 with the seed 0, after 60 in
which it was judged by absolute errors. `fetch_calm-0` walks by what it learned from 6,300 looks in calm, in
two runs of 14 minutes with the seeds 0 and 10 (2,069 and 1,979 steps, beside other work), and takes by what it learned
in 18 with the seed 0 from 283 demonstrations of HazardStow-v1 in calm with `--perturb control:2` (3,096 steps).
`fetch-0` takes the same way, and its walk learned on for 9 minutes with the seed 20 (1,866 steps), also from 1,080
looks beside a fire and 720 in a flood. `fetch-1` walks by what it learned from all these looks in 16 minutes with the
seed 1 (2,655 steps), and takes by what it learned in 14 (2,855 steps); `fetch-2` the same with the seed 2, each in 14
minutes (3,864 and 4,188 steps, with most of a core each). That `fetch_calm-0` failed in the first four rooms beside a
fire was seen before the looks beside hazards were added. Of fewer than 25 rooms time allowed the first.
Written at
{machine}.

| task | | {worlds} |
|---|---|---|---|---|
"""
RESCUED = """
## Whole rescues

{decides} decides in all rows; in the others each of its walks, reaches and stows is flown by a policy, that of
`examples/rescue`. `value` is the benchmark's Value in percent with its 95 % interval, then as a share of {decides}'s in
the same rooms of `test`; the number in a name is the seed. Reaches and stows learned from frames that the commands of
docs/imitation.md recorded in rooms of `train` (`demonstrate` with `--seeds 0 75 15`); walks from those and from 30
rescues that an earlier `demonstrate` had recorded, in a training of 12 epochs of their own. The code is that of commit
d86a28f.

| | {tasks} |
|---|---|---|
"""
Row = dict[str, str]


def read(path: Path) -> list[Row]:
    """The rows that there are."""
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def write(path: Path, columns: Sequence[str], rows: list[Row]) -> None:
    """Write all rows."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def add(rows: list[Row], task: str, who: str, world: str, successes: dict[int, bool]) -> None:
    """Append what was played, and write all rows."""
    for seed, success in successes.items():
        rows.append(dict(zip(COLUMNS, (task, who, world, str(seed), str(int(success))), strict=True)))
    write(FILE, COLUMNS, rows)


def missing(rows: Sequence[Row], task: str, who: str, world: str, episodes: int) -> range:
    """The seeds that are not played yet."""
    played = sum((row["task"], row["who"], row["hazards"]) == (task, who, world) for row in rows)
    return range(played, max(played, episodes))


def taught(task: str, world: str, episodes: int) -> dict[int, bool]:
    """What the agent that demonstrated does."""
    folder = RAW / f"{task}-{world}"
    words = ["-e", task, "--load", "hazard_ms.tasks.practice", "--agents", TEACHER, "--split", "test", "--workers", "1"]
    words += ["--hazards", world] if world != WORLDS[0] else []
    done = [*COMMAND, "evaluate", *words, "--episodes", str(episodes), "-o", str(folder)]
    subprocess.run(done, cwd=HERE.parent, check=True)
    return {one.seed: one.ended in DONE for one in results_in(folder)}


def wilson(successes: int, count: int) -> tuple[float, float]:
    """The ends of the 95 % interval of a share, 0 to 1."""
    middle, more = successes / count + Z * Z / (2 * count), 1.0 + Z * Z / count
    half = Z * math.sqrt(successes / count * (1 - successes / count) / count + (Z / (2 * count)) ** 2)
    return (middle - half) / more, (middle + half) / more


def lines(rows: Sequence[Row]) -> Iterator[str]:
    """The lines of the table."""
    for task, who in dict.fromkeys((row["task"], row["who"]) for row in rows):
        cells = []
        for world in WORLDS:
            own = [row for row in rows if (row["task"], row["who"], row["hazards"]) == (task, who, world)]
            wins = sum(int(row["success"]) for row in own)
            low, high = wilson(wins, len(own)) if own else (0.0, 0.0)
            told = f"{100 * wins / len(own):.0f} [{100 * low:.0f}, {100 * high:.0f}] of {len(own)}" if own else ""
            cells.append(told)
        yield f"| {task} | {who} | {' | '.join(cells)} |\n"


def rescued(rows: list[Row], task: str, who: str, agent: str, episodes: int) -> None:
    """Play the whole rescues of an agent that are missing, append and write them."""
    played = [row for row in rows if (row["task"], row["who"]) == (task, who)]
    if len(played) < episodes:
        folder = RAW / f"rescue-{task}-{who}"
        evaluate(task, folder, "--agents", agent, "--split", "test", "--episodes", str(episodes))
        for one in results_in(folder)[len(played) :]:
            told = (task, who, one.scene, str(one.seed), repr(one.tally.value), str(one.frames))
            rows.append(dict(zip(RESCUE_COLUMNS, told, strict=True)))
        write(RESCUES, RESCUE_COLUMNS, rows)


def rescue_lines(rows: Sequence[Row]) -> Iterator[str]:
    """The lines of the table of whole rescues."""
    for who in dict.fromkeys(row["who"] for row in rows):
        cells = []
        for task in RESCUE_TASKS:
            own, base = ([r for r in rows if (r["task"], r["who"]) == (task, name)] for name in (who, DECIDES))
            if not own:
                cells.append("")
                continue
            seeds, values = {row["seed"] for row in own}, np.array([(float(row["rescued"]), 1.0) for row in own])
            drawn = resampled(values, [row["scene"] for row in own], seed=0)
            score = interval(float(values[:, 0].mean()), drawn[:, 0] / drawn[:, 1])
            most = np.mean([float(row["rescued"]) for row in base if row["seed"] in seeds])
            share = f"; {100 * values[:, 0].mean() / most:.0f} %" if who != DECIDES else ""
            cells.append(f"{written(score)} of {len(own)}{share}")
        yield f"| {who} | {' | '.join(cells)} |\n"


def won(policy: Path, seeds: range, world: str) -> list[bool]:
    """Whether a policy succeeds, seed by seed."""
    sys.path.insert(0, str(EXAMPLES))
    played = {"episodes": len(seeds), "seed": seeds.start, "hazards": () if world == WORLDS[0] else (world,)}
    if (policy / PARTS[0]).is_dir():
        return importlib.import_module("fetch_from_pictures").play(*(policy / part for part in PARTS), **played)
    return importlib.import_module("act_from_pictures").play(policy, **played)


def main() -> None:
    """Play what is missing, and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("policies", nargs="*", type=Path)
    parser.add_argument("--episodes", type=int, default=25)
    parser.add_argument("--rescues", nargs="*", type=Path, default=[])
    given = parser.parse_args()
    rows, rescues = read(FILE), read(RESCUES)
    for task in RESCUE_TASKS if given.rescues else ():
        rescued(rescues, task, DECIDES, DECIDES, given.episodes)
        for folder in given.rescues:
            rescued(rescues, task, folder.name, f"{MOVING}:Policies:weights={folder.resolve()}", given.episodes)
    for policy in given.policies:
        part = policy / PARTS[0] if (policy / PARTS[0]).is_dir() else policy
        task = json.loads((part / "settings.json").read_text())["env"]["task"]
        for world in WORLDS:
            if left := missing(rows, task, TEACHER, world, given.episodes):
                known = taught(task, world, given.episodes)
                add(rows, task, TEACHER, world, {seed: known[seed] for seed in left})
            if left := missing(rows, task, policy.name, world, given.episodes):
                add(rows, task, policy.name, world, dict(zip(left, won(policy, left, world), strict=True)))
    head = HEAD.format(teacher=TEACHER, machine=machine(), worlds=" | ".join(WORLDS))
    more = RESCUED.format(decides=DECIDES, tasks=" | ".join(RESCUE_TASKS)) + "".join(rescue_lines(rescues))
    (HERE / "imitation.md").write_text(head + "".join(lines(rows)) + (more if rescues else ""))


if __name__ == "__main__":
    main()
