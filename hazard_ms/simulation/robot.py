"""The contract between robots and skills. A robot that keeps it can be used by every skill, task and agent.

A robot may have two hands; then hand, arm, gripper and shoulder are those of the hand in use, and postures are the same
for both. What bends or lifts the shoulder counts as part of the arm. Tensors are batched over E environments; numpy
arrays are of the first environment, which is the one that skills run in.
"""

from __future__ import annotations

import abc
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from torch import Tensor

from hazard_ms.spec import Build


class MountedCamera(NamedTuple):
    """A camera on a link of a robot, which looks along the x axis of its own frame, with z up."""

    link: str
    position: tuple[float, float, float]  # in the frame of the link [m]
    rotation: tuple[float, float, float, float]  # there, (w, x, y, z)
    fov: float  # of its height [rad]


class Robot(abc.ABC):
    """A robot with a base that drives and turns on the floor, an arm or two, and a camera in its head.

    World frame, metres, radians.
    """

    build: Build
    head_camera: str  # uid of the sensor
    # cameras beside that of the head by name, which an environment has if it is asked for them
    mounted_cameras: Mapping[str, MountedCamera] = MappingProxyType({})
    skill_control_mode: str  # the control mode whose actions `action` makes
    arm_joints: list[int]  # numbers of the joints of all arms, among all joints
    tucked: NDArray[np.float64]  # arm joints where the arm is out of the way [rad], [J]
    # arm joints that lead past furniture to where the hand is needed [rad], [J] each
    between: tuple[NDArray[np.float64], ...]
    outstretched: tuple[NDArray[np.float64], ...]  # arm joints that reach low and high [rad], [J] each
    pointing: tuple[float, ...]  # how far below the horizon the fingers point at a thing, in the order of trying [rad]

    @abc.abstractmethod
    def place(self, rows: Tensor, position: Tensor, heading: Tensor) -> None:
        """Stand still and tucked in the environments `rows`, [R].

        `position` [m], world frame, [R, 2]; `heading` [rad], anticlockwise from +x, [R].
        """

    @abc.abstractmethod
    def base_pose(self) -> tuple[Tensor, Tensor]:
        """Middle of the base on the floor [m], world frame, [E, 3]; its heading, anticlockwise from +x [rad], [E]."""

    @abc.abstractmethod
    def base_body(self) -> Any:
        """The rigid body of SAPIEN that is the base of the first robot: what drives it moves this."""

    @abc.abstractmethod
    def base_velocity(self) -> Tensor:
        """Velocity of the base over the floor [m/s], world frame, [E, 2]."""

    @abc.abstractmethod
    def gripper_pose(self) -> tuple[Tensor, Tensor]:
        """Middle between the fingers [m], world frame, [E, 3], and the hand's rotation (w, x, y, z), [E, 4]."""

    @abc.abstractmethod
    def grip_closed(self) -> Tensor:
        """Whether the hand was last commanded shut, [E], bool."""

    @abc.abstractmethod
    def bag_position(self) -> Tensor:
        """Mouth of the bag that the robot carries [m], world frame, [E, 3]."""

    @abc.abstractmethod
    def keep_out(self, forbidden: Callable[[Tensor], Tensor]) -> Tensor:
        """Take back this frame's drive where it leads onto more forbidden floor than the base covers now.

        `forbidden` tells of points [m], world frame, [E, P, 3], whether each is forbidden, bool [E, P]. Returns where
        the drive was taken back, bool [E]. Call it after the action is set and before physics steps.
        """

    @abc.abstractmethod
    def lie(self, down: Tensor) -> None:
        """Take all of this frame's drive, turns too, from robots that lie on the ground: `down`, bool [E].

        Call it after the action is set and before `carry`.
        """

    @abc.abstractmethod
    def carry(self, slowed: Callable[[Tensor], Tensor]) -> None:
        """Change this frame's drive to what is left of it.

        `slowed` takes the velocity of the base over the floor [m/s], world frame, [E, 2], and gives what is left of it,
        [E, 2]. Call it after the action is set and before physics steps.
        """

    @abc.abstractmethod
    def arm(self) -> NDArray[np.float64]:
        """Positions of the arm joints in the first environment [rad], [Joints]."""

    @property
    @abc.abstractmethod
    def arm_limits(self) -> NDArray[np.float64]:
        """Lower and upper limit of each of the J arm joints [rad], shape [J, 2]."""

    @property
    def stretched(self) -> tuple[NDArray[np.float64], ...]:
        """Postures of the arm from which a search for a reaching one starts [rad], each [Joints]."""
        return self.outstretched

    @abc.abstractmethod
    def kinematics(
        self, arm: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Pose of the hand, and how it moves, if the arm were at `arm` [rad], shape [J], in the first environment.

        Returns its position [m], world frame, [3], its rotation matrix, [3, 3], and its Jacobian, [6, J]: three rows of
        metres and three of radians per radian of each joint, in the world frame.
        """

    @abc.abstractmethod
    def arm_places(self, arm: NDArray[np.float64], resting: bool = False) -> NDArray[np.float64]:
        """Places of the joints along the arm, from the shoulder to the hand [m], world frame, [..., P, 3].

        The arm is as if it were at `arm` [rad], [..., J], in the first environment. With `resting`, places are in the
        frame of the base, and all other joints are as the robot has them at rest.
        """

    @abc.abstractmethod
    def action(self, forward: float, turn: float, arm: NDArray[np.float64], open_hand: bool) -> NDArray[np.float32]:
        """The environment's action, [D], for one frame of a skill.

        The base drives `forward` [m] and turns `turn` [rad], anticlockwise, while the arm goes to `arm` [rad], [J].
        Raises ValueError where the environment has another control mode than `skill_control_mode`.
        """

    def use_hand(self, point: NDArray[np.float64], attempt: int = 0) -> None:  # noqa: B027 one hand needs no choice
        """Choose the hand of the first environment that is to reach for `point` [m], world frame, [3].

        Every further `attempt` chooses another hand; a hand that holds something stays in use.
        """

    def base(self) -> tuple[float, float, float]:
        """Position x, y [m] and heading [rad] of the base in the first environment, world frame."""
        position, heading = self.base_pose()
        return float(position[0, 0]), float(position[0, 1]), float(heading[0])

    def hand(self) -> NDArray[np.float64]:
        """Middle between the fingers in the first environment [m], world frame, [3]."""
        return self.gripper_pose()[0][0].cpu().numpy().astype(np.float64)

    def shoulder(self) -> NDArray[np.float64]:
        """Place where the arm begins in the first environment [m], world frame, [3]."""
        x, y, heading = self.base()
        ahead, height = self.build.shoulder
        return np.array([x + ahead * np.cos(heading), y + ahead * np.sin(heading), height])
