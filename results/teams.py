"""Two robots in the scenes of one: `./run python results/teams.py [TASK...] [SCENES]`, or `cost`; resumes.

Every team of hazard_ms.bench.teams plays the first scenes, 4 by default, of the split `test` of each task, one scene
after another. Writes teams.md and teams.csv beside this file; episodes in teams.csv are not played again: those that a
change would touch are to be deleted there. With `tables` alone it plays nothing. `cost` prints what a frame costs with
one robot and with two, a ratio of medians of frames that take turns.
"""

from __future__ import annotations

import csv
import os
import statistics
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, fields
from typing import Any

import gymnasium as gym

from hazard_ms.bench.teams import SETUPS, TeamResult, measure
from hazard_ms.evaluation.comparison.pairing import Episode, difference
from hazard_ms.spec.checks import one_of
from results.tables import HERE, machine, words

FILE = HERE / "teams.csv"
TASKS = {
    "fire": "HazardFire-v1",
    "flood": "HazardFlood-v1",
    "wind": "HazardWind-v1",
    "house fire": "HazardHouseFire-v1",
    "gale": "HazardGale-v1",
}
SCENES = 4
NAMES = {setup: f"{len(setup[0])} {setup[1]}" for setup in SETUPS}
BEST, ALONE, APART = "2 joint", "1 independent:planner", "2 independent"
BORNE = ("heat", "water")  # columns with a number for each robot, empty where nothing measures it
COLUMNS = tuple(field.name for field in fields(TeamResult))
WARM_UP, TURNS, FRAMES = 60, 15, 40  # frames before it is timed; turns of each team, and the frames of one
HEAD = """# Two robots in the scenes of one

Made by `./run python results/teams.py`. First scenes of the split `test`, Fetch, presets `paper`; hazards act on the
robots in homes and gales alone. `1 independent` is one greedy robot, `1 independent:planner` one that plans; two robots
are on their own (`2 independent`), hold auctions, or plan together. Value and what was averted in percent, with 95 %
bootstrap intervals over scenes, averted only of scenes where it is defined; collisions are contacts between robots at
more than 0.1 m/s, of all episodes together. teams.csv has every episode.
Written at
{machine}.

| task | team | Value | averted | frames | collisions | episodes |
|---|---|---|---|---|---|---|
"""
COMPARED = """
| task | Value of `2 joint` over that of `1 independent:planner` | less `2 independent` | less `2 auction` | episodes |
|---|---|---|---|---|
"""


def played() -> list[TeamResult]:
    """The episodes of teams.csv."""
    if not FILE.exists():
        return []
    with FILE.open(newline="", encoding="utf-8") as file:
        return [_read(row) for row in csv.DictReader(file)]


def _read(row: dict[str, str]) -> TeamResult:
    numbers: dict[str, Any] = {name: int(row[name]) for name in ("seed", "rescued", "targets", "frames")}
    numbers |= {"robot_collisions": int(row["robot_collisions"]), "value": float(row["value"])}
    numbers |= {"averted": float(row["averted"]) if row["averted"] else None}
    numbers |= {name: tuple(float(one) for one in row[name].split()) for name in BORNE}
    robots = tuple(row["robots"].split())
    return TeamResult(env_id=row["env_id"], scene=row["scene"], robots=robots, agent=row["agent"], **numbers)


def write(every: list[TeamResult]) -> None:
    """Write teams.csv and teams.md."""
    ids, names = [*TASKS.values()], [*NAMES]
    every.sort(key=lambda r: (ids.index(r.env_id), names.index((r.robots, r.agent)), r.seed))
    with FILE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(
            {**asdict(r), **{name: _listed(getattr(r, name)) for name in ("robots", *BORNE)}} for r in every
        )
    (HERE / "teams.md").write_text(HEAD.format(machine=machine()) + tables(every), encoding="utf-8")


def _listed(values: Sequence[Any]) -> str:
    return " ".join(str(value) for value in values if value is not None)


def tables(every: list[TeamResult]) -> str:
    """What each team rescues in each task, and how far the best one is ahead."""
    text, compared = "", ""
    for task, env_id in TASKS.items():
        values: dict[str, dict[Episode, float]] = {}
        for setup, name in NAMES.items():
            mine = [r for r in every if (r.env_id, r.robots, r.agent) == (env_id, *setup)]
            if not mine:
                continue
            own = values[name] = {(r.seed, r.scene): r.value for r in mine}
            mean = words(difference(own, dict.fromkeys(own, 0.0)))
            shares = {(r.seed, r.scene): r.averted for r in mine if r.averted is not None}
            kept = words(difference(shares, dict.fromkeys(shares, 0.0))) if shares else "-"
            frames, hits = statistics.mean(r.frames for r in mine), sum(r.robot_collisions for r in mine)
            text += f"| {task} | {name} | {mean} | {kept} | {frames:.0f} | {hits} | {len(mine)} |\n"
        if {BEST, ALONE, APART, "2 auction"} <= values.keys():
            both = values[BEST].keys() & values[ALONE].keys()
            one, two = (sum(values[name][e] for e in both) for name in (ALONE, BEST))
            less = " | ".join(words(difference(values[BEST], values[name])) for name in (APART, "2 auction"))
            compared += f"| {task} | {two / one if one else float('nan'):.2f} | {less} | {len(both)} |\n"
    return text + COMPARED + compared


def play(env_id: str, scenes: int) -> None:
    """Play what is missing of the first `scenes` of a task, and write it after each episode."""
    for seed in range(scenes):
        for robots, agent in NAMES:
            every = played()
            if (env_id, robots, agent, seed) not in {(r.env_id, r.robots, r.agent, r.seed) for r in every}:
                write([*every, *measure(env_id, [seed], robots, agent)])


def cost() -> None:
    """Print what a frame of two robots costs, over one of one robot, where all stand."""
    for task, env_id in TASKS.items():
        envs: list[Any] = []
        for robots in ("fetch", ("fetch", "fetch")):
            given: dict[str, Any] = {"obs_mode": "none", "render_backend": "none", "affects_agent": False}
            envs.append(gym.make(env_id, robot_uids=robots, control_mode="pd_joint_pos", **given))
            envs[-1].reset(seed=0)
        took: list[list[float]] = [[], []]
        for turn in range(TURNS + 1):
            for env, times in zip(envs, took, strict=True):
                still = {name: r.action(0.0, 0.0, r.tucked, True) for name, r in env.unwrapped.robots.items()}
                action = still if len(still) > 1 else next(iter(still.values()))
                frames = FRAMES if turn else WARM_UP
                start = time.perf_counter()
                for _ in range(frames):
                    env.step(action)
                if turn:
                    times.append((time.perf_counter() - start) / frames)
        one, two = (1e6 * statistics.median(times) for times in took)
        print(f"{task}: {one:.0f} us with one robot, {two:.0f} with two, {two / one:.2f} times", flush=True)
        for env in envs:
            env.close()


def main(wanted: list[str]) -> None:
    """Play the tasks called `wanted`, or all, and write the tables. Raises ValueError for an unknown task."""
    if wanted == ["cost"]:
        cost()
        return
    scenes = int(wanted.pop()) if wanted and wanted[-1].isdecimal() else SCENES
    for task in [] if wanted == ["tables"] else [one_of(each, TASKS, "a task") for each in wanted] or [*TASKS]:
        play(TASKS[task], scenes)
    write(played())
    print((HERE / "teams.md").read_text(encoding="utf-8"))


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(sys.argv[1:])
