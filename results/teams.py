"""Two robots in the scenes of one: `./run python results/teams.py [oracle] [TASK...] [SCENES]`, or `cost`; resumes.

Every one of SETUPS but the reference plays the first scenes, 4 by default, of the split `test` of each task, one scene
after another, by `hazard-ms evaluate`; with `oracle` the reference alone does. Writes teams.md and teams.csv beside
this file; episodes in teams.csv are not played again: those that a change would touch are to be deleted there. With
`tables` alone it plays nothing. `cost` prints what a frame costs with one robot and with two, a ratio of medians of
frames that take turns.
"""

from __future__ import annotations

import csv
import math
import os
import statistics
import sys
import time
from typing import Any

import gymnasium as gym

from hazard_ms.evaluation.comparison.pairing import Episode, difference
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.spec.checks import one_of
from results.tables import HERE, evaluate, machine, results_in, words

RAW, FILE = HERE.parent / "build" / "teams", HERE / "teams.csv"
TASKS = {
    "fire": "HazardFire-v1",
    "flood": "HazardFlood-v1",
    "wind": "HazardWind-v1",
    "house fire": "HazardHouseFire-v1",
    "gale": "HazardGale-v1",
}
SCENES = 4
ONE, PAIR = ("fetch",), ("fetch", "fetch")
SETUPS = {  # robots and agent of each team, by its name
    "1 greedy": (ONE, "greedy"),
    "1 planner": (ONE, "planner"),
    "2 independent": (PAIR, "independent"),
    "2 auction": (PAIR, "auction"),
    "2 joint": (PAIR, "joint"),
    "2 oracle": (PAIR, "oracle"),
}
REFERENCE, ASKED = "2 oracle", "oracle"  # it sees what is hidden; played where this word asks for it
SCORES = {"Value": "value", "averted": "averted"}  # columns of teams.csv
BEST, ONES, APART, AUCTION = "2 joint", ("1 planner", "1 greedy"), "2 independent", "2 auction"
KEYS = ("env_id", "seed", "scene", "robots", "agent")
BORNE = ("heat", "water")  # columns with a number for each robot, empty where nothing measures it
COLUMNS = (*KEYS, "value", "rescued", "targets", "frames", "robot_collisions", "averted", *BORNE)
Row = dict[str, str]
WARM_UP, TURNS, FRAMES = 60, 15, 40  # frames before it is timed; turns of each team, and the frames of one
HEAD = """# Two robots in the scenes of one

Made by `./run python results/teams.py`. First scenes of the split `test`, Fetch, presets `paper`; hazards act on the
robots in homes and gales alone. Two robots are on their own, each `greedy` (`2 independent`), hold auctions, or plan
together; `2 oracle`, where it was played, sees what is hidden. Value and what was averted in percent, with 95 %
bootstrap intervals over scenes, averted only of scenes where it is defined; collisions are contacts between robots at
more than 0.1 m/s, of all episodes together. teams.csv has every episode. Rows of two robots are of commits 6824f3d to
6e850c1, which differ in what ended three episodes of `2 joint` with an error: these were played again. 15 rows of one
robot in homes are of the day before; `1 greedy` and `1 planner` in wind and gales are of 95ddc75.
Written at
{machine}.

| task | team | Value | averted | frames | collisions | episodes |
|---|---|---|---|---|---|---|
"""
COMPARED = """
| task | score | `2 joint` over `1 planner` | over `1 greedy` | less `2 independent` | less `2 auction` | episodes |
|---|---|---|---|---|---|---|
"""


def episodes() -> list[Row]:
    """All episodes: those of teams.csv, and those of the raw results here, which take the place of the same."""
    rows: list[Row] = []
    if FILE.exists():
        with FILE.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    rows += [row_of(result) for folder in RAW.glob("*") for result in results_in(folder)]
    made = {tuple(row[name] for name in KEYS): row for row in rows}
    ids, names = [*TASKS.values()], [*SETUPS]
    return sorted(made.values(), key=lambda r: (ids.index(r["env_id"]), names.index(setup_of(r)), int(r["seed"])))


