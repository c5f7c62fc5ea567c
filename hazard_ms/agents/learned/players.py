"""Agents whose choices were learned in the sketch: of options, played as macros, and of the six actions.

The package brings weights of some tasks (SHIPPED); `weights=FILE` takes others.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.agents.base import Agent
from hazard_ms.agents.learned.map_policy import MapPolicy
from hazard_ms.agents.learned.set_policy import SetPolicy, worthwhile
from hazard_ms.agents.learned.weights import ENDING, load, load_map
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Action, Decision
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.fires import measured, tool_in_hand
from hazard_ms.skills.options.macros import Macro, play
from hazard_ms.skills.options.options import TARGET, Menu, Option, Options
from hazard_ms.skills.options.paper_actions import NAMES, SixActions
from hazard_ms.skills.options.paper_map import Planes

SHIPPED = Path(__file__).parents[1] / "weights"  # one file for each agent and task, "rl_HazardFire-v1.safetensors"


def weights_file(given: str, name: str, task: str, made_by: str) -> Path:
    """The file of the policy of the agent `name` for `task`: the one that was `given`, or that of the package.

    `made_by`: the command that trains such policies. Raises ValueError if none was given and the package brings none.
    """
    if given:
        return Path(given)
    path = SHIPPED / f"{name}_{task}{ENDING}"
    if not path.exists():
        raise ValueError(
            f"weights must be given for the agent {name}, since none are shipped for {task}: train them with "
            f"`hazard-ms {made_by} -e {task} -o FOLDER`, then play {name}:weights=FILE"
        )
    return path


def check_hazards(ranges: Sequence[tuple[float, float]], brief: Brief) -> None:
    """Raises ValueError unless a policy that learned with hazards of the usual levels `ranges` can play an episode."""
    if len(ranges) != len(brief.hazards):
        told = ", ".join(hazard.name for hazard in brief.hazards)
        raise ValueError(
            f"weights must hold a policy for as many hazards as the episode has ({told}), got one for {len(ranges)}"
        )


class Learned(Agent):
    """Asks a policy which option is best, and plays it to its end. It sees nothing but what all agents see."""

    colours = False
    name: ClassVar[str]  # with which its files begin
    made_by: ClassVar[str]  # command that trains such policies

    def __init__(self, weights: str = "") -> None:
        """`weights`: file NAME.safetensors of a policy, with NAME.json beside it; by default that of the package."""
        self._weights = weights
        self._loaded: tuple[str, SetPolicy] | None = None  # a policy and its task

    def reset(self, brief: Brief) -> None:
        """Begin an episode. Nothing is random.

        Raises ValueError if the file holds no policy for its task and as many hazards, and if the package brings none.
        """
        fire = measured(brief.mitigations, [hazard.name for hazard in brief.hazards])
        if self._loaded is None or self._loaded[0] != brief.task:
            path = weights_file(self._weights, self.name, brief.task, self.made_by)
            self._loaded = brief.task, load(path, brief.task, self.made_by, fire is not None)
        self._policy = self._loaded[1]
        check_hazards(self._policy.shape.ranges, brief)
        self._encoder = Encoder(self._policy.shape.ranges, brief.radius, fire is not None)
        self._options = Options(fire=fire)
        self._playing: tuple[Option, Macro] | None = None

    def act(self, decision: Decision) -> Action:
        """The next action of the option that is being played, or the first of the next one."""
        if self._playing is not None:
            option, macro = self._playing
            try:
                return macro.send(decision)
            except StopIteration as ended:
                self._options.note(option, ended.value, decision)
        menu = self._options.menu(decision)
        option = self._choose(decision, menu)
        macro = play(option, decision)
        self._playing = option, macro
        return next(macro)

    def _choose(self, decision: Decision, menu: Menu) -> Option:
        if decision.held is not None and not decision.containers and not tool_in_hand(decision):
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


class RlPaper(Agent):
    """Learned by reinforcement over the six actions of the original's learner, from its map.

    It draws actions as likely as its policy wants them, as it did while it learned: the likeliest one again and again
    would often lead nowhere. A choice that cannot be taken is drawn anew, and counted as `impossible`.
    """

    colours = False
    name, made_by = "rl_paper", "train ppo --actions paper"

    def __init__(self, weights: str = "") -> None:
        """`weights`: file NAME.safetensors of a policy, with NAME.json beside it; by default that of the package."""
        self._weights = weights
        self._loaded: tuple[str, MapPolicy] | None = None  # a policy and its task

    def reset(self, brief: Brief) -> None:
        """Begin an episode, and a sequence of random numbers that `brief.random_seed` determines.

        Raises ValueError if the file holds no policy for its task and as many hazards, and if the package brings none.
        """
        if self._loaded is None or self._loaded[0] != brief.task:
            path = weights_file(self._weights, self.name, brief.task, self.made_by)
            self._loaded = brief.task, load_map(path, brief.task, self.made_by)
        self._policy = self._loaded[1]
        check_hazards(self._policy.shape.ranges, brief)
        # "RLP": not the stream of another agent with the same seed
        self._chance = np.random.default_rng([brief.random_seed, 0x524C50])
        self._actions = SixActions(brief.random_seed)
        self.counters = {"impossible": 0.0}

    def act(self, decision: Decision) -> Action:
        """One of the six actions, as an action of the benchmark."""
        self._actions.see(decision)
        seen, possible = self._policy.layout.encode(decision), self._actions.mask
        drawn = self._draw(seen, possible if self._policy.shape.masked else np.ones_like(possible))
        if not possible[drawn]:
            self.counters = {"impossible": self.counters["impossible"] + 1.0}
            drawn = self._draw(seen, possible)
        action = self._actions.action(drawn)
        assert action is not None  # what is drawn can be done
        self.note = NAMES[drawn]
        return action

    def _draw(self, seen: Planes, mask: NDArray[np.bool_]) -> int:
        chance = torch.tensor([self._chance.random()], dtype=torch.float32)
        return int(self._policy.draw(torch.from_numpy(seen)[None], torch.from_numpy(mask)[None], chance))
