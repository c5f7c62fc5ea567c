"""Fetch: a wheeled base, a seven-joint arm and a camera in its head, with the benchmark's speed limits.

It derives from ManiSkill's own, whose control modes it has under their names, but for one that cannot take a step.
"""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import sapien
from mani_skill.agents.base_agent import Keyframe
from mani_skill.agents.robots.fetch import Fetch
from mani_skill.sensors.camera import CameraConfig
from numpy.typing import NDArray
from torch import Tensor

from hazard_ms.robots.direct import direct, pose_of
from hazard_ms.robots.planar import FORWARD_STEP, HEAD_FOV, TURN_STEP, PlanarRobot
from hazard_ms.robots.without_visuals import without_visuals
from hazard_ms.simulation.robot import MountedCamera
from hazard_ms.spec import Build

RIDE_HEIGHT = 0.01  # gap under the base, so that a key or a pen does not wedge under it [m]
# force per frame rate [N/Hz] and [N m/Hz]: brings the robot to full speed and back within two to four frames
BASE_FORCE = 50.0
BASE_DAMPING = 8000.0  # [N s/m] and [N m s/rad]; 0.015 s to reach a commanded speed
BODY_STEP = 0.1  # what an action of 1 moves torso [m] and head [rad] by, as in ManiSkill's Fetch
TURN_AROUND = np.pi  # limit given to the arm joints that turn without end [rad]

ALONG = ("shoulder_lift_link", "elbow_flex_link", "wrist_flex_link")  # where the arm bends
SHUT = 0.005  # a finger target below this is a command to shut the hand [m]

DOWN_40 = (float(np.cos(np.pi / 9.0)), 0.0, float(np.sin(np.pi / 9.0)), 0.0)  # 40 degrees about y, (w, x, y, z)

# Joints in SAPIEN's order: base x, y, turn; torso; head pan; shoulder pan; head tilt; shoulder lift; upper arm roll;
# elbow; forearm roll; wrist flex; wrist roll; two fingers [m] and [rad]. Everything lies within 0.29 m of the base's
# axis and below the camera.
TUCKED = np.array([0, 0, 0, 0.05, 0, 1.32, 0.35, 1.40, -0.2, 1.72, 0, 1.66, 0, 0.04, 0.04])


