"""Unitree's G1: a humanoid with two hands and a camera in its head, on a base that moves in the plane.

It derives from ManiSkill's own. It walks as on rails: the legs carry it, but do not step. They crouch, and the upper
body bends at the hips, so that its short arms reach the floor: 0.33 m down and 63 degrees forward at most, within the
limits of its joints. An action of skills moves, beside the base, one arm; torso, crouch and bend belong to that arm.
Which hand is in use, see HandsController.
"""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import sapien
import torch
from mani_skill.agents.base_agent import Keyframe
from mani_skill.agents.controllers import PDJointPosControllerConfig
from mani_skill.agents.robots.unitree_g1.g1_upper_body import UnitreeG1UpperBodyWithHeadCamera
from mani_skill.sensors.camera import CameraConfig
from numpy.typing import NDArray
from torch import Tensor

from hazard_ms.robots.direct import direct, pose_of
from hazard_ms.robots.g1_controllers import LEFT, RIGHT, HandsController, HandsControllerConfig, LegsControllerConfig
from hazard_ms.robots.g1_description import DOWN, LEG_JOINTS, g1_description
from hazard_ms.robots.planar import FORWARD_STEP, HEAD_FOV, TURN_STEP, PlanarRobot, turned
from hazard_ms.simulation.robot import MountedCamera
from hazard_ms.spec import Build

# per frame rate [N/Hz] and [N m/Hz]; as Fetch's for its weight: 33 kg reach full speed within two to four frames
BASE_FORCE = 15.0
BASE_DAMPING = 2e4  # [N s/m] and [N m s/rad]; holds the base's speed while the upper body swings
# way of the crouch that counts as a radian of an arm joint [m/rad]: 0.6 m/s when a skill moves it at 30 Hz
CROUCH = 0.2
TWIST = 0.8  # most that skills turn the torso to a side [rad]; the joint could turn by 2.6
# in the head, 30 degrees down as ManiSkill's
DOWN_40 = (float(np.cos(np.pi / 9.0)), 0.0, float(np.sin(np.pi / 9.0)), 0.0)  # 40 degrees about y, (w, x, y, z)
EYES = sapien.Pose([0.07, 0.0, 0.46], [np.cos(np.pi / 12), 0.0, np.sin(np.pi / 12), 0.0])

BODY = ("torso_joint", "crouch_joint", "bend_joint")
ARM = ("shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow_pitch", "elbow_roll")
ARMS = tuple([f"{side}_{part}_joint" for part in ARM] for side in ("right", "left"))  # by RIGHT, LEFT
ALONG = ("shoulder_pitch", "elbow_pitch")  # where an arm bends
FINGERS = ("zero", "one", "two", "three", "four", "five", "six")
GRIP = (0.0, -0.6, -0.8, 0.9, 0.9, 0.9, 0.9)  # the right hand's fingers when shut [rad]; the left's mirrored
MIRROR = np.array([1.0, 1.0, 1.0, 1.0, -1.0, -1.0, 1.0, -1.0])  # of the arm's joints from the right to the left
# from joints as skills see them to those of the simulator
SCALE = np.array([1.0, CROUCH, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0])

# Arm joints: torso turn, crouch, bend; shoulder pitch, roll, yaw; elbow; forearm roll. Here with the hands beside the
# thighs.
TUCKED = np.array([0.0, 0.0, 0.0, 0.4, -0.12, 0.0, 1.1, 0.0])
# The same with all joints in SAPIEN's order, left before right: base x, y, turn; crouch; bend; hip pitch; torso;
# shoulder pitch; knee;
# shoulder roll; ankle; shoulder yaw; elbow; forearm roll; seven fingers of each hand.
REST = np.array([0.0] * 8 + [0.4, 0.4, 0, 0, 0.12, -0.12, 0, 0, 0, 0, 1.1, 1.1, 0, 0] + [0.0] * 14)

# Where to look from for a way to reach something: straight ahead, bent, crouched and bent, up.
STRETCHED = (
    np.array([0.0, 0.0, 0.1, -0.8, 0.0, 0.0, 0.8, 0.0]),
    np.array([0.0, 0.3, 0.7, -1.2, 0.0, 0.0, 0.9, 0.0]),
    np.array([0.0, 1.5, 1.0, -1.3, 0.0, 0.0, 1.0, 0.0]),
    np.array([0.0, 0.0, 0.1, -2.0, 0.0, 0.0, 1.2, 0.0]),
)


