"""The part of the environment that builds scenes, robot and senses, lets frames pass, and says what they are worth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch
from mani_skill.envs.sapien_env import BaseEnv
from mani_skill.sensors.camera import CameraConfig
from mani_skill.utils.common import to_tensor
from mani_skill.utils.structs.types import SimConfig
from torch import Tensor

from hazard_ms.env import assembling, placing
from hazard_ms.env.control_noise import lead_astray
from hazard_ms.env.leaves import Leaves
from hazard_ms.env.spaces import tensors
from hazard_ms.hazards.base import loosened
from hazard_ms.hazards.presets import FREQUENCIES
from hazard_ms.robots.mounting import mounted
from hazard_ms.robots.team import team_of
from hazard_ms.scenes.choice import SceneChoice
from hazard_ms.scenes.rearranged import rearranged
from hazard_ms.sensing.observations import Observer
from hazard_ms.simulation import building
from hazard_ms.simulation.chance import Chance
from hazard_ms.simulation.drawing.lighting import Lighting
from hazard_ms.simulation.drawing.viewpoint import corner_view
from hazard_ms.simulation.mitigation.door_grip import DoorGrip
from hazard_ms.simulation.world import World
from hazard_ms.spec import SceneSpec, Task, checks
from hazard_ms.spec.perturbation import Perturbation
from hazard_ms.spec.registry import MOST_ROBOTS
from hazard_ms.spec.registry.mitigations import tools_of
from hazard_ms.tasks.episode import rewards
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.tasks.episode.grasp import Hand
from hazard_ms.tasks.episode.members import Members
from hazard_ms.tasks.episode.situation import Situation

SPACING = 60.0  # between the scenes of a batch: nothing reaches a neighbour [m] [ours]


class BuiltEnv(BaseEnv):
    """Builds scenes, robot and senses in the order in which ManiSkill asks for them; lets frames pass, rates them."""

    task: Task
    choice: SceneChoice
    physics: str
    affects_agent: bool
    effects_mode: str
    lighting: str
    senses: tuple[str, ...]
    cameras: tuple[str, ...]
    perturbation: Perturbation
    specs: tuple[SceneSpec, ...] = ()
    world: World
    episode: Episode
    situation: Situation
    robots: Mapping[str, Any]  # by name; one, or those of a team
    members: Members  # the same, with their hands and places
    observers: tuple[Observer, ...]  # the senses of each robot

    @property
    def task_description(self) -> str:
        """The task in one sentence: what agents are told, and what demonstrations hold as the instruction.

        Where words are perturbed, it is that of the present episode in the first environment.
        """
        if not self.perturbation.words:
            return self.task.text
        sentences, chance = self.task.rewordings[self.perturbation.words - 1], Chance(1)
        chance.seed = self.world.chance.seed[:1].cpu()
        return sentences[int(float(chance.uniform("perturbed words", 1)) * len(sentences))]

    @property
    def _default_sim_config(self) -> SimConfig:
        control, physics = FREQUENCIES[self.physics]
        return SimConfig(sim_freq=physics, control_freq=control, spacing=SPACING)

    @property
    def _default_sensor_configs(self) -> list[CameraConfig]:
        """The robots' cameras that were asked for beside those of heads, whose pictures have as many pixels."""
        return mounted(self.cameras, self.robots)

    @property
    def _default_human_render_camera_configs(self) -> CameraConfig:
        """Third person: from the corner of the room that is farthest from where the agent starts."""
        spec = self.specs[0]
        return CameraConfig("render_camera", corner_view(spec), 768, 512, fov=1.15, near=0.05, far=60.0)

    def _load_agent(self, options: dict[str, Any]) -> None:
        self.specs = self.chosen(self._episode_seed, options.get("scene"))
        super()._load_agent(options, [building.pose_of((0.0, 0.0, 0.0), 0.0)] * MOST_ROBOTS)
        self.robots = team_of(self)

    def chosen(self, seeds: Sequence[int] | np.ndarray, wanted: Any = None) -> tuple[SceneSpec, ...]:
        """The `wanted` scenes, or where that is None those that `seeds`, [E], choose, as these seeds arrange them."""
        names = self.choice.names(wanted, seeds)
        numbered = zip(names, seeds, strict=True)
        return tuple(rearranged(self.task.build(name), int(s), self.perturbation) for name, s in numbered)

    def _other_scenes(self, seed: Any) -> bool:
        """Whether these seeds choose other scenes than those that are built."""
        self._set_main_rng(seed)
        seeds = np.resize(self._main_seed, self.num_envs)
        others = self.choice.names(None, seeds) != [s.name for s in self.specs]
        return others or (self.perturbation.rearranges and self.chosen(seeds) != self.specs)

    def _load_scene(self, options: dict[str, Any]) -> None:
        self.lights: Lighting | None = None  # where nothing renders, nothing shines
        loose = () if self.gpu_sim_enabled else tuple(loosened(self.task.hazards, spec) for spec in self.specs)
        self.actors = building.build_scenes(self.scene, self.specs, loose)
        self.bags = [building.build_bags(self.scene, self.num_envs, n) for n in range(len(self.robots))]
        self.world = building.make_world(self.specs, self.device, loose)
        first = next(iter(self.robots.values()))
        assembling.enlist(self.world, self.robots.values())
        if self.task.mitigations:
            self.world.equip(tools_of(self.task.mitigations))
        if self.task.doors_by_hand:
            self.world.door_grip = DoorGrip(self.specs, self.world.openings)
        self.episode = Episode(self.world, self.task.hazards, self.task.safe_place)
        self.leaves = Leaves(self.scene, self.world)
        self._physics_step = self.sim_timestep  # ManiSkill divides anew each time
        self.situation = Situation(self.episode, first, self.affects_agent)

    def _load_lighting(self, options: dict[str, Any]) -> None:
        self.lights = Lighting(self.scene, self.specs, self.lighting, self.perturbation.lighting)

    def _after_reconfigure(self, options: dict[str, Any]) -> None:
        self.world.handles = building.connect(self.scene, self.specs, self.actors, self.device)
        for robot in self.robots.values():
            robot.controller.reset()  # ManiSkill does it only after a state is restored, which needs its targets
        self.members = Members(self.episode, self.robots, self.affects_agent)
        self.contacts = assembling.contacts(self)
        self.observers = assembling.observers(self)

    def _initialize_episode(self, env_idx: Tensor, options: dict[str, Any]) -> None:
        seeds = torch.as_tensor(np.asarray(self._episode_seed), device=self.device)
        self.episode.begin(env_idx, seeds[env_idx])
        self.members.begin(env_idx)
        placing.place_all(self.world, env_idx, [*self.robots.values()])
        if self.task.arrange is not None:
            self.task.arrange(self.situation, env_idx)
        self.members.see()
        self.episode.begin_hazards(env_idx)
        self.leaves.move()

    def _step_action(self, action: Any) -> Any:
        """As ManiSkill's, which looks again at what an action is; one that is checked already needs no second look."""
        if self.gpu_sim_enabled or not isinstance(action, Tensor if len(self.robots) == 1 else dict):
            return super()._step_action(action)
        self.agent.set_action(action)
        self._before_control_step()
        for _ in range(self._sim_steps_per_control):
            self.agent.before_simulation_step()
            self._before_simulation_step()
            self.scene.step()
            self._after_simulation_step()
        self._after_control_step()
        return action

    def _before_control_step(self) -> None:
        self.leaves.move()
        if self.perturbation.control:
            for robot in self.members:
                lead_astray(robot.agent, robot.world, self.perturbation.control, self.control_freq)
        if self.affects_agent:
            self.members.yield_to_hazards()
        if self.contacts is not None:
            self.contacts.begin()
        if self.affects_agent and self.gpu_sim_enabled:
            self.scene.px.gpu_apply_articulation_target_velocity()  # ManiSkill has sent the velocities already

    def _before_simulation_step(self) -> None:
        self.leaves.push(self._sim_steps_per_control)
        self.episode.push(self._physics_step)

    def _after_simulation_step(self) -> None:
        if self.contacts is not None:
            self.contacts.look()

    def _after_control_step(self) -> None:
        if self.gpu_sim_enabled:
            self.scene._gpu_fetch_all()  # ManiSkill does it only after this
        self.world.read()
        if self.contacts is not None:
            self.contacts.end()
        self.members.see()
        self.episode.watch(self.members.joints())
        self.episode.advance(self.control_timestep)
        self.members.use_hands(self.control_timestep)

    def evaluate(self) -> dict[str, Tensor]:
        info = {**rewards.evaluate(self.task.goal, self.situation), **self.members.told()}
        return info if self.contacts is None else {**info, "robot_collisions": self.contacts.record.count.clone()}

    def compute_dense_reward(self, obs: Any, action: Any, info: dict[str, Any]) -> Tensor:
        return self.task.goal.dense(self.situation)

    def compute_normalized_dense_reward(self, obs: Any, action: Any, info: dict[str, Any]) -> Tensor:
        return self.task.goal.dense(self.situation) / self.task.goal.largest

    def compute_sparse_reward(self, obs: Any, action: Any, info: dict[str, Any]) -> Tensor:
        return self.task.goal.sparse(self.situation)

    def _flatten_raw_obs(self, obs: Any) -> Any:
        if self.obs_mode != "state":
            return super()._flatten_raw_obs(obs)
        return torch.cat(tensors(obs), dim=1)  # as ManiSkill's, in one step

    def label_table(self, env: int = 0) -> dict[int, tuple[str, str]]:
        """Segmentation ids of scene `env`: id -> (name, category). They may differ from scene to scene."""
        return self.observer.label_table(env)

    def target_ids(self, env: int = 0) -> list[int]:
        """The id in a segmentation of scene `env` for each target of the entries extra/target_*; 0 without one."""
        return self.observer.target_ids(env)

    def place_robot(self, position: tuple[float, float], heading: float, env: int = 0, robot: int = 0) -> None:
        """Put the robot of environment `env` at `position` x, y [m] with `heading` [rad], tucked and at rest.

        `robot`: which one of a team, from 0. Raises ValueError where it would touch a thing or a wall; then it stays
        where it is.
        """
        (x, y), (angle,) = checks.finite(position, 2, "position"), checks.finite((heading,), 1, "heading")
        checks.whole(env, 0, self.num_envs - 1, "env")
        one: Any = self.members[checks.whole(robot, 0, len(self.robots) - 1, "robot")].agent
        placing.check_clear(self.world, env, (x, y), one, self.robots)
        placing.put(self, one, torch.tensor([env], device=self.device), (x, y), angle)
        self.members.see()

    @property
    def observer(self) -> Observer:
        """The senses of the robot, or of the first of a team."""
        return self.observers[0]

    def _get_obs_sensor_data(self, *asked: Any, **named: Any) -> Any:
        return to_tensor(super()._get_obs_sensor_data(*asked, **named), self.device)  # a GPU may have drawn it

    @property
    def hand(self) -> Hand:
        """The hand of each agent: whether and which thing it holds."""
        return self.episode.hand
