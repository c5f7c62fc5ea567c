"""One rescue in the sketch as a gymnasium environment: spaces, masks, rewards and info as those of the simulator."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.environments.choices import choices
from hazard_ms.sketch.environments.rewarded import Rewarded
from hazard_ms.sketch.environments.settings import Settings
from hazard_ms.sketch.rescues.state import AS_MEASURED, Domain
from hazard_ms.skills.options.choices import ACTIONS, OPTIONS
from hazard_ms.skills.options.environment import NOT_AVAILABLE, SEEDS, refuse_mask
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.options import option_count
from hazard_ms.skills.options.paper_actions import COUNT as PAPER_COUNT
from hazard_ms.skills.options.paper_map import MapLayout
from hazard_ms.skills.options.rewards import REWARDS, VALUE
from hazard_ms.spec.checks import flag, one_of, options, whole
from hazard_ms.tasks import task_of

NOT_DONE = "not_done"  # reason for the failure of an option: the sketch knows no better


class SketchSkills(gym.Env[NDArray[np.float32], np.int64]):
    """A rescue task in the sketch, one option per step: a thousand steps a second, and no picture.

    A scene is made when it is first played: for fire in a second, for flood and wind in ten. The same happens in it in
    every episode if nobody acts; the luck of the robot follows from the seed of the episode.
    """

    metadata = {"render_modes": []}  # noqa: RUF012 gymnasium's name and type

    def __init__(
        self,
        *,
        task: str,
        actions: str = OPTIONS,
        reward: str = VALUE,
        stop: bool = True,
        masked: bool = False,
        domain: Domain = AS_MEASURED,
        render_mode: str | None = None,
        **settings: Any,
    ) -> None:
        """Make the environment of a task.

        Args:
            task: Name of the task; gym.make fills it in.
            actions: Meaning of an action: "options" or "paper".
            reward: "value" or "paper".
            stop: Whether the option `stop` may be chosen.
            masked: Whether `action_masks` forbids what cannot be done of the actions "paper"; options always have it.
            domain: Spread of the worlds that episodes are drawn from.
            render_mode: None: the sketch has no pictures.
            **settings: Those of `Settings`: split, scenes, physics, robot_uids, max_frames.

        Raises:
            ValueError: For unknown names and impossible numbers.
        """
        if render_mode is not None:
            raise ValueError(f"render_mode must be None with backend='sketch', got {render_mode!r}")
        self.render_mode = None
        self.settings = Settings.of(task, **settings)
        self.actions, self._reward = one_of(actions, ACTIONS, "actions"), one_of(reward, REWARDS, "reward")
        self._stop, self._masked, self._domain = flag(stop, "stop"), flag(masked, "masked"), domain
        refuse_mask(masked, actions)
        measures = self.settings.measures
        layout = Encoder(self.settings.ranges, 0.0, measures) if actions == OPTIONS else MapLayout(self.settings.ranges)
        self.observation_space: gym.spaces.Box = layout.space()  # type: ignore[assignment]
        self.action_space = gym.spaces.Discrete(option_count(measures) if actions == OPTIONS else PAPER_COUNT)
        self._play: Rewarded | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start the episode of `seed`; without a seed, the next episode of the series that the last seed began.

        Seed s plays in scene s modulo their number; `options` may name another of them ({"scene": name}). Raises
        ValueError for seeds and options that are not allowed.
        """
        if seed is not None:
            whole(seed, 0, SEEDS, "seed")
        number = self.settings.number(_options(options).get("scene"))
        super().reset(seed=seed)
        drawn = int(self.np_random.integers(SEEDS)) if seed is None else seed
        scene = self.settings.scene(drawn % len(self.settings.names) if number is None else number)
        made = choices(
            self.actions,
            [scene],
            self.settings.ranges,
            self.settings.times,
            1,
            self._stop,
            self._masked,
            self._domain,
        )
        self._play = Rewarded(made, self._reward)
        self._play.reset([0], [drawn])
        return made.observe()[0], self._info(self._play, "", True, "", 0)

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Play an option to its end.

        Raises ValueError for anything but the number of an option, and after the end of an episode.
        """
        played = self._running()
        number = whole(action, 0, played.choices.count - 1, "action")
        start, name = int(played.sketch.state.frame[0]), played.choices.name(0, number)
        rewards, terminated, truncated, done = played.step(np.array([number]))
        ok, frames = bool(done.ok[0]), int(played.sketch.state.frame[0]) - start
        info = self._info(played, name, ok, "" if ok else NOT_DONE if done.allowed[0] else NOT_AVAILABLE, frames)
        return played.choices.observe()[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), info

    def action_masks(self) -> NDArray[np.bool_]:
        """Mask of the options that can be chosen now, bool [A], as sb3-contrib's MaskablePPO expects it.

        Raises ValueError before the first episode and after the end of an episode.
        """
        return np.array(self._running().choices.mask[0])

    def render(self) -> None:
        """Nothing: the sketch has no pictures."""

    @property
    def task_description(self) -> str:
        """The task in one sentence, as agents are told it."""
        return task_of(self.settings.task, self.settings.physics).text

    def _running(self) -> Rewarded:
        if self._play is None or self._play.sketch.state.over[0]:
            raise ValueError("the episode must have begun and not be over: call reset first")
        return self._play

    def _info(self, played: Rewarded, option: str, ok: bool, reason: str, frames: int) -> dict[str, Any]:
        """Plain numbers and text about a step, with the keys that the simulator gives."""
        state = played.sketch.state
        there = played.sketch.stack.there[state.scene[0]]
        return {
            "value": float(state.score[0]),
            "frame": int(state.frame[0]),
            "option": option,
            "ok": ok,
            "reason": reason,
            "frames": frames,
            "rescued": int(((state.rescued_at[0] >= 0) & there).sum()),
            "targets": int(there.sum()),
            "sim_error": False,
            "action_mask": np.array(played.choices.mask[0]),
        }


def _options(given: dict[str, Any] | None) -> dict[str, Any]:
    """The options of a reset. Raises ValueError for others than the scene."""
    made = options(given, 1)
    if not {*made} <= {"scene"}:
        raise ValueError(f"reset options must be scene with backend='sketch', got {', '.join(map(str, made))}")
    return made