class HazardG1(PlanarRobot, UnitreeG1UpperBodyWithHeadCamera):
    """G1 as a rescuer; `robot_uids="g1"` of the hazard environments."""

    uid = "hazard_g1"
    disable_self_collisions = True  # as Fetch's: arms pass close to the body
    keyframes = {"rest": Keyframe(pose=sapien.Pose(), qpos=REST)}
    build = Build(
        mass=35.0,  # Unitree's specification of the G1, with its battery
        width=0.13,  # both shins are as wide together and displace as much [measured on the installed URDF's meshes]
        drag_area=0.31,  # frontal area 0.286 m^2 [measured on the same meshes], drag coefficient 1.1
        friction=0.6,  # rubber soles on a dry floor [ours], as Fetch's wheels
        forward_step=FORWARD_STEP,
        turn_step=TURN_STEP,
        arm_step=0.1,
        radius=0.26,  # its hands are 0.256 m from its axis [measured on its collision shapes, tucked]
        shoulder=(0.0, 1.02),
        reach=0.46,
        elbow_room=0.45,
        nearest=0.25,
        stoops=((0.12, 1.00), (0.36, 0.78), (0.34, 0.50)),
        stance=0.19,  # length of its soles between the contacts of its description
        payload=3.0,  # of an arm (Unitree's specification of the G1 EDU; 2 kg for the basic one)
        drag_height=0.66,  # half of 1.32 m (Unitree's specification)
        rising=8.0,  # as long as getting up slowly and smoothly takes a G1 [He et al. 2025, arXiv 2502.12152; ours]
    )
    rest = REST
    ride_height = 0.0
    bag = (-0.20, 0.0, 0.64)  # behind the hips, out of the camera's sight, within reach of both hands
    head_camera = "head"
    mounted_cameras = MappingProxyType(
        {
            "wrist": MountedCamera("right_palm_link", (0.0, 0.0, 0.06), (1.0, 0.0, 0.0, 0.0), 2.0),
            "wrist_left": MountedCamera("left_palm_link", (0.0, 0.0, 0.06), (1.0, 0.0, 0.0, 0.0), 2.0),
            "shoulder": MountedCamera("torso_link", (0.05, 0.2, 0.35), DOWN_40, np.pi / 2.0),
        }
    )
    skill_control_mode = "pd_joint_pos"
    tucked = TUCKED
    outstretched = STRETCHED
    # the elbow back and out, in three ways, and before the body [ours: the quickest of 110 over tables of the scenes]
    between = (
        np.array([0.0, 0.0, 0.03, -0.45, -0.55, -0.4, 0.45, 0.0]),
        np.array([0.0, 0.0, 0.1, -0.4, -0.55, -0.8, 0.75, 0.0]),
        np.array([0.0, 0.0, 0.04, -0.9, -0.3, -0.05, 0.95, 0.0]),
        np.array([0.0, 0.0, 0.0, -0.3, -0.1, 0.9, 0.0, 0.0]),
    )
    pointing = tuple(np.deg2rad([30.0, 0.0, 60.0, -30.0]).tolist())  # up, too, to the top of a shelf

    @property
    def _sensor_configs(self) -> list[CameraConfig]:
        size = dict(width=256, height=256, fov=HEAD_FOV, near=0.01, far=100.0)
        return [CameraConfig(uid=self.head_camera, pose=EYES, entity_uid="head_link", **size)]

    @property
    def _controller_configs(self) -> dict[str, Any]:
        names = [*BODY, *ARMS[RIGHT], *ARMS[LEFT]]
        quicker = self._control_freq / 30.0  # the gains are for 30 Hz; so they keep the joints' way per frame
        stiffness = np.array([1e3, 4e4, 2e4] + [1e3] * 10) * quicker
        gains = dict(
            stiffness=stiffness.tolist(),
            damping=(np.array([1e2, 2e3, 2e3] + [1e2] * 10) * np.sqrt(quicker)).tolist(),
            force_limit=(np.array([1e2, 2e3, 5e2] + [1e2] * 10) * quicker).tolist(),
        )
        step = np.array([0.2, 0.2 * CROUCH, 0.2] + [0.2] * 10)  # [rad] and [m], as ManiSkill's
        modes = {
            "pd_joint_pos": PDJointPosControllerConfig(names, None, None, normalize_action=False, **gains),
            "pd_joint_delta_pos": PDJointPosControllerConfig(
                names, (-step).tolist(), step.tolist(), use_delta=True, **gains
            ),
        }
        return direct({name: self._parts(body) for name, body in modes.items()})

    def _parts(self, body: PDJointPosControllerConfig) -> dict[str, Any]:
        """All controllers of a control mode; `body` moves torso, crouch, bend and arms."""
        fingers = [f"{side}_{finger}_joint" for side in ("right", "left") for finger in FINGERS]
        free: dict[str, Any] = dict(lower=None, upper=None, normalize_action=False)
        hands = HandsControllerConfig(
            fingers, stiffness=10.0, damping=1.0, force_limit=5.0, grip=(*GRIP, *(-g for g in GRIP)), **free
        )
        legs = LegsControllerConfig(list(LEG_JOINTS), stiffness=4e3, damping=130.0, drive_mode="acceleration", **free)
        return {
            "body": body,
            "hands": hands,
            "legs": legs,
            "base": self.base_controller(BASE_DAMPING, BASE_FORCE),
        }

    def _load_articulation(self, initial_pose: Any = None) -> None:
        installed = Path(UnitreeG1UpperBodyWithHeadCamera.urdf_path)
        self.urdf_path = str(g1_description(installed, bare=not self.scene.can_render()))
        super()._load_articulation(initial_pose)

    def _after_init(self) -> None:
        super()._after_init()
        self.base_link = self.robot.links_map["base_link"]
        self.arm_joints = self.joint_numbers([*ARMS[RIGHT], *ARMS[LEFT]])
        self._arms = [self.joint_numbers([*BODY, *names]) for names in ARMS]
        self._tcps = (self.right_tcp, self.left_tcp)
        self._hands = [self.link_number(tcp) for tcp in self._tcps]
        self._along = [
            [*(self.link_number(self.robot.links_map[f"{side}_{part}_link"]) for part in ALONG), hand]
            for side, hand in zip(("right", "left"), self._hands, strict=True)
        ]

    @property
    def stretched(self) -> tuple[NDArray[np.float64], ...]:
        """Postures to search from [rad], of shape [J]; the first is the present one, which is the quickest to leave."""
        return (self.arm(), *self.outstretched)

    def gripper_pose(self) -> tuple[Tensor, Tensor]:
        right, left = (pose_of(tcp) for tcp in self._tcps)
        first = (self._hand_controller.used == RIGHT)[:, None]
        return torch.where(first, right[0], left[0]), torch.where(first, right[1], left[1])

    def grip_closed(self) -> Tensor:
        return self._hand_controller.closed()

    def use_hand(self, point: NDArray[np.float64], attempt: int = 0) -> None:
        """Choose the hand on the side of `point` [m], world frame, [3], and the other one at every second attempt."""
        x, y, heading = self.base()
        to_the_left = (point[1] - y) * np.cos(heading) - (point[0] - x) * np.sin(heading) > 0.0
        self._hand_controller.use(LEFT if bool(to_the_left) != bool(attempt % 2) else RIGHT)

    def bag_position(self) -> Tensor:
        """Mouth of the bag [m], world frame, [E, 3]; it goes down with the hips."""
        position, heading = self.base_pose()
        crouch = self.robot.get_qpos()[:, self._arms[RIGHT][1], None]
        return position + turned(position.new_tensor(self.bag) + crouch * position.new_tensor(DOWN), heading)

    def arm(self) -> NDArray[np.float64]:
        used = self._used
        return self.all_joints()[self._arms[used]] / self._signs(used)

    @cached_property
    def arm_limits(self) -> NDArray[np.float64]:
        limits = self.joint_limits([*BODY, *ARMS[RIGHT]], np.pi) / SCALE[:, None]
        limits[0] = -TWIST, TWIST
        return limits

    def kinematics(
        self, arm: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        used, joints = self._used, self.all_joints()
        joints[self._arms[used]] = arm * self._signs(used)
        hand, turn, jacobian = self.hand_kinematics(joints, self._hands[used], self._arms[used])
        return hand, turn, jacobian * self._signs(used)

    def arm_places(self, arm: NDArray[np.float64], resting: bool = False) -> NDArray[np.float64]:
        used, joints = self._used, self.rest.copy() if resting else self.all_joints()
        return self.link_places(joints, self._arms[used], arm * self._signs(used), self._along[used])

    def action(self, forward: float, turn: float, arm: NDArray[np.float64], open_hand: bool) -> NDArray[np.float32]:
        """The environment's action, [D], for `forward` [m], `turn` [rad] and the arm in use at `arm` [rad], shape [J].

        The other arm hangs beside the body, its hand open. Raises ValueError in another control mode.
        """
        used = self._used
        goal = np.clip(arm, self.arm_limits[:, 0], self.arm_limits[:, 1])
        both = [TUCKED[3:] * MIRROR[3:] ** side for side in (RIGHT, LEFT)]
        both[used] = (goal * self._signs(used))[3:]
        hands = np.ones(2)
        hands[used] = 1.0 if open_hand else -1.0
        body = np.concatenate([(goal * SCALE)[:3], *both])
        return self.make_action({"body": body, "hands": hands, "legs": [], "base": self.drive_share(forward, turn)})

    @property
    def _hand_controller(self) -> HandsController:
        hands: HandsController = self.controller.controllers["hands"]
        return hands

    @property
    def _used(self) -> int:
        """The hand in use in the first environment."""
        return int(self._hand_controller.used[0])

    @staticmethod
    def _signs(used: int) -> NDArray[np.float64]:
        """From the arm's joints as skills see them to those of the hand `used` [rad] and [m]."""
        return SCALE * (MIRROR if used == LEFT else 1.0)
