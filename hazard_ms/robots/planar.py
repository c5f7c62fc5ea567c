"""A base class of robots whose base is moved by three joints (x, y, turn), so that it neither tips nor sinks.

A base is driven by a velocity controller with the benchmark's limits per frame, whatever the length of a frame. A robot
names its joints and its resting posture; a mixin for agents of ManiSkill.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
import sapien
import torch
from mani_skill.agents.controllers import PDBaseForwardVelControllerConfig
from numpy.typing import NDArray
from torch import Tensor

from hazard_ms.robots.chain import Chain
from hazard_ms.robots.direct import Part, going_on, parts_of
from hazard_ms.simulation.robot import Robot
from hazard_ms.spec import rounding
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.undocumented import CombinedController

FORWARD_STEP = 1.0 / 62.0  # walking speed of the benchmark [m per frame]
TURN_STEP = float(np.deg2rad(6.0))  # turning speed of the benchmark [rad per frame]
HEAD_FOV = 2.0 * np.pi / 3.0  # vertical field of view of the benchmark's head camera [rad]
BASE_JOINTS = ("root_x_axis_joint", "root_y_axis_joint", "root_z_rotation_joint")  # as ManiSkill calls them
LOOK_AHEAD = 3.0  # frames within which the base surely stops
RIM = 48  # points of the base's rim that are kept out of forbidden floor: 0.04 m apart, so that no corner slips between


class PlanarRobot(Robot):
    """The part of the robots' contract that their base decides, and kinematics from a robot's own description."""

    uid: str  # ManiSkill's name of this kind of robot
    robot: Any  # ManiSkill's articulation
    controller: Any  # the controller of the present control mode
    controllers: dict[str, Any]  # those made so far, by control mode
    scene: Any  # ManiSkill's scene
    control_mode: str
    supported_control_modes: list[str]
    _default_control_mode: str
    single_action_space: Any
    device: torch.device
    _control_freq: int

    _acting: Any = None  # the controller of these:
    _acts: tuple[tuple[Part, ...], tuple[Any, ...]] = ((), ())

    rest: NDArray[np.float64]  # all joints where the robot stands tucked, in SAPIEN's order
    ride_height: float  # of the description's root above the floor [m]
    bag: tuple[float, float, float]  # mouth of the bag in the base's frame [m]

    def set_control_mode(self, control_mode: str | None = None) -> None:
        """Switch to `control_mode`; None: back to that of the start.

        Raises ValueError for a mode that the robot does not have.
        """
        wanted = self._default_control_mode if control_mode is None else control_mode
        super().set_control_mode(one_of(wanted, self.supported_control_modes, "control_mode"))  # type: ignore[misc]
        self.controller.set_drive_property()  # ManiSkill sets it only when it makes the controller

    def set_action(self, action: Tensor) -> None:
        """Give each controller its part of `action`, [E, D]. Raises ValueError for NaN, where asking costs no time."""
        if self.scene.gpu_sim_enabled:
            self.controller.set_action(action)
            return
        (numbers,) = action.numpy()
        if np.isnan(numbers).any():
            raise ValueError(f"an action must hold numbers, got {action.tolist()}")
        parts = self._parts_now()[0]
        if len(numbers) != parts[-1][2]:
            raise ValueError(f"an action must have {parts[-1][2]} numbers, got {len(numbers)}")
        for act, start, end in parts:
            act(numbers[start:end])

    def before_simulation_step(self) -> None:
        """Let those controllers go on that have something to do in the middle of a frame."""
        if self.scene.gpu_sim_enabled:
            self.controller.before_simulation_step()
            return
        for controller in self._parts_now()[1]:
            controller.before_simulation_step()

    def _parts_now(self) -> tuple[tuple[Part, ...], tuple[Any, ...]]:
        """What acts on each part of an action in the present control mode, and what goes on within a frame."""
        if self._acting is not self.controller:
            self._acting, self._acts = self.controller, (parts_of(self.controller), going_on(self.controller))
        return self._acts

    def action_size(self, control_mode: str) -> int:
        """Length of an action in `control_mode`, one of the robot's. The present mode stays."""
        if control_mode not in self.controllers:
            parts = self._controller_configs[control_mode]  # type: ignore[attr-defined]  # ManiSkill's agents have it
            told = {"articulation": self.robot, "control_freq": self._control_freq, "scene": self.scene}
            self.controllers[control_mode] = CombinedController(parts, **told)
        return int(self.controllers[control_mode].single_action_space.shape[0])

    def base_controller(self, damping: float, force: float) -> PDBaseForwardVelControllerConfig:
        """The base's controller: `damping` [N s/m] and [N m s/rad], `force` per frame rate [N/Hz] and [N m/Hz]."""
        return PDBaseForwardVelControllerConfig(
            list(BASE_JOINTS),
            lower=[-self.build.forward_step * self._control_freq, -self.build.turn_step * self._control_freq],
            upper=[self.build.forward_step * self._control_freq, self.build.turn_step * self._control_freq],
            damping=damping,
            force_limit=force * self._control_freq,
        )

    def joint_numbers(self, names: list[str]) -> list[int]:
        """Indices of the joints of these `names` among all joints."""
        every = [joint.name for joint in self.robot.active_joints]
        return [every.index(name) for name in names]

    def joint_limits(self, names: list[str], most: float) -> NDArray[np.float64]:
        """Lower and upper limits of the joints of these `names` [rad] or [m], [J, 2], within -`most` and `most`."""
        joints = {joint.name: joint for joint in self.robot.active_joints}
        return np.clip(np.array([joints[name].limits[0].tolist() for name in names]), -most, most)

    def place(self, rows: Tensor, position: Tensor, heading: Tensor) -> None:
        """Stand still and tucked, as the contract says, with all joints held where they are."""
        qpos = torch.as_tensor(self.rest, dtype=torch.float32, device=self.device).repeat(len(rows), 1)
        qpos[:, :2] = position.to(qpos)
        qpos[:, 2] = heading.to(qpos)
        self.robot.set_pose(sapien.Pose([0, 0, self.ride_height]))
        self.robot.set_qpos(qpos)
        self.robot.set_qvel(torch.zeros_like(qpos))
        held = self.robot.active_joints[3:]  # all but the base stay where they are until an action moves them
        self.robot.set_joint_drive_targets(qpos[:, 3:], held, torch.arange(3, qpos.shape[1], device=self.device))

    def base_pose(self) -> tuple[Tensor, Tensor]:
        if self.scene.gpu_sim_enabled:
            qpos = self.robot.get_qpos()
            return torch.cat([qpos[:, :2], torch.zeros_like(qpos[:, :1])], dim=-1), qpos[:, 2].clone()
        joints = self.robot._objs[0].qpos[:3]  # of our own
        heading = torch.from_numpy(joints[2:].copy())
        joints[2] = 0.0
        return torch.from_numpy(joints[None]), heading

    def base_body(self) -> Any:
        return self.robot.joints_map[BASE_JOINTS[-1]].child_link._objs[0]

    def base_velocity(self) -> Tensor:
        return self.robot.get_qvel()[:, :2]

    def bag_position(self) -> Tensor:
        position, heading = self.base_pose()
        return position + turned(position.new_tensor(self.bag).expand_as(position), heading)

    def keep_out(self, forbidden: Callable[[Tensor], Tensor]) -> Tensor:
        """Take back a drive onto forbidden floor; looks LOOK_AHEAD frames ahead of the front of the base's rim."""
        position, heading = self.base_pose()
        velocity = self._drive()
        around = torch.arange(RIM, device=position.device) * (2.0 * np.pi / RIM)
        circle = [rounding.cos(around), rounding.sin(around), torch.zeros_like(around)]
        rim = self.build.radius * torch.stack(circle, dim=-1)
        points = torch.cat([rim, torch.zeros_like(rim[:1])])
        now = position[:, None] + points
        then = now.clone()
        then[..., :2] += velocity[:, None] * (LOOK_AHEAD / self._control_freq)
        front = velocity @ points[:, :2].T >= 0.0  # so that it may always leave what burns beside or behind it
        stop = (forbidden(then) & ~forbidden(now) & front).any(-1)
        self._set_drive(torch.where(stop[:, None], 0.0, velocity))
        return stop

    def lie(self, down: Tensor) -> None:
        self._set_drive(torch.where(down[:, None], 0.0, self._drive(3)))

    def carry(self, slowed: Callable[[Tensor], Tensor]) -> None:
        self._set_drive(slowed(self._drive()))

    def _drive(self, count: int = 2) -> Tensor:
        """Velocities that the base's first `count` joints are to have [m/s], [rad/s], world frame, [E, count]."""
        return torch.stack([j.drive_velocity_target.reshape(-1) for j in self.robot.active_joints[:count]], dim=-1)

    def _set_drive(self, velocity: Tensor) -> None:
        index = torch.arange(velocity.shape[1], dtype=torch.int32, device=self.device)
        self.robot.set_joint_drive_velocity_targets(velocity, self.robot.active_joints[: len(index)], index)

    def hand_kinematics(
        self, joints: NDArray[np.float64], number: int, moving: list[int]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Pose of link `number`, and how the J joints `moving` move it, if all joints were at `joints` [rad] or [m].

        Returns its position [m], [3], its rotation matrix, [3, 3], and its Jacobian, [6, J], all in the world frame.
        """
        self._model.compute_full_jacobian(joints)  # which computes the poses of links, too
        pose = self._model.get_link_pose(number).to_transformation_matrix()
        local = self._model.get_link_jacobian(number, True)[:, moving]
        turn = pose[:3, :3].astype(np.float64)
        jacobian = np.vstack([turn @ local[:3], turn @ local[3:]])
        return pose[:3, 3] + np.array([0.0, 0.0, self.ride_height]), turn, jacobian

    def link_places(
        self, joints: NDArray[np.float64], moving: list[int], arms: NDArray[np.float64], numbers: list[int]
    ) -> NDArray[np.float64]:
        """Places of the P links `numbers` [m], world frame, [..., P, 3], if the J joints `moving` were at `arms`.

        `arms` [..., J] and `joints`, where all others are, in [rad] or [m].
        """
        chain = self._chains.get(tuple(numbers))
        if chain is None:
            chain = self._chains[tuple(numbers)] = Chain(self.robot._objs[0], numbers)
        places = chain.places(joints, moving, arms.reshape(-1, len(moving)))
        return places.reshape(*arms.shape[:-1], len(numbers), 3) + np.array([0.0, 0.0, self.ride_height])

    def make_action(self, parts: dict[str, Any]) -> NDArray[np.float32]:
        """The environment's action, [D], from the action of each controller by its name.

        Raises ValueError where the environment has another control mode than skills need.
        """
        if self.control_mode != self.skill_control_mode:
            raise ValueError(f"control_mode must be {self.skill_control_mode!r} for skills, got {self.control_mode!r}")
        action = np.zeros(self.single_action_space.shape, dtype=np.float32)
        for name, (start, end) in self.controller.action_mapping.items():
            action[start:end] = parts[name]
        return action

    def drive_share(self, forward: float, turn: float) -> NDArray[np.float64]:
        """Action of the base's controller, -1 to 1, [2], that drives `forward` [m] and `turn` [rad] in one frame."""
        return np.clip([forward / self.build.forward_step, turn / self.build.turn_step], -1.0, 1.0)

    def all_joints(self) -> NDArray[np.float64]:
        """Positions of all joints of the first environment [rad] or [m], [Joints]."""
        if self.scene.gpu_sim_enabled:
            return self.robot.get_qpos()[0].cpu().numpy().astype(np.float64)
        return np.asarray(self.robot._objs[0].qpos, np.float64)  # past ManiSkill's tensors, in a fifth of the time

    @cached_property
    def _chains(self) -> dict[tuple[int, ...], Chain]:
        """The chains of joints to the links that were asked for, by their numbers."""
        return {}

    @cached_property
    def _model(self) -> Any:
        """SAPIEN's model of the robot's kinematics: made when a skill first asks, since many episodes play none."""
        return self.robot._objs[0].create_pinocchio_model()

    def link_number(self, link: Any) -> int:
        """Index of `link` among the robot's links."""
        return int(self.robot._objs[0].links.index(link._objs[0]))


def turned(vector: Tensor, heading: Tensor) -> Tensor:
    """The `vector`, [E, 3], turned about z by `heading` [rad], [E], in the units of `vector`."""
    c, s = rounding.cos(heading), rounding.sin(heading)
    x, y, z = vector.unbind(-1)
    return torch.stack([c * x - s * y, s * x + c * y, z], dim=-1)
