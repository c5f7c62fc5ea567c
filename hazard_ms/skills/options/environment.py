"""Skills as a plain gymnasium environment: gym.make("hazard_ms:HazardFireSkills-v1").

An action is the number of an option (`hazard_ms.skills.options.options`), which runs to its end. An observation is a
vector of features (`hazard_ms.skills.options.features`). With actions="paper" these are one of six actions and a map
(`hazard_ms.skills.options.paper_actions`, `.paper_map`). Rewards are those of `hazard_ms.skills.options.rewards`.
"""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from hazard_ms.env import inputs
from hazard_ms.skills.actions import wait
from hazard_ms.skills.decision import Decision, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.options.choices import ACTIONS, OPTIONS, Choices, OptionChoices, PaperChoices
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.fires import measured
from hazard_ms.skills.options.macros import Macro
from hazard_ms.skills.options.options import Menu
from hazard_ms.skills.options.paper_map import MapLayout
from hazard_ms.skills.options.rewards import PAPER, REWARDS, VALUE, paper, potential
from hazard_ms.spec.catalogue import DAMAGED_SHARE
from hazard_ms.spec.checks import flag, one_of, whole

FIXED = ("obs_mode", "reward_mode", "num_envs", "control_mode")  # keywords that skills decide
IDLE = 10  # frames taken by an option that would take none, so that every episode ends [ours]
NOT_AVAILABLE = "not_available"  # reason for the failure of an option that cannot be taken
SEEDS = 2**31  # seeds of unseeded episodes are drawn from 0 to this number


