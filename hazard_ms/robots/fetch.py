"""Fetch: a wheeled base, a seven-joint arm and a camera in its head, after ManiSkill's own, with the benchmark's speed limits.

The base is moved by three joints (x, y, turn), so it neither tips nor climbs. It is driven by a velocity controller with the
benchmark's limits per frame, whatever the length of a frame. All of ManiSkill's control modes are there under their own names.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import sapien
import torch
from mani_skill.agents.base_agent import Keyframe
from mani_skill.agents.controllers import PDBaseForwardVelControllerConfig
from mani_skill.agents.registration import register_agent
from mani_skill.agents.robots.fetch import Fetch
from mani_skill.sensors.camera import CameraConfig
from numpy.typing import NDArray
from torch import Tensor

from hazard_ms.rendering import bare_robot
from hazard_ms.robots.robot import Build, Robot

FORWARD_STEP = 1.0 / 62.0  # walking speed of the benchmark [m per frame]
TURN_STEP = np.deg2rad(6.0)  # turning speed of the benchmark [rad per frame]
HEAD_FOV = 2.0 * np.pi / 3.0  # vertical field of view of the benchmark's head camera [rad]
RIDE_HEIGHT = 0.01  # gap under the base, so that a key or a pen does not wedge under it [m]
BASE_FORCE = 50.0  # per frame rate [N/Hz] and [N m/Hz]; brings the 115 kg to full speed and back within two to four frames
BASE_DAMPING = 8000.0  # [N s/m] and [N m s/rad]; 0.015 s to reach a commanded speed
BODY_STEP = 0.1  # what an action of 1 moves torso [m] and head [rad] by, as in ManiSkill's Fetch
TURN_AROUND = np.pi  # limit given to the arm joints that turn without end [rad]

SHUT = 0.005  # a finger target below this is a command to shut the hand [m]
LOOK_AHEAD = 3.0  # frames within which the base surely stops
RIM = 48  # points of the base's rim that are kept out of forbidden floor: 0.04 m apart, so that no corner of it slips between
BAG = (0.05, -0.13, 0.72)  # mouth of the bag in the base's frame, under the tucked hand [m]

# Joints in SAPIEN's order: base x, y, turn; torso; head pan; shoulder pan; head tilt; shoulder lift; upper arm roll; elbow;
# forearm roll; wrist flex; wrist roll; two fingers. Everything lies within 0.29 m of the base's axis and below the camera.
TUCKED = np.array([0, 0, 0, 0.05, 0, 1.32, 0.35, 1.40, -0.2, 1.72, 0, 1.66, 0, 0.04, 0.04])


@register_agent()
class HazardFetch(Fetch, Robot):
    """Fetch as a rescuer; `robot_uids="fetch"` of the hazard environments."""

    uid = "hazard_fetch"
    disable_self_collisions = True  # the arm folds close to the torso; hulls of neighbouring links overlap there
    keyframes = {"rest": Keyframe(pose=sapien.Pose([0, 0, RIDE_HEIGHT]), qpos=TUCKED)}
    build = Build(
        forward_step=FORWARD_STEP,
        turn_step=float(TURN_STEP),
        arm_step=0.1,
        radius=0.29,
        shoulder=(0.15, 0.84),
        reach=0.95,
        elbow_room=0.70,
        nearest=0.40,
    )
    head_camera = "head"
    skill_control_mode = "pd_joint_pos"
    tucked = TUCKED[[5, 7, 8, 9, 10, 11, 12]]
    folded = np.array([0.0, -1.2, 0.0, 2.2, 0.0, 1.6, 0.0])
    stretched = (
        np.array([0.0, -0.3, 0.0, 1.2, 0.0, 0.7, 0.0]),
        np.array([0.0, 0.6, 0.0, 0.6, 0.0, 0.6, 0.0]),
        np.array([0.0, 0.2, 1.57, 1.2, -1.57, 0.9, 0.0]),
        np.array([0.0, 0.2, -1.57, 1.2, 1.57, 0.9, 0.0]),
    )

    @property
    def _sensor_configs(self) -> list[CameraConfig]:
        pose = sapien.Pose()
        size = dict(width=256, height=256, fov=HEAD_FOV, near=0.01, far=100.0)
        return [CameraConfig(uid=self.head_camera, pose=pose, entity_uid="head_camera_link", **size)]

    @property
    def _controller_configs(self) -> dict[str, Any]:
        modes = super()._controller_configs
        base = PDBaseForwardVelControllerConfig(
            self.base_joint_names,
            lower=[-FORWARD_STEP * self._control_freq, -TURN_STEP * self._control_freq],
            upper=[FORWARD_STEP * self._control_freq, TURN_STEP * self._control_freq],
            damping=BASE_DAMPING,
            force_limit=BASE_FORCE * self._control_freq,
        )
        limits = self.arm_limits
        quicker = self._control_freq / 30.0  # ManiSkill tuned its gains at about 30 Hz; they keep the arm's way per frame
        for name, mode in modes.items():
            mode["base"] = base
            body = mode["body"]
            if name != "pd_joint_delta_pos_stiff_body":  # head pan, head tilt, torso: it carries the arm's weight and pushes
                body.stiffness, body.damping, body.force_limit = [1e3, 1e3, 4e4], [1e2, 1e2, 2e3], [100.0, 100.0, 2000.0]
            mode["arm"].damping *= np.sqrt(quicker)
            mode["arm"].force_limit *= quicker
            if name != "pd_joint_vel":
                mode["arm"].stiffness *= quicker
            if name in ("pd_joint_pos", "pd_joint_pos_vel"):
                mode["arm"].lower, mode["arm"].upper = limits[:, 0], limits[:, 1]
        first = self.skill_control_mode  # ManiSkill takes the first as the default
        return {first: modes[first], **modes}

    def _load_articulation(self, initial_pose: Any = None) -> None:
        if not self.scene.can_render():
            self.urdf_path = str(bare_robot(Path(Fetch.urdf_path)))
        super()._load_articulation(initial_pose)

    def _after_init(self) -> None:
        super()._after_init()
        names = [joint.name for joint in self.robot.active_joints]
        self._arm = [names.index(n) for n in self.arm_joint_names]
        self._base = torch.tensor([names.index(n) for n in self.base_joint_names], dtype=torch.int32, device=self.device)
        self._body = [names.index(n) for n in self.body_joint_names]
        for link in (self.l_wheel_link, self.r_wheel_link):
            for shape in (s for body in link._bodies for s in body.collision_shapes):
                shape.set_collision_groups([0, 0, 0, 0])  # they lie within the base's own hull and would scrape on the floor
        self._model = self.robot._objs[0].create_pinocchio_model()
        self._hand_index = self.robot._objs[0].links.index(self.tcp._objs[0])

    def place(self, rows: Tensor, position: Tensor, heading: Tensor) -> None:
        """Stand still and tucked, see Robot."""
        qpos = torch.as_tensor(TUCKED, dtype=torch.float32, device=self.device).repeat(len(rows), 1)
        qpos[:, :2] = position.to(qpos)
        qpos[:, 2] = heading.to(qpos)
        self.robot.set_pose(sapien.Pose([0, 0, RIDE_HEIGHT]))
        self.robot.set_qpos(qpos)
        self.robot.set_qvel(torch.zeros_like(qpos))
        held = self.robot.active_joints[3:]  # all but the base stay where they are until an action moves them
        self.robot.set_joint_drive_targets(qpos[:, 3:], held, torch.arange(3, qpos.shape[1], device=self.device))

    def base_pose(self) -> tuple[Tensor, Tensor]:
        """See Robot."""
        qpos = self.robot.get_qpos()
        return torch.cat([qpos[:, :2], torch.zeros_like(qpos[:, :1])], dim=-1), qpos[:, 2].clone()

    def gripper_pose(self) -> tuple[Tensor, Tensor]:
        """See Robot."""
        pose = self.tcp.pose
        return pose.p, pose.q

    def grip_closed(self) -> Tensor:
        """See Robot."""
        return self.controller.controllers["gripper"]._target_qpos[:, 0] < SHUT

    def bag_position(self) -> Tensor:
        """See Robot."""
        position, heading = self.base_pose()
        return position + _turned(position.new_tensor(BAG).expand_as(position), heading)

    def keep_out(self, forbidden: Callable[[Tensor], Tensor]) -> Tensor:
        """See Robot; looks LOOK_AHEAD frames ahead of the front half of the base's rim, and of its middle."""
        position, heading = self.base_pose()
        joints = self.robot.active_joints[:2]
        velocity = torch.stack([j.drive_velocity_target.reshape(-1) for j in joints], dim=-1)
        around = torch.arange(RIM, device=position.device) * (2.0 * np.pi / RIM)
        rim = self.build.radius * torch.stack([around.cos(), around.sin(), torch.zeros_like(around)], dim=-1)
        points = torch.cat([rim, torch.zeros_like(rim[:1])])
        now = position[:, None] + points
        then = now.clone()
        then[..., :2] += velocity[:, None] * (LOOK_AHEAD / self._control_freq)
        front = velocity @ points[:, :2].T >= 0.0  # so that it may always leave what burns beside or behind it
        stop = (forbidden(then) & ~forbidden(now) & front).any(-1)
        index = self._base[:2]
        self.robot.set_joint_drive_velocity_targets(torch.where(stop[:, None], 0.0, velocity), joints, index)
        return stop

    def arm(self) -> NDArray[np.float64]:
        """See Robot."""
        return self._joints()[self._arm]

    @cached_property
    def arm_limits(self) -> NDArray[np.float64]:
        """See Robot; joints that turn without end get half a turn to each side."""
        names = {joint.name: joint for joint in self.robot.active_joints}
        limits = np.array([names[n].limits[0].tolist() for n in self.arm_joint_names])
        return np.clip(limits, -TURN_AROUND, TURN_AROUND)

    def kinematics(self, arm: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """See Robot."""
        joints = self._joints()
        joints[self._arm] = arm
        self._model.compute_forward_kinematics(joints)
        pose = self._model.get_link_pose(self._hand_index).to_transformation_matrix()
        self._model.compute_full_jacobian(joints)
        local = self._model.get_link_jacobian(self._hand_index, True)[:, self._arm]
        turn = pose[:3, :3].astype(np.float64)
        jacobian = np.vstack([turn @ local[:3], turn @ local[3:]])
        return pose[:3, 3] + np.array([0.0, 0.0, RIDE_HEIGHT]), turn, jacobian

    def action(self, forward: float, turn: float, arm: NDArray[np.float64], open_hand: bool) -> NDArray[np.float32]:
        """See Robot."""
        if self.control_mode != self.skill_control_mode:
            raise ValueError(f"skills need control_mode={self.skill_control_mode!r}; the environment has {self.control_mode!r}")
        body = (TUCKED[self._body] - self._joints()[self._body]) / BODY_STEP
        parts = {
            "arm": np.clip(arm, self.arm_limits[:, 0], self.arm_limits[:, 1]),
            "gripper": [1.0 if open_hand else -1.0],
            "body": np.clip(body, -1.0, 1.0),
            "base": np.clip([forward / FORWARD_STEP, turn / TURN_STEP], -1.0, 1.0),
        }
        action = np.zeros(self.single_action_space.shape, dtype=np.float32)
        for name, (start, end) in self.controller.action_mapping.items():
            action[start:end] = parts[name]
        return action

    def _joints(self) -> NDArray[np.float64]:
        return self.robot.get_qpos()[0].cpu().numpy().astype(np.float64)


def _turned(vector: Tensor, heading: Tensor) -> Tensor:
    """`vector` [E, 3] turned about z by `heading` [rad], [E]."""
    c, s = heading.cos(), heading.sin()
    x, y, z = vector.unbind(-1)
    return torch.stack([c * x - s * y, s * x + c * y, z], dim=-1)