class HazardFetch(PlanarRobot, Fetch):
    """Fetch as a rescuer; `robot_uids="fetch"` of the hazard environments."""

    uid = "hazard_fetch"
    disable_self_collisions = True  # the arm folds close to the torso; hulls of neighbouring links overlap there
    keyframes = {"rest": Keyframe(pose=sapien.Pose([0, 0, RIDE_HEIGHT]), qpos=TUCKED)}
    build = Build(
        mass=115.0,  # 113.3 (Fetch Robotics, hardware overview), and a bag
        width=0.51,  # of the base; 0.508 m (Fetch Robotics, hardware overview)
        drag_area=0.7,  # that of a standing person (docs/physics.md 3.3)
        friction=0.6,  # rubber wheels on a dry floor (docs/physics.md 3.2)
        forward_step=FORWARD_STEP,
        turn_step=TURN_STEP,
        arm_step=0.1,
        radius=0.29,
        shoulder=(0.15, 0.84),
        reach=0.95,
        elbow_room=0.70,
        nearest=0.40,
        stance=0.51,  # of the base, as its width
        payload=6.0,  # of the arm at full extension (Fetch Robotics, hardware overview)
        drag_height=0.55,  # half of 1.10 m, its height with the torso down (Fetch Robotics, hardware overview)
    )
    rest = TUCKED
    ride_height = RIDE_HEIGHT
    bag = (0.05, -0.13, 0.72)  # under the tucked hand
    head_camera = "head"
    mounted_cameras = MappingProxyType(
        {
            # above the gripper, as ManiSkill's "fetch_hand"
            "wrist": MountedCamera("gripper_link", (-0.1, 0.0, 0.1), (1.0, 0.0, 0.0, 0.0), 2.0),
            # on the left of the torso, 40 degrees down: it turns with the base alone [ours]
            "shoulder": MountedCamera("torso_lift_link", (0.0, 0.25, 0.6), DOWN_40, np.pi / 2.0),
        }
    )
    skill_control_mode = "pd_joint_pos"
    tucked = TUCKED[[5, 7, 8, 9, 10, 11, 12]]
    # the elbow up at the side, in four ways, and before the body [ours: the quickest of 150 over tables of the scenes]
    between = (
        np.array([0.9, 0.0, 0.45, 0.7, 0.0, 0.5, 0.0]),
        np.array([1.1, -0.4, 0.4, 0.9, 0.0, 0.0, 0.0]),
        np.array([1.25, -0.65, 0.6, 1.05, 0.0, 0.0, 0.0]),
        np.array([1.2, -0.8, -0.4, 2.1, 0.0, 1.5, 0.0]),
        np.array([0.0, -1.2, 0.0, 2.2, 0.0, 1.6, 0.0]),
    )
    outstretched = (
        np.array([0.0, -0.3, 0.0, 1.2, 0.0, 0.7, 0.0]),
        np.array([0.0, 0.6, 0.0, 0.6, 0.0, 0.6, 0.0]),
        np.array([0.0, 0.2, 1.57, 1.2, -1.57, 0.9, 0.0]),
        np.array([0.0, 0.2, -1.57, 1.2, 1.57, 0.9, 0.0]),
    )

    pointing = tuple(np.deg2rad([60.0, 30.0, 85.0, 0.0]).tolist())

    @property
    def _sensor_configs(self) -> list[CameraConfig]:
        pose = sapien.Pose()
        size = dict(width=256, height=256, fov=HEAD_FOV, near=0.01, far=100.0)
        return [CameraConfig(uid=self.head_camera, pose=pose, entity_uid="head_camera_link", **size)]

    @property
    def _controller_configs(self) -> dict[str, Any]:
        modes = super()._controller_configs
        modes.pop("pd_ee_delta_pose_align", None)  # ManiSkill lists it, but its controller raises UnboundLocalError
        base = self.base_controller(BASE_DAMPING, BASE_FORCE)
        limits = self.arm_limits
        # ManiSkill tuned its gains at about 30 Hz; they keep the arm's way per frame
        quicker = self._control_freq / 30.0
        for name, mode in modes.items():
            mode["base"] = base
            body = mode["body"]
            # head pan, head tilt, torso: it carries the arm's weight and pushes
            if name != "pd_joint_delta_pos_stiff_body":
                body.stiffness, body.damping, body.force_limit = (
                    [1e3, 1e3, 4e4],
                    [1e2, 1e2, 2e3],
                    [100.0, 100.0, 2000.0],
                )
            mode["arm"].damping *= np.sqrt(quicker)
            mode["arm"].force_limit *= quicker
            if name != "pd_joint_vel":
                mode["arm"].stiffness *= quicker
            if name in ("pd_joint_pos", "pd_joint_pos_vel"):
                mode["arm"].lower, mode["arm"].upper = limits[:, 0], limits[:, 1]
        return direct(modes)

    def _load_articulation(self, initial_pose: Any = None) -> None:
        if not self.scene.can_render():
            self.urdf_path = str(without_visuals(Path(Fetch.urdf_path)))
        super()._load_articulation(initial_pose)

    def _after_init(self) -> None:
        super()._after_init()
        self._arm = self.arm_joints = self.joint_numbers(self.arm_joint_names)
        self._body = self.joint_numbers(self.body_joint_names)
        for link in (self.l_wheel_link, self.r_wheel_link):
            for shape in (s for body in link._bodies for s in body.collision_shapes):
                # they lie within the base's own hull and would scrape on the floor
                shape.set_collision_groups([0, 0, 0, 0])
        self._hand = self.link_number(self.tcp)
        self._along = [*(self.link_number(self.robot.links_map[name]) for name in ALONG), self._hand]

    def gripper_pose(self) -> tuple[Tensor, Tensor]:
        return pose_of(self.tcp)

    def grip_closed(self) -> Tensor:
        return self.controller.controllers["gripper"]._target_qpos[:, 0] < SHUT

    def arm(self) -> NDArray[np.float64]:
        return self.all_joints()[self._arm]

    @cached_property
    def arm_limits(self) -> NDArray[np.float64]:
        """Limits of the J arm joints [rad], shape [J, 2]; those that turn without end get half a turn to each side."""
        return self.joint_limits(self.arm_joint_names, TURN_AROUND)

    def kinematics(
        self, arm: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        joints = self.all_joints()
        joints[self._arm] = arm
        return self.hand_kinematics(joints, self._hand, self._arm)

    def arm_places(self, arm: NDArray[np.float64], resting: bool = False) -> NDArray[np.float64]:
        joints = self.rest.copy() if resting else self.all_joints()
        return self.link_places(joints, self._arm, arm, self._along)

    def action(self, forward: float, turn: float, arm: NDArray[np.float64], open_hand: bool) -> NDArray[np.float32]:
        body = (TUCKED[self._body] - self.all_joints()[self._body]) / BODY_STEP
        return self.make_action(
            {
                "arm": np.clip(arm, self.arm_limits[:, 0], self.arm_limits[:, 1]),
                "gripper": [1.0 if open_hand else -1.0],
                "body": np.clip(body, -1.0, 1.0),
                "base": self.drive_share(forward, turn),
            }
        )