class HazardSkills(gym.Env[NDArray[np.float32], np.int64]):
    """A rescue task as a gymnasium environment with one option per step.

    Every step takes at least one frame: an option that is not available, or fails at once, costs IDLE frames.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 2}  # noqa: RUF012 gymnasium's name and type

    def __init__(
        self,
        *,
        task: str,
        actions: str = OPTIONS,
        reward: str = VALUE,
        stop: bool = True,
        masked: bool = False,
        max_frames: int | None = None,
        render_mode: str | None = None,
        **settings: Any,
    ) -> None:
        """Make the environment of a task.

        Args:
            task: Name of the task; gym.make fills it in.
            actions: Meaning of an action: "options" or "paper".
            reward: "value" or "paper".
            stop: Whether the option `stop` may be chosen. Without it, an untrained policy cannot end its episodes at
                once.
            masked: Whether `action_masks` forbids what cannot be done of the actions "paper"; options always have it.
            max_frames: Greatest length of an episode [frames]; None takes that of the task.
            render_mode: None, or "rgb_array" for pictures of the scene.
            **settings: Keywords of the task's own environment (split, scenes, physics, robot_uids, ...).

        Raises:
            ValueError: For unknown names, for keywords that skills decide, and without a renderer.
        """
        self.actions = one_of(actions, ACTIONS, "actions")
        self._reward = one_of(reward, REWARDS, "reward")
        flag(stop, "stop")
        refuse_mask(flag(masked, "masked"), actions)
        if render_mode is not None:
            one_of(render_mode, self.metadata["render_modes"], "render_mode")
        self.render_mode = render_mode
        for name in FIXED:
            if name in settings:
                raise ValueError(f"{name} must not be given, because skills decide it, got {settings[name]!r}")
        if max_frames is not None:
            settings["max_episode_steps"] = whole(max_frames, 1, 2**31, "max_frames")
        settings.setdefault("effects", "off" if render_mode is None else "full")  # effects only change pictures
        self.skills = SkillEnv.make(task, reward_mode="none", render_mode=render_mode, **settings)
        self.skills.colours = False
        base = self.skills.base
        ranges = [(hazard.level.low, hazard.level.high) for hazard in base.task.hazards]
        fire = measured(base.task.mitigations, [hazard.name for hazard in base.task.hazards])
        self.encoder = Encoder(ranges, base.agent.build.radius, fire is not None)
        options = OptionChoices(self.encoder, stop, fire)
        self._choices: Choices = options if actions == OPTIONS else PaperChoices(MapLayout(ranges), masked)
        self._options = options if actions == OPTIONS else None
        self.observation_space: gym.spaces.Box = self._choices.space()  # type: ignore[assignment]
        self.action_space = gym.spaces.Discrete(self._choices.count)
        self._running = False

    # ------------------------------------------------------------------ gymnasium

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start the episode of `seed`; without a seed, the next episode of the series that the last seed began.

        `options` are those of the task's own environment ({"scene": name}).

        Raises ValueError for seeds and options that are not allowed; the episode is left unchanged.
        """
        seed, _ = inputs.reset(self.skills.base, seed, options)
        seed = seed[0] if isinstance(seed, list) else seed
        super().reset(seed=seed)
        drawn = int(self.np_random.integers(SEEDS)) if seed is None else seed
        self._decision, _ = self.skills.reset(seed=drawn, options=options)
        self._choices.begin(drawn)
        self._value, self._potential = self._rescued_value(), self._potential_now()
        self._running = True
        return self._choices.see(self._decision), self._info("", Result(True), 0)

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Play an option to its end.

        Raises ValueError for anything but the number of an option, and after the end of an episode.
        """
        if not self._running:
            raise ValueError("the episode must have begun and not be over: call reset first")
        number = whole(action, 0, self._choices.count - 1, "action")
        name, start = self._choices.name(number), self.skills.frame
        result, terminated, macro = Result(False, NOT_AVAILABLE), False, self._choices.macro(number, self._decision)
        if macro is not None:
            result, terminated = self._play(macro)
            self._choices.note(number, result.ok, self._decision)
        if self.skills.frame == start and not terminated:
            self.skills.run(wait(self.skills.stage, IDLE))
            self._decision = self.skills.decision()
        truncated = self.skills.frame >= self.skills.max_frames or bool(self.skills.base.episode.sim_error[0])
        reward, obs = self._rewarded(macro is not None), self._choices.see(self._decision)
        info = self._info(name, result, self.skills.frame - start)
        self._running = not (terminated or truncated)
        return obs, reward, terminated, truncated and not terminated, info

    def action_masks(self) -> NDArray[np.bool_]:
        """Mask of the options that can be chosen now, bool [A], as sb3-contrib's MaskablePPO expects it.

        Raises ValueError before the first episode and after the end of an episode.
        """
        if not self._running:
            raise ValueError("the episode must have begun and not be over: call reset first")
        return self._choices.mask.copy()

    def render(self) -> NDArray[np.uint8] | None:
        """A picture of the scene, [H, W, 3]; None without a render mode."""
        if self.render_mode is None:
            return None
        picture: Any = self.skills.env.render()
        return np.array(picture[0].cpu().numpy())

    def close(self) -> None:
        """Close the environment."""
        self.skills.close()

    # ------------------------------------------------------------------ one decision

    @property
    def task_description(self) -> str:
        """The task in one sentence, as agents are told it."""
        return self.skills.base.task_description

    @property
    def decision(self) -> Decision:
        """The current decision, for agents that read more than numbers."""
        return self._decision

    @property
    def menu(self) -> Menu | None:
        """The current meaning of the options' numbers; None when the episode is over, and for the six actions."""
        return self._options.menu if self._running and self._options is not None else None

    def _play(self, macro: Macro) -> tuple[Result, bool]:
        """Play `macro` to its end or to that of the episode; return its outcome and whether the episode terminated."""
        action = next(macro)
        while True:
            self._decision, _, terminated, truncated, info = self.skills.step(action)
            result: Result = info["result"]
            try:
                action = macro.send(self._decision)
            except StopIteration as ended:
                return Result(ended.value, "" if ended.value else result.reason or "not_done"), terminated
            if terminated or truncated:
                macro.close()
                return Result(terminated, "" if terminated else result.reason), terminated

    def _info(self, option: str, result: Result, frames: int) -> dict[str, Any]:
        """Plain numbers and text about a step."""
        world = self.skills.base.world
        return {
            "value": self._value,
            "frame": self.skills.frame,
            "option": option,
            "ok": result.ok,
            "reason": result.reason,
            "frames": frames,
            "rescued": int((world.safe & world.target).sum()),
            "targets": int(world.target.sum()),
            "sim_error": bool(self.skills.base.episode.sim_error[0]),
            "action_mask": self._choices.mask.copy(),
        }

    def _rewarded(self, allowed: bool) -> float:
        """The reward of the decision that has just ended; `allowed`: whether it could be taken."""
        value, standing = self._value, self._potential
        self._value, self._potential = self._rescued_value(), self._potential_now()
        return float(paper(standing, self._potential, allowed)) if self._reward == PAPER else self._value - value

    def _potential_now(self) -> float:
        """The potential of the reward `paper`; 0 with another reward."""
        if self._reward != PAPER:
            return 0.0
        base = self.skills.base
        world, containers = base.world, base.task.safe_place.containers
        place, held = world.position[0, :, :2], world.held[0]
        away = np.hypot(*(place - world.agent_position[0, :2]).cpu().numpy().astype(np.float64).T)
        open_ones = (world.target[0] & ~world.safe[0] & ~held).cpu().numpy()
        cart = np.array([thing.category in containers for thing in base.specs[0].things])
        nearest = [float(away[which].min()) if which.any() else 0.0 for which in (open_ones, cart)]
        return float(potential(int((world.safe & world.target)[0].sum()), bool(held.any()), cart.any(), *nearest))

    def _rescued_value(self) -> float:
        """Value rescued so far as a share of all, a damaged target counting half."""
        world, rescue = self.skills.base.world, self.skills.base.episode.rescue
        saved = world.safe[0] & world.target[0]
        worth = world.value[0].double() * saved.double()
        worth[rescue.damaged[0]] *= DAMAGED_SHARE
        return float(worth.sum()) / max(float((world.value[0] * world.target[0]).double().sum()), 1.0)


def refuse_mask(masked: bool, actions: str) -> None:
    """Raises ValueError if `masked` is set for options, whose masks are always there."""
    if masked and actions == OPTIONS:
        raise ValueError("masked must be False with actions='options', which always have masks, got True")
