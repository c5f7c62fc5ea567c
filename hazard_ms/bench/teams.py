"""Measures what teams rescue: one robot, two on their own, two that hold auctions, two that plan together.

    python -m hazard_ms.bench.teams -t HazardFire-v1 HazardWind-v1 -n 2 -o teams.jsonl

All play the same scenes. Every episode adds a line to the file. Results do not depend on the machine.
"""

from __future__ import annotations

import argparse
import itertools
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from hazard_ms.agents.team import TeamAgent, team_agent
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


def play(env: TeamSkills, player: TeamAgent, seed: int) -> None:
    """Play the episode of `seed` to its end."""
    decisions, _ = env.reset(seed=seed)
    player.reset({name: env.brief(name) for name in env.names})
    over = False
    while not over:
        decisions, terminated, truncated, _ = env.step(player.act(decisions))
        over = terminated or truncated


def measure(
    env_id: str, seeds: Sequence[int], robots: tuple[str, ...], name: str, split: str = "test"
) -> list[TeamResult]:
    """Play a scene of a `split` of the task for each of `seeds` with `robots` and the team agent called `name`."""
    env, made = TeamSkills.make(env_id, robots, split=split, effects="off", affects_agent=False), []
    for seed in seeds:
        play(env, team_agent(name), seed)
        info = env.base.get_info()
        numbers = float(info["value"][0]), int(info["rescued"][0]), int(info["targets"][0]), env.frame, env.collisions
        made.append(TeamResult(env_id, seed, env.base.specs[0].name, robots, name, *numbers))
    env.close()
    return made


def table(made: Sequence[TeamResult]) -> str:
    """Means over episodes of the same task, robots and agent, as a table in Markdown."""
    lines = ["| task | robots | agent | episodes | value | frames | collisions |", "|---|---|---|---|---|---|---|"]
    for task, (robots, name) in itertools.product(dict.fromkeys(r.env_id for r in made), SETUPS):
        rows = [r for r in made if (r.env_id, r.robots, r.agent) == (task, robots, name)]
        if rows:
            value, frames = np.mean([(r.value, r.frames) for r in rows], axis=0)
            hits = sum(r.robot_collisions for r in rows)
            lines.append(
                f"| {task} | {', '.join(robots)} | {name} | {len(rows)} | {value:.3f} | {frames:.0f} | {hits} |"
            )
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