def row_of(result: EpisodeResult) -> Row:
    """The row of an episode in teams.csv."""
    robots, tally = result.settings["robot_uids"], result.tally
    loads = [result.loads] if result.robot_loads is None else result.robot_loads.values()
    borne = {name: [getattr(load, name, None) for load in loads] for name in BORNE}
    told: dict[str, Any] = {
        "env_id": result.env_id,
        "seed": result.seed,
        "scene": result.scene,
        "robots": robots if isinstance(robots, str) else " ".join(robots),
        "agent": result.agent,
        "value": tally.value,
        "rescued": tally.rescued,
        "targets": len(result.targets),
        "frames": result.frames,
        "robot_collisions": result.robot_collisions or 0,
        "averted": "" if result.averted is None else result.averted,
        **{name: " ".join(str(one) for one in own if one is not None) for name, own in borne.items()},
    }
    return {name: str(value) for name, value in told.items()}


def setup_of(row: Row) -> str:
    """The name of the team that played an episode."""
    played = (tuple(row["robots"].split()), row["agent"])
    return next(name for name, setup in SETUPS.items() if setup == played)


def write(every: list[Row]) -> None:
    """Write teams.csv and teams.md."""
    with FILE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(every)
    (HERE / "teams.md").write_text(HEAD.format(machine=machine()) + tables(every), encoding="utf-8")


def tables(every: list[Row]) -> str:
    """What each team rescues in each task, and how far the best one is ahead."""
    text, compared = "", ""
    for task, env_id in TASKS.items():
        scores: dict[str, dict[str, dict[Episode, float]]] = {score: {} for score in SCORES}
        for name in SETUPS:
            mine = [r for r in every if (r["env_id"], setup_of(r)) == (env_id, name)]
            if not mine:
                continue
            for score, column in SCORES.items():
                own = {(int(r["seed"]), r["scene"]): float(r[column]) for r in mine if r[column]}
                if own:
                    scores[score][name] = own
            rows = [values.get(name, {}) for values in scores.values()]
            means = [words(difference(own, dict.fromkeys(own, 0.0))) if own else "-" for own in rows]
            frames = statistics.mean(int(r["frames"]) for r in mine)
            hits = sum(int(r["robot_collisions"]) for r in mine)
            text += f"| {task} | {name} | {' | '.join(means)} | {frames:.0f} | {hits} | {len(mine)} |\n"
        for score, values in scores.items():
            if {BEST, *ONES, APART} <= values.keys():
                compared += f"| {task} | {score} | {_ahead(values)} |\n"
    return text + COMPARED + compared


def _ahead(values: dict[str, dict[Episode, float]]) -> str:
    """How far the best team is ahead of the others, and in how many episodes all of one robot were played, too."""
    each = set.intersection(*(set(values[name]) for name in (BEST, *ONES)))
    sums = {name: sum(values[name][e] for e in each) for name in (BEST, *ONES)}
    over = [f"{sums[BEST] / sums[one] if sums[one] else math.nan:.2f}" for one in ONES]
    less = [
        f"{words(difference(values[BEST], values[name]))} of {len(values[BEST].keys() & values[name].keys())}"
        if name in values
        else "-"
        for name in (APART, AUCTION)
    ]
    return " | ".join([*over, *less, str(len(each))])


def play(env_id: str, scenes: int, reference: bool = False) -> None:
    """Play what is missing of the first `scenes` of a task, of the `reference` or the others, and write it at once."""
    for seed in range(scenes):
        for name, (robots, agent) in SETUPS.items():
            if (name == REFERENCE) != reference:
                continue
            if (env_id, name, str(seed)) not in {(r["env_id"], setup_of(r), r["seed"]) for r in episodes()}:
                told = ("--split", "test", "--agents", agent, "-s", str(seed), "--episodes", "1", "-r", *robots)
                evaluate(env_id, RAW / name.replace(" ", "-"), *told, check=False)
                write(episodes())


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
    reference = ASKED in wanted
    wanted = [word for word in wanted if word != ASKED]
    scenes = int(wanted.pop()) if wanted and wanted[-1].isdecimal() else SCENES
    for task in [] if wanted == ["tables"] else [one_of(each, TASKS, "a task") for each in wanted] or [*TASKS]:
        play(TASKS[task], scenes, reference)
    write(episodes())
    print((HERE / "teams.md").read_text(encoding="utf-8"))


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(sys.argv[1:])
