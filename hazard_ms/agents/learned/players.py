"""Agents whose choices of options were learned in the sketch, and are played as macros.

The package brings weights of some tasks (SHIPPED); `weights=FILE` takes others.
"""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import torch

from hazard_ms.agents.base import Agent
from hazard_ms.agents.learned.set_policy import SetPolicy, worthwhile
from hazard_ms.agents.learned.weights import ENDING, load
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Action, Decision
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.macros import Macro, play
from hazard_ms.skills.options.options import TARGET, Menu, Option, Options

SHIPPED = Path(__file__).parents[1] / "weights"  # one file for each agent and task, "rl_HazardFire-v1.safetensors"


class Learned(Agent):
    """Asks a policy which option is best, and plays it to its end. It sees nothing but what all agents see."""

    name: ClassVar[str]  # with which its files begin
    made_by: ClassVar[str]  # command that trains such policies

    def __init__(self, weights: str = "") -> None:
        """`weights`: file NAME.safetensors of a policy, with NAME.json beside it; by default that of the package."""
        self._weights = weights
        self._loaded: tuple[str, SetPolicy] | None = None  # a policy and its task

    def reset(self, brief: Brief) -> None:
        """Begin an episode. Nothing is random.

        Raises ValueError if the file holds no policy for its task, and if the package brings none.
        """
        if self._loaded is None or self._loaded[0] != brief.task:
            self._loaded = brief.task, load(self._path(brief.task), brief.task, self.made_by)
        self._policy = self._loaded[1]
        self._encoder = Encoder(self._policy.shape.ranges, brief.radius)
        self._options = Options()
        self._playing: tuple[Option, Macro] | None = None

    def _path(self, task: str) -> Path:
        """The file of the policy for `task`. Raises ValueError if none was named and the package brings none."""
        if self._weights:
            return Path(self._weights)
        path = SHIPPED / f"{self.name}_{task}{ENDING}"
        if not path.exists():
            raise ValueError(
                f"weights of the agent {self.name} must be a file where the package brings none for {task}, got none: "
                f"make one with `hazard-ms {self.made_by} -e {task} -o FOLDER`, and play {self.name}:weights=FILE"
            )
        return path

    def act(self, decision: Decision) -> Action:
        """The next action of the option that is being played, or the first of the next one."""
        if self._playing is not None:
            option, macro = self._playing
            try:
                return macro.send(decision)
            except StopIteration as ended:
                self._options.note(option, ended.value)
        menu = self._options.menu(decision)
        option = self._choose(decision, menu)
        macro = play(option, decision)
        self._playing = option, macro
        return next(macro)

    def _choose(self, decision: Decision, menu: Menu) -> Option:
        if decision.held is not None and not decision.containers:
            self.note = "into the bag"
            return Option(TARGET, decision.held)
        features = torch.from_numpy(self._encoder.encode(decision, menu))[None]
        mask = torch.from_numpy(worthwhile(menu.mask))[None]
        with torch.no_grad():
            chances = self._policy(features, mask)[0].softmax(-1)
        number = int(chances.argmax())
        option = menu.option(number)
        assert option is not None  # the mask forbids empty slots
        self.note = f"{option}: {float(chances[number]):.0%} of {int(mask.sum())} options"
        return option


class Bc(Learned):
    """Learned by behaviour cloning."""

    name, made_by = "bc", "train bc"


class Rl(Learned):
    """Learned by reinforcement."""

    name, made_by = "rl", "train ppo"
