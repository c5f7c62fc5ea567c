"""The one environment class: it puts a task's scenes, hazards, robot and senses into ManiSkill's loop."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from mani_skill.envs.sapien_env import BaseEnv
from mani_skill.sensors.camera import CameraConfig
from mani_skill.utils.registration import register as register_maniskill
from mani_skill.utils.structs.types import SimConfig
from torch import Tensor

from hazard_ms import MAX_FRAMES, building, casting, checks, observing, rewards, snapshot
from hazard_ms.effects import shader_config
from hazard_ms.episode import Episode
from hazard_ms.hand import Hand
from hazard_ms.hazards.base import nobody
from hazard_ms.hazards.presets import FREQUENCIES, PRESETS
from hazard_ms.lighting import LIGHTINGS, Lighting
from hazard_ms.rendering import backend
from hazard_ms.robots import ROBOTS
from hazard_ms.scenes.files import playing
from hazard_ms.sensing.ray_camera import with_our_shaders
from hazard_ms.spec import SceneSpec
from hazard_ms.tasks import TASKS, task_of
from hazard_ms.world import World

EFFECTS = ("full", "fast", "off")


class HazardEnv(BaseEnv):
    """A ManiSkill environment whose world changes by itself.

    One step (a frame):
        robot.set_action, kept out of what would destroy it
        each physics step: world.read -> sum over hazards of hazard.force -> world.push (once) -> physics
        then: world.read -> guard -> chance.tick -> each hazard.advance in order -> damage -> hand -> observation, reward, info
    """

    SUPPORTED_REWARD_MODES = ("normalized_dense", "dense", "sparse", "none")
    SUPPORTED_RENDER_MODES = ("human", "rgb_array", "sensors", "all") if os.environ.get("DISPLAY") else ("rgb_array", "sensors", "all")
    metadata = {"render_modes": SUPPORTED_RENDER_MODES, "render_fps": 30}  # noqa: RUF012 gymnasium's name and type

    def __init__(
        self,
        *,
        task: str = "HazardFire-v1",
        split: str = "train",
        scenes: Any = None,
        physics: str = "paper",
        hazards: Sequence[str] | None = None,
        affects_agent: bool = False,
        robot_uids: str = "fetch",
        deterministic: bool = True,
        effects: str = "full",
        lighting: str = "day",
        num_envs: int = 1,
        obs_mode: str | None = None,
        reward_mode: str | None = None,
        render_mode: str | None = None,
        render_backend: str = "auto",
        sim_backend: str = "auto",
        sim_config: SimConfig | dict[str, Any] | None = None,
        sensor_configs: dict[str, Any] | None = None,
        human_render_camera_configs: dict[str, Any] | None = None,
        reconfiguration_freq: int | None = None,
        **maniskill_keywords: Any,
    ) -> None:
        """Every keyword of ManiSkill's BaseEnv works, and these.

        Args:
            task: Name of the task; gym.make fills it in.
            split: Which scenes the seeds choose from.
            scenes: JSON file of a scene, folder of them, or list of both: the seeds choose from these instead.
            physics: Preset of the hazards.
            hazards: Of HazardCompound-v1: some of flood, wind, fire.
            affects_agent: Whether the hazards act on the robot.
            robot_uids: The rescuer.
            deterministic: Rebuild the scene for every episode, so that a seed gives the same bits (about 1 s a reset).
            effects: How hazards look: full, fast or off. Never changes physics or labels.
            lighting: day, evening, night, failing (lamps go out during the episode), random (by the seed). Never changes physics or labels.
            num_envs: Scenes in one batch; more than one needs a GPU.
            obs_mode: As in ManiSkill; state modes need no renderer.
            render_backend: auto picks a GPU, else the CPU, else none.
            reconfiguration_freq: As in ManiSkill; None: as `deterministic` says.
            reward_mode, render_mode, sim_backend, sim_config, sensor_configs, human_render_camera_configs: As in ManiSkill.
            **maniskill_keywords: All other keywords of ManiSkill.

        Raises:
            ValueError: For any name or number that is not allowed.
        """
        self.physics = checks.one_of(physics, PRESETS, "physics")
        self.task = playing(task_of(checks.one_of(task, TASKS, "task"), self.physics, hazards), scenes)
        self.split = checks.one_of(split, self.task.splits, "split")
        self.scene_names = self.task.scenes(self.split)
        self.affects_agent = checks.flag(affects_agent, "affects_agent")
        self.deterministic = checks.flag(deterministic, "deterministic")
        self.effects_mode = checks.one_of(effects, EFFECTS, "effects")
        self.lighting = checks.one_of(lighting, LIGHTINGS, "lighting")
        checks.one_of(robot_uids, ROBOTS, "robot_uids")
        checks.backends(checks.whole(num_envs, 1, 2**20, "num_envs"), sim_backend, render_backend)
        checks.one_of(reward_mode or "none", self.SUPPORTED_REWARD_MODES, "reward_mode")
        if render_mode is not None:
            checks.one_of(render_mode, self.SUPPORTED_RENDER_MODES, "render_mode")
        if obs_mode is not None:
            observing.check_obs_mode(obs_mode)
        if reconfiguration_freq is None:  # only an environment that is rebuilt for every episode is bit-exact (measured)
            reconfiguration_freq = 1 if self.deterministic and num_envs == 1 else 0
        chosen = backend() if render_backend == "auto" else render_backend
        observing.check_renderer(obs_mode, chosen)
        pack = {"shader_pack": shader_config(self.effects_mode)} if chosen not in ("none", None) else {}
        self.world: World
        self.episode: Episode
        super().__init__(
            num_envs=num_envs,
            obs_mode=obs_mode,
            reward_mode=reward_mode,
            render_mode=render_mode,
            render_backend=chosen,
            sim_backend=sim_backend,
            sim_config=sim_config or {},
            sensor_configs=with_our_shaders({**pack, **(sensor_configs or {})}, num_envs, sim_backend),
            human_render_camera_configs=with_our_shaders({**pack, **(human_render_camera_configs or {})}, num_envs, sim_backend),
            robot_uids=ROBOTS[robot_uids].uid,
            reconfiguration_freq=checks.whole(reconfiguration_freq, 0, 2**31, "reconfiguration_freq"),
            **{**maniskill_keywords, "enhanced_determinism": True},
        )

    @property
    def _default_sim_config(self) -> SimConfig:
        control, physics = FREQUENCIES[self.physics]
        return SimConfig(sim_freq=physics, control_freq=control, spacing=60)  # 60 m: nothing reaches a neighbouring sub-scene

    @property
    def _default_human_render_camera_configs(self) -> CameraConfig:
        """Third person: from the corner of the room that is farthest from where the agent starts."""
        spec = self.specs[0]
        return CameraConfig("render_camera", building.corner_view(spec), 768, 512, fov=1.15, near=0.05, far=60.0)

    # ------------------------------------------------------------------ episode

    def reset(self, seed: Any = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Start an episode. `seed`: 0 to 2**32 - 1, or one per environment; `options`: {"scene": name or names, "env_idx": ...}."""
        seed = checks.seeds(seed, self.num_envs)
        options = checks.options(options, self.num_envs)
        if "env_idx" in options:
            options["env_idx"] = options["env_idx"].to(self.device)
        if "scene" in options:
            casting.by_name(options["scene"], self.task.all_scenes, self.num_envs)
            options["reconfigure"] = True
        elif seed is not None and "env_idx" not in options and self._other_scenes(seed):
            options["reconfigure"] = True
        if seed is not None:
            self._np_random, self._np_random_seed = np.random.default_rng(seed), seed if isinstance(seed, int) else seed[0]
        return super().reset(seed=seed, options=options)

    def _other_scenes(self, seed: Any) -> bool:
        """Whether these seeds choose other scenes than those that are built."""
        self._set_main_rng(seed)
        built = [s.name for s in getattr(self, "specs", ())]
        return casting.by_seed(np.resize(self._main_seed, self.num_envs), self.scene_names) != built

    def _choose(self, options: dict[str, Any]) -> tuple[SceneSpec, ...]:
        """The scene of each environment: as asked for, else by its seed."""
        if "scene" in options:
            names = casting.by_name(options["scene"], self.task.all_scenes, self.num_envs)
        else:
            names = casting.by_seed(self._episode_seed, self.scene_names)
        return tuple(self.task.build(n) for n in names)

    def _load_agent(self, options: dict[str, Any]) -> None:
        self.specs = self._choose(options)
        super()._load_agent(options, building.pose_of((0.0, 0.0, 0.0), 0.0))

    def _load_scene(self, options: dict[str, Any]) -> None:
        self.actors = building.build_scenes(self.scene, self.specs)
        self.bags = building.build_bags(self.scene, self.num_envs)
        self.world = building.make_world(self.specs, self.device)
        self.episode = Episode(self.world, self.task.hazards, self.task.safe_place)

    def _load_lighting(self, options: dict[str, Any]) -> None:
        self.lights = Lighting(self.scene, self.specs, self.lighting)

    def _after_reconfigure(self, options: dict[str, Any]) -> None:
        self.world.handles = building.connect(self.scene, self.specs, self.actors, self.device)
        self.observer = observing.Observer(self)

    def _initialize_episode(self, env_idx: Tensor, options: dict[str, Any]) -> None:
        seeds = torch.as_tensor(np.asarray(self._episode_seed), device=self.device)
        self.episode.begin(env_idx, seeds[env_idx])
        starts = [self.specs[e].agent_start for e in env_idx.tolist()]
        self.agent.place(env_idx, torch.tensor([s.position for s in starts]), torch.tensor([s.heading for s in starts]))
        self._read_agent()
        self.episode.begin_hazards(env_idx)

    # ------------------------------------------------------------------ one frame

    def step(self, action: Any) -> tuple[Any, Tensor, Tensor, Tensor, dict[str, Any]]:
        """One frame. Raises ValueError for an action of a wrong type, shape or number; the episode is then as it was before."""
        action = checks.action(action, self._orig_single_action_space, self.num_envs, self.agent.supported_control_modes)
        obs, reward, terminated, _, info = super().step(action)
        if not nobody(self.episode.sim_error):
            obs = observing.finite(obs)
        return (
            obs,
            torch.where(self.episode.sim_error, 0.0, reward),
            terminated & ~self.episode.sim_error,
            self.episode.sim_error.clone(),
            info,
        )

    def advance(self, action: Any) -> dict[str, Any]:
        """One frame like `step`, without observation and reward: what skills use between decisions. Returns info."""
        action = checks.action(action, self._orig_single_action_space, self.num_envs, self.agent.supported_control_modes)
        self._step_action(action)
        self._elapsed_steps += 1
        return self.get_info()

    def _before_control_step(self) -> None:
        if self.affects_agent:
            self.agent.carry(self.episode.slowed)
            self.agent.keep_out(self.episode.forbidden)
        if self.affects_agent and self.gpu_sim_enabled:
            self.scene.px.gpu_apply_articulation_target_velocity()  # ManiSkill has sent the velocities already

    def _before_simulation_step(self) -> None:
        self.episode.push(self.sim_timestep)

    def _after_control_step(self) -> None:
        if self.gpu_sim_enabled:
            self.scene._gpu_fetch_all()  # ManiSkill does it only after this
        self.world.read()
        self._read_agent()
        self.episode.watch(self.agent.robot.get_qpos())
        self.episode.advance(self.control_timestep)
        self.episode.use_hand(self.agent.gripper_pose(), self.agent.grip_closed(), self.agent.bag_position())

    @property
    def hand(self) -> Hand:
        """What the agents hold."""
        return self.episode.hand

    def _read_agent(self) -> None:
        self.world.agent_position[:], self.world.agent_heading[:] = self.agent.base_pose()

    # ------------------------------------------------------------------ what the user gets

    def evaluate(self) -> dict[str, Tensor]:
        return rewards.evaluate(self)

    def _get_obs_extra(self, info: dict[str, Any]) -> dict[str, Tensor]:
        return self.observer.extra()

    def _get_obs_with_sensor_data(self, info: dict[str, Any], apply_texture_transforms: bool = True) -> dict[str, Any]:
        self.observer.show()
        obs = super()._get_obs_with_sensor_data(info, apply_texture_transforms)
        for seen in obs["sensor_data"].values():
            if "segmentation" in seen:
                seen["segmentation"] = seen["segmentation"].to(torch.int16)  # as ManiSkill's own, whatever the shaders give
        return self.observer.add_hazard_image(obs)

    def render(self) -> Any:
        self.observer.show()
        return super().render()

    def label_table(self, env: int = 0) -> dict[int, tuple[str, str]]:
        """Segmentation ids of scene `env`: id -> (name, category). They may differ from scene to scene."""
        return self.observer.label_table(env)

    def compute_dense_reward(self, obs: Any, action: Any, info: dict[str, Any]) -> Tensor:
        return rewards.dense(self)

    def compute_normalized_dense_reward(self, obs: Any, action: Any, info: dict[str, Any]) -> Tensor:
        return rewards.dense(self) / rewards.LARGEST

    def compute_sparse_reward(self, obs: Any, action: Any, info: dict[str, Any]) -> Tensor:
        return rewards.sparse(self)

    # ------------------------------------------------------------------ save and restore

    def get_state_dict(self) -> dict[str, Any]:
        """Everything: ManiSkill's simulation and controller state, and under "hazard_ms" hazards, damage, rescue, hand and chance."""
        return {**super().get_state_dict(), "hazard_ms": snapshot.save(self)}

    def set_state_dict(self, state: dict[str, Any], env_idx: Tensor | None = None) -> None:
        """Restore what `get_state_dict` gave. Hazards, damage and chance exactly; bodies within reliability.md M4."""
        snapshot.put_back(self, state, env_idx, super().set_state_dict)

    def set_state(self, state: Any, env_idx: Tensor | None = None) -> None:
        """Restore a flat state, [E, D], as `get_state` gave it."""
        self.set_state_dict(snapshot.unflatten(torch.as_tensor(state), self.get_state_dict()), env_idx)


for _name, _frames in MAX_FRAMES.items():
    register_maniskill(_name, HazardEnv, max_episode_steps=_frames, default_kwargs={"task": _name})
