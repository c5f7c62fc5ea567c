"""Policies that look through the robot's cameras: `./run python results/imitation.py POLICY... [--episodes 25]`.

Each POLICY is a folder that `examples/act_from_pictures.py train` has written. It plays the first seeds of the split
`test` in calm, in fire and in flood, and so does the agent that demonstrated. What is in imitation.csv is not played
again; imitation.md, beside it, is the table. Without a POLICY only the table is written.
"""

from __future__ import annotations

import argparse
import csv
import importlib.util
import json
import math
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from results.tables import COMMAND, HERE, machine, results_in

FILE, EXAMPLE = HERE / "imitation.csv", HERE.parent / "examples" / "act_from_pictures.py"
RAW = HERE.parent / "build" / "imitation"
COLUMNS = ("task", "who", "hazards", "seed", "success")
WORLDS = ("calm", "fire", "flood")
TEACHER = "oracle"
DONE = ("arrived", "in the hand", "in the bag")  # how episodes of practice end that succeed
Z = 1.959964  # of a 95 % interval
HEAD = """# Policies from pictures

Made by `./run python results/imitation.py` from `imitation.csv`. Success in percent with 95 % intervals (Wilson 1927)
in rooms of `test`, which no demonstration shows. The policies see pictures of head and wrist, and feel their joints;
`{teacher}`, which demonstrated, is told where things are. Hazards have the preset `paper`. Both policies learned from
396 demonstrations without and 440 with `--perturb control:2`: `pick_up-1` for 18 minutes with the seed 1, `pick_up-0`
for 16 with the seed 0, after 60 in which it was judged by absolute errors.
Written at
{machine}.

| task | | {worlds} |
|---|---|---|---|---|
"""
Row = dict[str, str]


def read() -> list[Row]:
    """The rows that there are."""
    if not FILE.exists():
        return []
    with FILE.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def add(rows: list[Row], task: str, who: str, world: str, successes: dict[int, bool]) -> None:
    """Append what was played, and write all rows."""
    for seed, success in successes.items():
        rows.append(dict(zip(COLUMNS, (task, who, world, str(seed), str(int(success))), strict=True)))
    with FILE.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


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


def example() -> Any:
    """The module of the example."""
    spec = importlib.util.spec_from_file_location("act_from_pictures", EXAMPLE)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def main() -> None:
    """Play what is missing, and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("policies", nargs="*", type=Path)
    parser.add_argument("--episodes", type=int, default=25)
    given = parser.parse_args()
    rows, acting = read(), example()
    for policy in given.policies:
        task = json.loads((policy / "settings.json").read_text())["task"]
        for world in WORLDS:
            if left := missing(rows, task, TEACHER, world, given.episodes):
                known = taught(task, world, given.episodes)
                add(rows, task, TEACHER, world, {seed: known[seed] for seed in left})
            if left := missing(rows, task, policy.name, world, given.episodes):
                hazards = [] if world == WORLDS[0] else [world]
                won = acting.play(policy, len(left), left.start, "test", hazards)
                add(rows, task, policy.name, world, dict(zip(left, won, strict=True)))
    head = HEAD.format(teacher=TEACHER, machine=machine(), worlds=" | ".join(WORLDS))
    (HERE / "imitation.md").write_text(head + "".join(lines(rows)))


if __name__ == "__main__":
    main()
