"""What `hazard-ms play` is asked to play: plain data, so that the command's help loads nothing heavy."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from hazard_ms import MAX_FRAMES


@dataclass(frozen=True)
class Order:
    """What is to be played."""

    env_id: Annotated[str, tyro.conf.arg(aliases=["-e"])] = "HazardFire-v1"
    """Task."""
    agent: Annotated[str, tyro.conf.arg(aliases=["-a"])] = "greedy"
    """Name of an agent, or package.module:Class."""
    seed: Annotated[int, tyro.conf.arg(aliases=["-s"])] = 0
    """Seed of the episode."""
    scene: str | None = None
    """Name of a scene; by the seed if not given."""
    split: str = "train"
    """Split from which the seed chooses the scene."""
    physics: str = "paper"
    """Preset of the hazards."""
    robot: Annotated[str, tyro.conf.arg(aliases=["-r"])] = "fetch"
    """The rescuer: fetch or g1."""
    affects_agent: bool = False
    """Whether the hazards act on the robot."""
    hazards: tuple[str, ...] = ()
    """Of HazardCompound-v1: some of flood, wind, fire."""
    video: Path | None = None
    """Write the film there, and beside it the result (.json) and a page (.html)."""
    every: int = 6
    """Frames of the episode from one picture of the film to the next; the film runs that much faster."""

    def check(self) -> None:
        """Raise ValueError for what cannot be played."""
        from hazard_ms.checks import one_of, whole  # loads torch

        one_of(self.env_id, MAX_FRAMES, "environment")
        whole(self.every, 1, 10**6, "every")
        if self.video is not None and self.video.suffix != ".mp4":
            raise ValueError(f"the video is {self.video.name}; a name that ends in .mp4 is allowed")

    @property
    def settings(self) -> dict[str, Any]:
        """Keywords of gym.make that change the episode."""
        made = {"split": self.split, "physics": self.physics, "robot_uids": self.robot, "affects_agent": self.affects_agent}
        return {**made, "hazards": list(self.hazards)} if self.hazards else made

    @property
    def command(self) -> str:
        """That plays it again."""
        words = ["hazard-ms", "play", "-e", self.env_id, "--agent", self.agent, "-s", str(self.seed)]
        words += ["--split", self.split, "--physics", self.physics]
        words += ["--robot", self.robot] if self.robot != "fetch" else []
        words += ["--affects-agent"] if self.affects_agent else []
        words += ["--hazards", *self.hazards] if self.hazards else []
        words += [] if self.scene is None else ["--scene", self.scene]
        return shlex.join(words)
