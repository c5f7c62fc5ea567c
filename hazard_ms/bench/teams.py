"""Measures what teams rescue: one robot, two on their own, two that hold auctions, two that plan together.

    python -m hazard_ms.bench.teams -t HazardFire-v1 HazardWind-v1 -n 2 -o teams.jsonl

All play the same scenes. Every episode adds a line to the file, with what was averted and what each robot bore in tasks
that tell of it (docs/benchmark.md 4.3). Results do not depend on the machine.
"""

from __future__ import annotations

import argparse
import itertools
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hazard_ms.agents.team import TeamAgent, team_agent
from hazard_ms.evaluation.averted.account import Account
from hazard_ms.evaluation.averted.loss import averted, mean_score
from hazard_ms.evaluation.metrics import Tally
from hazard_ms.evaluation.runner import fates
from hazard_ms.skills.team import TeamSkills

ALONE, PAIR = ("fetch",), ("fetch", "fetch")
SETUPS = (
    (ALONE, "independent"),
    (ALONE, "independent:planner"),
    (PAIR, "independent"),
    (PAIR, "auction"),
    (PAIR, "joint"),
)


@dataclass(frozen=True)
class TeamResult:
    """One episode of a team."""

    env_id: str
    seed: int
    scene: str
    robots: tuple[str, ...]
    agent: str
    value: float  # rescued, as a share of all; damaged targets count half
    rescued: int
    targets: int
    frames: int
    robot_collisions: int
    averted: float | None = None  # share of what is lost if nobody acts; None: nothing is, or the task does not ask
    heat: tuple[float | None, ...] = ()  # dose that each robot bore [-]; None: nothing measures it
    water: tuple[float | None, ...] = ()  # depth of the water in which each stood, over time [m s]


def play(env: TeamSkills, player: TeamAgent | None, seed: int) -> Account:
    """Play the episode of `seed` to its end; without a player nobody acts. Returns the account of it."""
    decisions, _ = env.reset(seed=seed)
    account = Account()
    account.begin(env)
    if player is not None:
        player.reset({name: env.brief(name) for name in env.names})
        env.watch, over = account.frame, False
        while not over:
            decisions, terminated, truncated, _ = env.step(player.act(decisions))
            over = terminated or truncated
        env.watch = None
    return account


def measure(
    env_id: str, seeds: Sequence[int], robots: tuple[str, ...], name: str, split: str = "test"
) -> list[TeamResult]:
    """Play a scene of a `split` of the task for each of `seeds` with `robots` and the team agent called `name`."""
    env = TeamSkills.make(env_id, robots, split=split, effects="off")
    made = [_measured(env, env_id, seed, robots, name) for seed in seeds]
    env.close()
    return made


def _measured(env: Any, env_id: str, seed: int, robots: tuple[str, ...], name: str) -> TeamResult:
    account, task = play(env, team_agent(name), seed), env.base.task
    targets, frames, hits, loads = fates(env), env.frame, env.collisions, account.loads().values()
    share = None
    if task.averted or task.safe_place.at_rest:
        ended = account.closed(lambda: fates(env))
        targets = ended.get("targets", targets)
        share = averted(ended["lost"], play(env, None, seed).close()) if task.averted else None
    return TeamResult(
        env_id=env_id,
        seed=seed,
        scene=env.base.specs[0].name,
        robots=robots,
        agent=name,
        value=Tally.of(targets).value,
        rescued=Tally.of(targets).rescued,
        targets=len(targets),
        frames=frames,
        robot_collisions=hits,
        averted=share,
        heat=tuple(load.heat for load in loads),
        water=tuple(load.water for load in loads),
    )


def table(made: Sequence[TeamResult]) -> str:
    """Means over episodes of the same task, robots and agent, as a table in Markdown."""
    lines = ["| task | robots | agent | episodes | value | averted | frames | collisions |", "|---" * 8 + "|"]
    for task, (robots, name) in itertools.product(dict.fromkeys(r.env_id for r in made), SETUPS):
        rows = [r for r in made if (r.env_id, r.robots, r.agent) == (task, robots, name)]
        if rows:
            value, frames = np.mean([(r.value, r.frames) for r in rows], axis=0)
            share, hits = mean_score([r.averted for r in rows]).mean, sum(r.robot_collisions for r in rows)
            told = f"{value:.3f} | {'-' if share is None else format(share, '.3f')} | {frames:.0f} | {hits}"
            lines.append(f"| {task} | {', '.join(robots)} | {name} | {len(rows)} | {told} |")
    return "\n".join(lines)


def main() -> None:
    """Play, write a line for each episode, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-t", "--tasks", nargs="+", default=["HazardFire-v1"])
    parser.add_argument("-n", "--episodes", type=int, default=2, help="of each task and team, by seeds from 0 on")
    parser.add_argument("--split", default="test")
    parser.add_argument("-o", "--output", type=Path, default=Path("teams.jsonl"))
    asked = parser.parse_args()
    made: list[TeamResult] = []
    for task, seed, (robots, name) in itertools.product(asked.tasks, range(asked.episodes), SETUPS):
        made += measure(task, [seed], robots, name, asked.split)
        with asked.output.open("a", encoding="utf-8") as file:
            file.write(json.dumps(asdict(made[-1])) + "\n")
    print(table(made))


if __name__ == "__main__":
    main()
