"""Teams in the sketch beside those of the simulator: `./run python results/team_sketch.py`; plays no episode.

Compares the episodes of teams.csv in streets with the same scenes in the sketch, and with what teams could do there:
the best plan at usual times, and a bound. Writes team_sketch.md beside this file.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Mapping

import numpy as np
import torch
from scipy import stats

from hazard_ms.env.placing import starts
from hazard_ms.evaluation.comparison.pairing import Episode, difference
from hazard_ms.simulation import building
from hazard_ms.sketch.recording import recorded
from hazard_ms.sketch.scenes import sketch_scene
from hazard_ms.sketch.skill_times import load
from hazard_ms.sketch.teams.plans import team_bound, team_plan
from hazard_ms.sketch.teams.policies import mean_values
from hazard_ms.spec.catalogue import value_of
from hazard_ms.spec.registry.robots import robot_class
from hazard_ms.tasks import task_of
from results.tables import HERE, machine, words
from results.teams import TASKS, episodes, setup_of

WIND, ROBOT, PHYSICS = TASKS["wind"], "fetch", "paper"
TRIALS = 64  # rescues in the sketch for each episode, as in hazard_ms.sketch.fidelity
PLAYED = {"1 greedy": "independent", "2 independent": "independent", "2 auction": "auction"}  # teams of the sketch
OTHERS = ("1 planner", "2 joint", "2 oracle")  # which the sketch does not play
HEAD = """# Teams in the sketch

Made by `./run python results/team_sketch.py` from the episodes of teams.csv in streets (`HazardWind-v1`, split `test`,
Fetch). Value in percent, with 95 % bootstrap intervals over scenes; each scene is played {trials} times in the sketch.
The rank correlation is Spearman's, of the Values of scenes. Written at {machine}.

| team | simulator | sketch | sketch less simulator | rank correlation | scenes |
|---|---|---|---|---|---|
"""
SECOND = """
What is possible in these scenes: the best division of the targets if all is known and every skill takes its usual
time (`plan`, no bound: skills may be quicker), and a bound, for teams in which nobody takes what another one put down.
Shares are of means.

| robots | plan | bound | team | simulator | of the plan | of the bound |
|---|---|---|---|---|---|---|
"""


def played(team: str) -> dict[Episode, float]:
    """The Values of a team in streets, by seed and scene."""
    rows = [row for row in episodes() if (row["env_id"], setup_of(row)) == (WIND, team)]
    return {(int(row["seed"]), row["scene"]): float(row["value"]) for row in rows}


def sketched(team: str, real: Mapping[Episode, float]) -> dict[Episode, float]:
    """The mean Values of a team in the sketch, in the scenes of `real`."""
    task = task_of(WIND, PHYSICS)
    scenes = [sketch_scene(task, PHYSICS, task.build(name), seed, ROBOT) for seed, name in real]
    found = mean_values(PLAYED[team], scenes, [seed for seed, _ in real], load(ROBOT), int(team[0]), TRIALS)
    return dict(zip(real, found.tolist(), strict=True))


@functools.cache
def possible(robots: int, seed: int, name: str) -> tuple[float, float]:
    """The plan and the bound of so many robots in a scene."""
    task, build = task_of(WIND, PHYSICS), robot_class(ROBOT).build
    spec = task.build(name)
    world = building.make_world((spec,), torch.device("cpu"))
    places = starts(world, 0, [build] * robots)
    future, values = recorded(task, PHYSICS, spec, seed), [value_of(target) for target in spec.targets]
    plan = team_plan(future, spec, ROBOT, values, task.max_frames, places)
    return plan, team_bound(future, spec, build, values, task.max_frames, places)


def tables() -> str:
    """What the sketch says of each team, and what each made of what is possible."""
    text, second = "", ""
    for team in (*PLAYED, *OTHERS):
        real = played(team)
        if not real:
            continue
        nothing = dict.fromkeys(real, 0.0)
        mean = 100.0 * np.mean([*real.values()])
        if team in PLAYED:
            sketch = sketched(team, real)
            ranks = stats.spearmanr([*real.values()], [*sketch.values()]).statistic
            columns = (words(difference(real, nothing)), words(difference(sketch, nothing)))
            gap = words(difference(sketch, real))
            text += f"| {team} | {' | '.join(columns)} | {gap} | {ranks:.2f} | {len(real)} |\n"
        plan, bound = 100.0 * np.mean([possible(int(team[0]), *episode) for episode in real], axis=0)
        shares = f"{100.0 * mean / plan:.0f} % | {100.0 * mean / bound:.0f} %"
        second += f"| {team[0]} | {plan:.1f} | {bound:.1f} | {team} | {mean:.1f} | {shares} |\n"
    return text + SECOND + second


def main() -> None:
    """Write the tables, and print them."""
    path = HERE / "team_sketch.md"
    path.write_text(HEAD.format(trials=TRIALS, machine=machine()) + tables(), encoding="utf-8")
    print(path.read_text(encoding="utf-8"))


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main()
