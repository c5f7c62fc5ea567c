"""Hundreds of rescues in the sketch as one vector environment of gymnasium, without processes or copies.

An episode that ends is followed by the next in the same step, in a scene and with a seed that are drawn anew. What was
seen last is in info.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from hazard_ms.sketch.environments.choices import choices
from hazard_ms.sketch.environments.rewarded import Rewarded
from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.sketch.rescues.state import AS_MEASURED, Domain
from hazard_ms.sketch.skill_times import SkillTimes
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.choices import OPTIONS
from hazard_ms.skills.options.environment import SEEDS
from hazard_ms.skills.options.rewards import VALUE
from hazard_ms.spec import checks
from hazard_ms.spec.checks import whole

MOST = 100_000  # rescues at once: any larger number must be a mistake [ours]


class SketchBatch(gym.vector.VectorEnv[NDArray[np.float32], NDArray[np.int64], NDArray[Any]]):
    """N rescues at once, each in one of the `scenes`.

    Info holds for every rescue: "action_mask" [N, A]; "value" and "frame", [N], of its current episode. Where episodes
    ended, "final_obs" [N, ...] is what was seen last, and "final_info" holds "value", "frame" and "decisions", [N], of
    the episodes that ended; "_final_obs" and "_final_info", [N], say where that is.
    """

    metadata = {"render_modes": [], "autoreset_mode": gym.vector.AutoresetMode.SAME_STEP}  # noqa: RUF012 gymnasium's

    def __init__(
        self,
        scenes: Sequence[SketchScene],
        ranges: Sequence[tuple[float, float]],
        times: SkillTimes,
        num_envs: int,
        reward: str = VALUE,
        stop: bool = True,
        domain: Domain = AS_MEASURED,
        actions: str = OPTIONS,
        masked: bool = False,
    ) -> None:
        """Make N = `num_envs` rescues.

        Args:
            scenes: Scenes that episodes are drawn from.
            ranges: Ends of each hazard's usual level, in its unit.
            times: Skill times of the robot.
            num_envs: Number of rescues at once.
            reward: "value" or "paper".
            stop: Whether the option `stop` may be chosen.
            domain: Spread of the worlds that episodes are drawn from.
            actions: Meaning of an action: "options" or "paper".
            masked: Whether masks forbid what cannot be done of the actions "paper"; options always have masks.

        Raises:
            ValueError: For unknown names and impossible numbers.
        """
        self.num_envs = whole(num_envs, 1, MOST, "num_envs")
        self._count, self.actions = len(scenes), actions
        made = choices(actions, scenes, ranges, times, num_envs, stop, masked, domain)
        self._play = Rewarded(made, reward)
        self.single_observation_space: gym.Space[Any] = made.space()
        self.single_action_space: gym.Space[Any] = gym.spaces.Discrete(made.count)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._decisions = np.zeros(num_envs, np.int64)
        self._begun = False

    @property
    def sketch(self) -> Sketch:
        """The sketch in which the rescues are played."""
        return self._play.sketch

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin all episodes anew. All that follows is derived from `seed`; without one, the last series goes on.

        Raises ValueError for anything but a whole number, and for options.
        """
        if checks.options(options, self.num_envs):
            raise ValueError(f"options must be None, got {options!r:.100}")
        if isinstance(seed, (list, tuple)):
            raise ValueError("seed must be one whole number for all rescues, got a list")
        super().reset(seed=None if seed is None else whole(seed, 0, SEEDS, "seed"))
        self._begin(np.arange(self.num_envs))
        self._begun = True
        return self._play.choices.observe(), self._info()

    def step(
        self, actions: Any
    ) -> tuple[NDArray[np.float32], NDArray[Any], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Take one choice of each rescue, [N]: see `Rewarded.step`. Raises ValueError for anything else."""
        if not self._begun:
            raise ValueError("episodes must have begun: call reset first")
        rewards, terminated, truncated, _ = self._play.step(actions)
        self._decisions += 1
        over, obs = terminated | truncated, self._play.choices.observe()
        final: dict[str, Any] = {}
        rows = np.flatnonzero(over)
        if len(rows):
            ended = {**self._numbers(), "decisions": self._decisions.copy()}
            final = {"final_obs": obs, "final_info": ended, "_final_obs": over, "_final_info": over.copy()}
            self._begin(rows)
            obs = self._play.choices.observe()
        return obs, rewards, terminated, truncated, {**self._info(), **final}

    def action_masks(self) -> NDArray[np.bool_]:
        """Masks of what can be chosen now, bool [N, A]."""
        return self._play.choices.mask.copy()

    def _begin(self, rows: NDArray[np.int64]) -> None:
        """Begin the next episodes at `rows` [R]."""
        scene = self.np_random.integers(self._count, size=len(rows))
        self._play.reset(scene, self.np_random.integers(SEEDS, size=len(rows)), rows)
        self._decisions[rows] = 0

    def _info(self) -> dict[str, Any]:
        return {**self._numbers(), "action_mask": self.action_masks()}

    def _numbers(self) -> dict[str, Any]:
        return {"value": self.sketch.state.score.copy(), "frame": self.sketch.state.frame.copy()}
