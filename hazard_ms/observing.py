"""What an environment shows: checks of observation modes, extra observations, the hazard image, and looks for skills and videos."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import torch
from mani_skill.envs.utils.observations import parse_obs_mode_to_struct
from torch import Tensor

from hazard_ms.building import extent_of_bag, pose_of
from hazard_ms.checks import one_of
from hazard_ms.effects import Looks
from hazard_ms.effects.entities import FRAMES_PER_SECOND
from hazard_ms.sensing.camera import AGENT, NOTHING, STRUCTURE, relabel
from hazard_ms.sensing.hazard_image import SIDE, enlarge, hazard_image, sample_points
from hazard_ms.sensing.ray_camera import take_over
from hazard_ms.sensing.target_table import TargetTable
from hazard_ms.sensing.view import View

if TYPE_CHECKING:
    from hazard_ms.env import HazardEnv

PLAIN_MODES = ("state", "state_dict", "none", "sensor_data", "pointcloud")
TEXTURES = ("rgb", "depth", "segmentation", "position", "normal", "albedo", "rgbd", "state")
SLOTS = 32  # rows of the target table in observations: an episode has 5 to 29 targets (benchmark.md 1)


def check_obs_mode(mode: str) -> None:
    """Raise ValueError unless `mode` is one that ManiSkill knows: a plain mode, or textures joined by "+"."""
    if not isinstance(mode, str):
        raise ValueError(f"obs_mode is {mode!r}; allowed: {', '.join(PLAIN_MODES)}, or textures joined by '+'")
    if mode in PLAIN_MODES:
        return
    for part in mode.split("+"):
        one_of(part, (*PLAIN_MODES, *TEXTURES), "obs_mode")
    parse_obs_mode_to_struct(mode)


def needs_pictures(mode: str | None) -> bool:
    """Whether observations of `mode` are drawn."""
    return mode is not None and mode not in PLAIN_MODES[:3]


def check_renderer(mode: str | None, chosen: str | None) -> None:
    """Raise ValueError where observations of `mode` are drawn and the renderer `chosen` is none."""
    if chosen in ("none", None) and needs_pictures(mode):
        raise ValueError(f"obs_mode {mode!r} needs a renderer, and there is none; allowed without: {', '.join(PLAIN_MODES[:3])}")


def finite(obs: Any) -> Any:
    """`obs` with 0 for what is not finite: a broken simulation must not reach a learner."""
    if isinstance(obs, dict):
        return {k: finite(v) for k, v in obs.items()}
    return torch.nan_to_num(obs, 0.0, 0.0, 0.0) if obs.is_floating_point() else obs


class Observer:
    """The senses of one built environment: made anew with every reconfiguration."""

    def __init__(self, env: HazardEnv) -> None:
        self.env = env
        self.table = TargetTable(env.world, SLOTS)
        self.renders = env.scene.can_render()
        hazards = env.task.hazards
        self.effects = Looks(hazards, env.scene.sub_scenes, env.specs, env.world, env.effects_mode) if self.renders else None
        self.labels = self._labels()
        for cameras in (env._sensors, env._human_render_cameras):
            take_over(cameras, lambda: int(env.world.frame[0]) / FRAMES_PER_SECOND)

    def _labels(self) -> Tensor:
        """Label of each of the renderer's segmentation ids, [E, S]: index along B, or STRUCTURE, AGENT, NOTHING."""
        env = self.env
        ids = [[a._objs[0].per_scene_id for a in row] for row in env.actors]
        links = [[obj.entity.per_scene_id for obj in link._objs] for link in env.agent.robot.links]
        highest = max(e.per_scene_id for s in env.scene.sub_scenes for e in s.entities)
        labels = torch.full((env.num_envs, highest + 1), STRUCTURE, dtype=torch.int64, device=env.device)
        labels[:, 0] = NOTHING
        for e, row in enumerate(ids):
            labels[e, torch.tensor(row)] = torch.arange(len(row), device=env.device)
            labels[e, torch.tensor([of[e] for of in links])] = AGENT
        for e, bag in enumerate(env.bags):
            labels[e, bag._objs[0].per_scene_id] = AGENT
        return labels

    def label_table(self, env: int = 0) -> dict[int, tuple[str, str]]:
        """What the ids of a segmentation mean in scene `env`: id -> (name, category); "structure", "agent" for what is no thing."""
        world, table = self.env.world, {}
        for number, label in enumerate(self.labels[env].tolist()):
            thing = [*world.specs[env].things][label] if label >= 0 else None
            plain = {STRUCTURE: "structure", AGENT: "agent", NOTHING: "nothing"}.get(label, "")
            table[number] = (plain, plain) if thing is None else (thing.name, thing.category)
        return table

    def show(self) -> None:
        """Make the hazards visible as they are now; to be called before a picture is taken."""
        mouths, headings = self.env.agent.bag_position(), self.env.world.agent_heading
        for bag, mouth, heading in zip(self.env.bags, mouths.tolist(), headings.tolist(), strict=False):
            depth = extent_of_bag()[2]
            bag._objs[0].set_pose(pose_of((mouth[0], mouth[1], mouth[2] - depth), heading).sp)
        if self.effects is not None:
            self.env.lights.show(self.env.world.chance.seed, self.env.world.frame)
            self.effects.light(self.env.lights.air())
            self.effects.update(self.env.world, self.env.episode.states, self.env.world.frame)

    def extra(self) -> dict[str, Tensor]:
        """Observations beside the robot's joints: agent, hand, time and targets; in state modes also where the targets are."""
        env, world = self.env, self.env.world
        gripper, _ = env.agent.gripper_pose()
        made = {
            "agent_pose": torch.cat([world.agent_position[:, :2], world.agent_heading[:, None]], dim=1),
            "gripper": gripper,
            "held": world.held.any(dim=1, keepdim=True).float(),
            "frame": world.frame[:, None].float(),
        }
        told = self.table.observe(world)
        made.update({f"target_{k}": v.flatten(1) for k, v in told.items()})
        if env.obs_mode_struct.use_state:
            made["target_position"] = self.table.of(world.position).flatten(1)
            made["target_damaged"] = self.table.of(env.episode.damage.damaged).float()
            for hazard in env.task.hazards:
                level = hazard.image(env.episode.states[hazard.name], world, world.position)
                made[f"target_{hazard.name}"] = self.table.of(level)
        return made

    def add_hazard_image(self, obs: dict[str, Any]) -> dict[str, Any]:
        """Put the hazard image of the head camera, [E, H, W, 1], into an observation with sensor data."""
        env = self.env
        name = env.agent.head_camera
        if name not in env._sensors:
            return obs
        seen = obs["sensor_data"][name] if "sensor_data" in obs else None
        depth = seen["depth"] if seen is not None and "depth" in seen else self._textures(depth=True)["depth"]
        params = obs["sensor_param"][name] if "sensor_param" in obs else env._sensors[name].get_params()
        image = enlarge(self._levels(depth, params), depth.shape[1])[..., None]
        if env.obs_mode == "pointcloud" or seen is None:
            obs["extra"]["hazard"] = image  # ManiSkill keeps nothing but points of the cameras' data
        else:
            seen["hazard"] = image
        return obs

    def _levels(self, depth: Tensor, params: dict[str, Tensor]) -> Tensor:
        """Levels of the first hazard at 16 x 16 points of the depth image, [E, 16, 16]."""
        env = self.env
        points = sample_points(depth, params["intrinsic_cv"], params["cam2world_gl"])
        hazard = env.task.hazards[0]
        return hazard_image(hazard, env.episode.states[hazard.name], env.world, points)

    def _textures(self, **wanted: bool) -> dict[str, Tensor]:
        every = dict.fromkeys(("rgb", "depth", "position", "segmentation", "normal", "albedo"), False)
        return self.env._sensors[self.env.agent.head_camera].get_obs(**{**every, **wanted})

    def look(self) -> tuple[Tensor, View]:
        """One look of the head camera of the first environment: rgb [H, W, 3] uint8, and the view for the semantic map."""
        env = self.env
        camera = env._sensors[env.agent.head_camera]
        self.show()
        env.scene.update_render(update_sensors=True, update_human_render_cameras=False)
        camera.capture()
        seen = self._textures(rgb=True, depth=True, segmentation=True)
        params = camera.get_params()
        levels = self._levels(seen["depth"], params)
        labels = relabel(seen["segmentation"], self.labels)
        return seen["rgb"][0], View.of(seen["depth"], params["intrinsic_cv"], params["cam2world_gl"], labels, levels)


__all__ = ["SIDE", "SLOTS", "Observer", "check_obs_mode"]
