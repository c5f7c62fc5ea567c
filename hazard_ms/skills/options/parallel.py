"""Teams as a ParallelEnv of PettingZoo: one agent per robot, whose actions are options that run at the same time.

An action is the number of an option (`hazard_ms.skills.options.options`), or the last number, GO_ON, while an option
of the robot still runs. A step ends when the option of any robot is over. Every agent gets the features of its own
decision (`hazard_ms.skills.options.features`) and a mask of the actions that it can take; while its option runs, those
of the decision in which it began, and a mask of GO_ON alone. The reward is what the value of all that is rescued grew
by in the step, the same for all.
"""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from hazard_ms.skills.decision import Action, Decision
from hazard_ms.skills.options.choices import OptionChoices
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.macros import Macro
from hazard_ms.skills.team import TeamSkills
from hazard_ms.spec.checks import whole

Observation = dict[str, NDArray[Any]]
FIXED = ("obs_mode", "reward_mode", "num_envs", "control_mode")  # keywords that skills decide


class HazardTeam(ParallelEnv[str, Observation, int]):
    """A rescue task for the robots of a team; each agent that stops is done, and its robot stands."""

    metadata: dict[str, Any] = {"name": "hazard_team_v1", "render_modes": [], "is_parallelizable": True}  # noqa: RUF012

    def __init__(
        self, task: str = "HazardFire-v1", robot_uids: Any = ("fetch", "fetch"), stop: bool = True, **settings: Any
    ) -> None:
        """Make the environment of a `task` for the robots `robot_uids`.

        `stop`: whether an agent may stop; `settings`: keywords of gym.make. Raises ValueError for unknown names, and
        for keywords that skills decide.
        """
        for name in FIXED:
            if name in settings:
                raise ValueError(f"{name} must not be given, because skills decide it, got {settings[name]!r}")
        self.skills = TeamSkills.make(task, robot_uids, **{"effects": "off", "reward_mode": "none", **settings})
        base = self.skills.base
        ranges = [(hazard.level.low, hazard.level.high) for hazard in base.task.hazards]
        self.possible_agents = list(self.skills.names)
        self.agents: list[str] = []
        self._choices = {n: OptionChoices(Encoder(ranges, r.build.radius), stop) for n, r in base.robots.items()}
        self.observation_spaces, self.action_spaces = {}, {}
        for name, one in self._choices.items():
            mask = gym.spaces.Box(0, 1, (one.count + 1,), np.int8)
            self.observation_spaces[name] = gym.spaces.Dict({"observation": one.space(), "action_mask": mask})
            self.action_spaces[name] = gym.spaces.Discrete(one.count + 1)

    def observation_space(self, agent: str) -> gym.Space[Any]:
        """The features of the `agent` [-] and its mask of actions, by name; always the same object."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gym.Space[Any]:
        """The numbers of the options of the `agent`, and GO_ON; always the same object."""
        return self.action_spaces[agent]

    @property
    def go_on(self) -> int:
        """GO_ON, the number of the action of a robot whose option still runs."""
        return next(iter(self._choices.values())).count

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """Start an episode. Of `options` it reads "scene"; others are left to wrappers.

        Raises ValueError for seeds and scenes that are not allowed; the episode is left unchanged.
        """
        known = {key: value for key, value in (options or {}).items() if key == "scene"}
        decisions, _ = self.skills.reset(seed=seed, options=known)
        self.agents = list(self.possible_agents)
        self._running: dict[str, tuple[int, Macro]] = {}
        self._pending: dict[str, Action] = {}  # of options that go on, decided when another was over
        self._seen: dict[str, NDArray[np.float32]] = {}
        self._decisions: dict[str, Decision] = {}
        self._value = 0.0
        for name, decision in decisions.items():
            self._choices[name].begin(0)
            self._see(name, decision)
        return {n: self._observation(n) for n in self.agents}, {n: self._info() for n in self.agents}

    def step(
        self, actions: dict[str, int]
    ) -> tuple[dict[str, Observation], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]:
        """Play the options of all agents until one is over.

        Raises ValueError for agents left out, and for actions that the mask of an agent does not allow; the episode is
        left unchanged.
        """
        live = self._check(actions)
        given = self._pending
        for name in live:
            if name not in self._running:
                number = int(actions[name])
                macro = self._choices[name].macro(number, self._decisions[name])
                assert macro is not None  # its mask allows it
                self._running[name], given[name] = (number, macro), next(macro)
        asked, terminated, truncated = False, False, False
        while not (asked or terminated or truncated):
            decisions, terminated, truncated, _ = self.skills.step(given)
            given = {}
            for name, decision in decisions.items():
                action = self._next(name, decision)
                asked = asked or action is None
                given.update({} if action is None else {name: action})
            asked = asked or any(name in self.skills.stopped for name in self._running)
        done = {name: terminated or name in self.skills.stopped for name in live}
        for name in live:
            if done[name]:
                self._running.pop(name, None)
        before, self._value = self._value, self._rescued()
        self._pending = given
        over = dict.fromkeys(live, truncated and not terminated)
        self.agents = [] if terminated or truncated else [name for name in live if not done[name]]
        rewards = dict.fromkeys(live, self._value - before)
        return {n: self._observation(n) for n in live}, rewards, done, over, {n: self._info() for n in live}

    def _check(self, actions: dict[str, int]) -> list[str]:
        """The agents that play."""
        if set(actions) != set(self.agents) or not self.agents:
            raise ValueError(f"actions must be for {', '.join(self.agents) or 'none'}, got {', '.join(actions)}")
        for name, number in actions.items():
            mask = self._mask(name)
            if not mask[whole(number, 0, self.go_on, f"action of {name}")]:
                allowed = ", ".join(map(str, np.flatnonzero(mask)))
                raise ValueError(f"action of {name} must be one that its mask allows ({allowed}), got {number}")
        return list(self.agents)

    def _next(self, name: str, decision: Decision) -> Action | None:
        """The next action of the option that the robot `name` plays; None where it is over."""
        number, macro = self._running[name]
        try:
            return macro.send(decision)
        except StopIteration as ended:
            del self._running[name]
            self._choices[name].note(number, ended.value, decision)
            self._see(name, decision)
            return None

    def _see(self, name: str, decision: Decision) -> None:
        self._decisions[name], self._seen[name] = decision, self._choices[name].see(decision)

    def _mask(self, name: str) -> NDArray[np.int8]:
        """Whether the agent `name` can take each action, [A + 1]."""
        busy = name in self._running
        mask = np.zeros_like(self._choices[name].mask) if busy else self._choices[name].mask
        return np.append(mask, busy).astype(np.int8)

    def _observation(self, name: str) -> Observation:
        return {"observation": self._seen[name].copy(), "action_mask": self._mask(name)}

    def _rescued(self) -> float:
        return float(self.skills.base.get_info()["value"][0])

    def _info(self) -> dict[str, Any]:
        return {"value": self._value, "frame": self.skills.frame, "robot_collisions": self.skills.collisions}

    def close(self) -> None:
        """Close the environment."""
        self.skills.close()
