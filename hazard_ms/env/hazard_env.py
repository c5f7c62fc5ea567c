"""The environment as users meet it: its keywords, a step, rewards, observations, states."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from gymnasium.envs.registration import EnvSpec
from mani_skill.utils.common import to_numpy
from torch import Tensor

from hazard_ms.env import inputs, keywords, states
from hazard_ms.env.built import BuiltEnv
from hazard_ms.env.control_noise import check_mode
from hazard_ms.env.spaces import bounded
from hazard_ms.hazards.base import none_set
from hazard_ms.hazards.presets import FREQUENCIES, PRESETS
from hazard_ms.robots.mounting import check_cameras
from hazard_ms.scenes.choice import SceneChoice, SceneTurns
from hazard_ms.scenes.files import playing
from hazard_ms.sensing.modes import check_senses, finite
from hazard_ms.sensing.observation_table import ObservationTable
from hazard_ms.simulation.drawing.lighting import LIGHTINGS
from hazard_ms.spec import checks
from hazard_ms.spec.perturbation import Perturbation
from hazard_ms.spec.registry import TASKS
from hazard_ms.spec.registry import affects_agent as acts_on_agent
from hazard_ms.spec.registry.announce import importable
from hazard_ms.spec.registry.robots import robot_names
from hazard_ms.spec.severity import USUAL
from hazard_ms.tasks import perturbing, task_of
from hazard_ms.tasks.episode import snapshot

EFFECTS = ("full", "fast", "off")


class HazardEnv(BuiltEnv):
    """A ManiSkill environment whose world changes by itself.

    One step (a frame):
        robot.set_action, kept out of what would destroy it
        each physics step: world.read -> sum over hazards of hazard.force -> world.push (once) -> physics
        then: world.read -> guard -> chance.tick -> each hazard.advance in order -> damage -> hand -> info,
            observation, reward
    """

    SUPPORTED_REWARD_MODES = keywords.REWARD_MODES
    SUPPORTED_RENDER_MODES = keywords.RENDER_MODES
    metadata = {"render_modes": [*keywords.RENDER_MODES], "render_fps": 30}  # noqa: RUF012 gymnasium's name and type

    _spec: EnvSpec | None = None

    def __init__(
        self,
        *,
        task: str = "HazardFire-v1",
        split: str = "train",
        scenes: Any = None,
        physics: str = "paper",
        severity: str = USUAL,
        hazards: Sequence[str] | None = None,
        affects_agent: bool | None = None,
        robot_uids: Any = "fetch",
        deterministic: bool = True,
        scene_every: int = 1,
        effects: str = "full",
        lighting: str = "day",
        perturb: str = "",
        senses: Sequence[str] = (),
        cameras: Sequence[str] = (),
        **maniskill_keywords: Any,
    ) -> None:
        """Every keyword of ManiSkill's BaseEnv works, and these.

        Args:
            task: Name of the task; gym.make fills it in.
            split: Which scenes the seeds choose from, and how long episodes last.
            scenes: JSON file of a scene, folder of them, or list of both: the seeds choose from these instead.
            physics: Preset of the hazards.
            severity: How strong the hazards of `realistic` are: moderate, severe or extreme.
            hazards: Of HazardCompound-v1: some of the registered hazards.
            affects_agent: Whether the hazards act on the robot; None: as the task says, most say no.
            robot_uids: The rescuer, by our name of it or by ManiSkill's; a tuple of two to four makes a team
                (docs/teams.md).
            deterministic: Rebuild the scene for every episode, so that a seed gives the same bits (about 1 s a reset).
            scene_every: With `deterministic=False`, n: every n-th reset without a seed draws a new scene; 0: none does.
                What they draw follows from the last seed, so that a training run sees the same scenes again.
            effects: How hazards look: full, fast or off. Never changes physics or labels, and nor does lighting.
            lighting: day, evening, night, failing (lamps go out during the episode), random (by the seed).
            perturb: What differs from training, by kind and level (docs/benchmark.md 4.4): "lighting:2,camera:1".
            senses: Of the head camera, beyond ManiSkill's: thermal, degraded (colour and depth through smoke and rain).
            cameras: Beside that of the head of each robot: wrist, shoulder; G1 has wrist_left, too.
            **maniskill_keywords: As in ManiSkill, but for these. num_envs: more than one needs a GPU. obs_mode: state
                modes need no renderer. render_backend: auto (the default) picks a GPU, else the CPU, else none.
                reconfiguration_freq: by default as `deterministic` and `scene_every` say, which it replaces.

        Raises:
            ValueError: For any name or number that is not allowed.
        """
        keywords.check_names(maniskill_keywords, HazardEnv.__init__)
        self.physics = checks.one_of(physics, PRESETS, "physics")
        self.perturbation = Perturbation.read(perturb)
        self.severity = self.perturbation.severity(severity, physics)
        made = playing(task_of(task, self.physics, hazards, self.severity), scenes)
        perturbing.check(self.perturbation, made)
        check_mode(self.perturbation.control, maniskill_keywords.get("control_mode"))
        self.choice = SceneChoice(made, split)
        self.task = dataclasses.replace(made, max_frames=TASKS[task].frames(split))
        self._most_frames = self.task.max_frames
        acts = acts_on_agent(task) if affects_agent is None else affects_agent
        self.affects_agent = checks.flag(acts, "affects_agent")
        self.deterministic = checks.flag(deterministic, "deterministic")
        self.effects_mode = checks.one_of(effects, EFFECTS, "effects")
        self.lighting = checks.one_of(lighting, LIGHTINGS, "lighting")
        self.senses = check_senses(senses, maniskill_keywords.get("obs_mode"))
        keywords.check_team(robot_uids, self.task, maniskill_keywords)
        self.cameras = check_cameras(cameras, robot_names(robot_uids))
        often = checks.whole(scene_every, 0, 2**31, "scene_every")
        chosen = self.deterministic or maniskill_keywords.get("reconfiguration_freq") is not None
        self.scene_turns = SceneTurns(0 if chosen else often)
        given = keywords.for_maniskill(maniskill_keywords, robot_uids, self.effects_mode, self.deterministic)
        self._draws = given["render_backend"] not in ("none", None)
        self.metadata = {"render_modes": keywords.modes_offered(self._draws), "render_fps": FREQUENCIES[physics][0]}
        super().__init__(**given)

    @property
    def spec(self) -> EnvSpec | None:
        """The spec with which gymnasium made this; its id names our package, so that a tool can make it again."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:
        self._spec = spec if spec is None else importable(spec)

    def reset(self, seed: Any = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Start an episode.

        `seed`: 0 to 2**32 - 1, or one per environment; `options`: {"scene": name or names, "env_idx": ...}.

        Raises ValueError for seeds and options that are not allowed; the episode is left unchanged.
        """
        seed, options = inputs.reset(self, seed, options)
        whole = len(options.get("env_idx", range(self.num_envs))) == self.num_envs
        if whole and self.scene_turns.next(seed is not None):
            options["reconfigure"] = True
        if inputs.STATES in options:
            options["scene"] = [s.name for s in self.specs]  # wherever scenes are rebuilt anyway
        elif "scene" in options:
            options["reconfigure"] = True
        elif seed is not None and "env_idx" not in options and self._other_scenes(seed):
            options["reconfigure"] = True
        if seed is not None:
            self._np_random = np.random.default_rng(seed)
            self._np_random_seed = seed if isinstance(seed, int) else seed[0]
        return super().reset(seed=seed, options=options)

    def step(self, action: Any) -> tuple[Any, Tensor, Tensor, Tensor, dict[str, Any]]:
        """Let one frame pass.

        Raises ValueError for an action of a wrong type, shape or number; the episode is left unchanged.
        """
        commands = self._step_action(inputs.action(self, action))
        self._elapsed_steps += 1
        info = self.get_info()
        raw = self.get_obs(info, unflattened=True)
        reward = self.get_reward(raw, commands, info)
        obs = self._last_obs = self._flatten_raw_obs(raw)
        broken, over = self.episode.sim_error.clone(), torch.logical_or(info["success"], info["fail"])
        if none_set(broken):
            return obs, reward, over, broken, info
        return finite(obs), torch.where(broken, 0.0, reward), over & ~broken, broken, info

    def advance(self, action: Any) -> dict[str, Any]:
        """One frame like `step`, without observation and reward: what skills use between decisions. Returns info."""
        self._step_action(inputs.action(self, action))
        self._elapsed_steps += 1
        return self.get_info()

    @property
    def observation_table(self) -> ObservationTable:
        """The meaning of each number of observations, and its range."""
        levels = {hazard.name: hazard.level for hazard in self.task.hazards}
        joints = {name: robot.robot.active_joints for name, robot in self.robots.items()}
        return ObservationTable(joints, self.task.observations, levels, self._most_frames)

    def limit_of(self, frames: int) -> int:
        """The limit that gymnasium's `frames` stands for: that of the split if `frames` is the task's usual one."""
        return self.task.max_frames if frames == TASKS[self.task.name].max_frames else frames

    def allow_frames(self, frames: int) -> None:
        """Let episodes last up to `frames`, if that is more than the task allows; observations are bounded by it."""
        if frames > self._most_frames:
            self._most_frames = frames
            self.update_obs_space(self._init_raw_obs)

    @cached_property
    def single_observation_space(self) -> gym.Space[Any]:
        """The space of one environment's observations, with true bounds."""
        return bounded(to_numpy(self._init_raw_obs), self.observation_table, to_numpy(self._get_obs_state_dict({})))

    def _get_obs_extra(self, info: dict[str, Any]) -> dict[str, Any]:
        hidden = self.obs_mode_struct.use_state
        if len(self.robots) == 1:
            return self.observer.extra(hidden)
        return {name: one.extra(hidden) for name, one in zip(self.robots, self.observers, strict=True)}

    def _get_obs_with_sensor_data(self, info: dict[str, Any], apply_texture_transforms: bool = True) -> dict[str, Any]:
        self.observer.show()
        obs = super()._get_obs_with_sensor_data(info, apply_texture_transforms)
        for seen in obs["sensor_data"].values():
            if "segmentation" in seen:
                seen["segmentation"] = seen["segmentation"].to(torch.int16)  # as ManiSkill's, for all shaders
        for name, one in zip(self.robots, self.observers, strict=True):
            part = obs if len(self.robots) == 1 else {**obs, "extra": obs["extra"][name]}
            one.add_hazard_image(part, in_extra=self.obs_mode == "pointcloud")
        return self.observer.with_noise(obs)

    def render(self) -> Any:
        """A picture of the present frame, as `render_mode` says. Raises ValueError where nothing renders."""
        if not self._draws:
            raise ValueError("render_backend must be auto, gpu or cpu for render(), got none: see `hazard-ms doctor`")
        self.observer.show(spectator=self.render_mode in ("human", "rgb_array"))  # other modes show sensors, too
        return super().render()

    def get_state_dict(self) -> dict[str, Any]:
        """ManiSkill's simulation and controllers, and under "hazard_ms" hazards, damage, rescue, hand and chance."""
        return {**snapshot.copied(super().get_state_dict()), "hazard_ms": snapshot.save(self.episode)}

    def set_state_dict(self, state: dict[str, Any], env_idx: Tensor | None = None) -> None:
        """Restore what `get_state_dict` gave: hazards, damage, chance exactly; bodies within docs/reliability.md M4.

        Raises ValueError for a state of another environment or scene, and for numbers that no sound simulation has;
        the episode is left unchanged.
        """
        every = list(range(self.num_envs))
        rows = checks.rows(every if env_idx is None else env_idx, self.num_envs, "env_idx").to(self.device)
        state = states.checked(state, self.get_state_dict(), self.episode, len(rows))
        plain = super().set_state_dict
        controllers = self.agent.set_controller_state
        snapshot.put_back(self.episode, self.members, state, rows, lambda rest: plain(rest, env_idx), controllers)
        self._elapsed_steps[rows] = self.world.frame[rows].to(self._elapsed_steps)

    def set_state(self, state: Any, env_idx: Tensor | None = None) -> None:
        """Restore a flat state, [E, D], as `get_state` gave it. Raises ValueError as `set_state_dict` does."""
        self.set_state_dict(snapshot.unflatten(checks.numbers(state, "the flat state"), self.get_state_dict()), env_idx)
