"""A watcher that takes down what is hidden from honest agents: true places, and what each option is worth."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.action_values import State, mean
from hazard_ms.agents.judge import Judge
from hazard_ms.demonstrations.watching.recorder import Recorder
from hazard_ms.evaluation.result import Played
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.skills.decision import DROP, EXPLORE, WALK_TO, Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.options.options import CART, COUNT, END, FIRST, LOOK, TARGET

MIDDLE = slice(1, 3)  # of the paces of `agents.action_values`: those next to the usual one [ours]
MOST_TARGETS = 10  # left to rescue, up to which each option is worked out: more take seconds [ours]


class Foresight(Watcher):
    """Works out what the best plan and each option reach where an option begins; it changes nothing."""

    def __init__(self, recorder: Recorder) -> None:
        """`recorder`: a watcher before this one, which knows where options begin."""
        self._recorder = recorder
        self.bests: list[float] = []  # value of the best plan at each decision, as a share of all; NaN: not worked out
        self.seconds = 0.0  # wall time that it has taken

    def begin(self, env: SkillEnv, decision: Decision) -> None:
        """Take the environment at the start of an episode."""
        self._env, self._mind, self._brief = env, Judge(env), env.brief()
        self._total = sum(self._mind.truth.values.values())
        self._positions: list[NDArray[np.float32]] = []
        self._damaged: list[NDArray[np.bool_]] = []
        self._values: list[NDArray[np.float32]] = []

    def asked(self, so_far: Played) -> None:
        """Take down where the targets are."""
        base = self._env.base
        index = [target.index for target in self._brief.targets]
        self._positions.append(base.world.position[0, index].cpu().numpy().copy())
        self._damaged.append(base.episode.damage.damaged[0, index].cpu().numpy().copy())
        self._state = self._mind.state()

    def decided(self, decision: Decision, action: Action, note: str) -> None:
        """Work out what could be reached when the agent was asked; `decision` and `note` are not looked at."""
        self._action = action
        best, worth = float("nan"), np.full(COUNT, np.nan, np.float32)
        if self._recorder.option_starts or not self.bests:
            start, state = time.perf_counter(), self._state
            limits = self._mind.limits(state)[MIDDLE]
            reached = self._mind.best(state, limits)
            best = mean(reached) / self._total
            worth[FIRST[END]] = state.saved / self._total
            for number, first in self._actions(state).items() if len(state.left) <= MOST_TARGETS else ():
                worth[number] = mean(self._mind.choice(state, first, limits, reached)) / self._total
            self.seconds += time.perf_counter() - start
        self.bests.append(best)
        self._values.append(worth)

    def _actions(self, state: State) -> dict[int, Action]:
        """The first action of each option that makes sense, by the option's number."""
        holding, left = state.holding, state.left
        made = {FIRST[LOOK]: Action(EXPLORE)}
        for slot, target in enumerate(self._brief.targets):
            if holding is None and target.index in left:
                made[FIRST[TARGET] + slot] = Action(WALK_TO, target.name)
            if holding == target.index and not self._brief.containers:
                made[FIRST[TARGET] + slot] = Action(DROP)
        for slot, cart in enumerate(self._brief.containers if holding is not None else ()):
            made[FIRST[CART] + slot] = Action(WALK_TO, cart)
        return made

    def ended(self, result: Result) -> None:
        """Note how the action went: targets that skills failed to get count as out of reach."""
        self._mind.note(self._action, result)

    def arrays(self) -> dict[str, NDArray[np.generic]]:
        """The arrays of privileged/truth.npz, [N, ...] each, positions in [m], as docs/demonstrations.md lists them."""
        return {
            "position": np.asarray(self._positions, np.float32),
            "damaged": np.asarray(self._damaged, np.bool_),
            "best": np.asarray(self.bests, np.float32),
            "option_value": np.asarray(self._values, np.float32),
        }
