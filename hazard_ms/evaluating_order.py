"""What `hazard-ms evaluate` is asked to evaluate: plain data, so that the command's help loads nothing heavy."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import tyro

from hazard_ms.order import Order


@dataclass(frozen=True)
class Evaluation:
    """What is to be evaluated."""

    env_id: Annotated[str, tyro.conf.arg(aliases=["-e"])] = "HazardFire-v1"
    """Task."""
    agents: tuple[str, ...] = ("greedy", "random")
    """Names of agents, or package.module:Class."""
    split: str = "test"
    """Whose scenes are played, the first ones first."""
    episodes: int = 25
    """Of every agent, one for each seed."""
    first: int = 0
    """The first seed. Seed s plays the split's scene s, and begins again after the last one."""
    physics: str = "paper"
    """Preset of the hazards."""
    robot: str = "fetch"
    """The rescuer."""
    affects_agent: bool = False
    """Whether the hazards act on the robot."""
    hazards: tuple[str, ...] = ()
    """Of HazardCompound-v1: some of flood, wind, fire."""
    workers: int = 0
    """Processes; 0: one for each core."""
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])] = Path("evaluation")
    """Folder for the results, one file for each episode."""

    def orders(self) -> list[Order]:
        """One for each episode. Raises ValueError for what cannot be played."""
        from hazard_ms.checks import whole

        whole(self.episodes, 1, 10**6, "episodes")
        whole(self.first, 0, 10**6, "first")
        whole(self.workers, 0, 1024, "workers")
        first = Order(self.env_id, split=self.split, physics=self.physics, robot=self.robot)
        first = replace(first, affects_agent=self.affects_agent, hazards=self.hazards)
        made = [replace(first, agent=a, seed=s) for s in range(self.first, self.first + self.episodes) for a in self.agents]
        for order in made[: len(self.agents)]:
            order.check()
        return made

    def place(self, order: Order) -> Path:
        """The file of an episode."""
        setting = [order.env_id, *order.hazards, order.split, order.physics, order.robot] + ["affected"] * order.affects_agent
        return self.out / f"{'-'.join(setting)}-{order.agent.replace(':', '.')}-{order.seed:04d}.json"
