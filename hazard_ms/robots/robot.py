"""What the skills ask of a robot. A robot that keeps this contract can be used by every skill, task and agent.

A robot may have two hands; then hand, arm, gripper and shoulder are those of the hand in use, and postures are the same for both. What
bends or lifts the shoulder counts as part of the arm.
Tensors are batched over E environments; numpy arrays are of the first environment, which is the one that skills run in.
"""

from __future__ import annotations

import abc
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from torch import Tensor


@dataclass(frozen=True)
class Build:
    """Size and limits of a robot."""

    forward_step: float  # most that the base moves in a frame [m]
    turn_step: float  # most that the base turns in a frame [rad]
    arm_step: float  # most that an arm joint turns in a frame when a skill moves it [rad]
    radius: float  # of the circle around the base that holds the tucked robot [m]
    shoulder: tuple[float, float]  # where the arm begins: in front of the base's middle, above the floor [m]
    reach: float  # from the shoulder to the middle of the hand, arm stretched [m]
    elbow_room: float  # from the base's middle: how far ahead nothing higher than a seat may stand where the arm unfolds [m]
    nearest: float  # horizontal distance from the base's middle below which the hand would meet its own base [m]
    stoops: tuple[tuple[float, float], ...] = ()  # other places where bending or crouching can bring the shoulder [m]

    def span(self, height: float) -> tuple[float, float]:
        """Nearest and farthest horizontal distance [m] from the base's middle at which the hand gets to `height` [m]."""
        far = 0.0
        for ahead, above in (self.shoulder, *self.stoops):
            left = self.reach**2 - (height - above) ** 2
            far = max(far, ahead + float(np.sqrt(left))) if left > 0.0 else far
        return self.nearest, far


class Robot(abc.ABC):
    """A robot with a base that drives and turns on the floor, an arm or two, and a camera in its head. World frame, metres, radians."""

    build: Build
    head_camera: str  # uid of the sensor
    skill_control_mode: str  # the control mode whose actions `action` makes
    tucked: NDArray[np.float64]  # arm joints where the arm is out of the way [rad], [J]
    folded: NDArray[np.float64]  # arm joints with the elbow up and the hand close, between tucked and reaching out [rad], [J]
    pointing: tuple[float, ...]  # how far below the horizon the fingers point at a thing, in the order of trying [rad]

    @abc.abstractmethod
    def place(self, rows: Tensor, position: Tensor, heading: Tensor) -> None:
        """Stand still and tucked in the environments `rows`, at `position` [len(rows), 2], facing `heading` [len(rows)]."""

    @abc.abstractmethod
    def base_pose(self) -> tuple[Tensor, Tensor]:
        """Middle of the base on the floor [m], [E, 3], and where it faces, anticlockwise from +x [rad], [E]."""

    @abc.abstractmethod
    def gripper_pose(self) -> tuple[Tensor, Tensor]:
        """Middle between the fingers [m], [E, 3], and its rotation (w, x, y, z), [E, 4]."""

    @abc.abstractmethod
    def grip_closed(self) -> Tensor:
        """Whether the hand was last commanded shut, [E], bool."""

    @abc.abstractmethod
    def bag_position(self) -> Tensor:
        """Mouth of the bag that the robot carries [m], [E, 3]."""

    @abc.abstractmethod
    def keep_out(self, forbidden: Callable[[Tensor], Tensor]) -> Tensor:
        """Take back this frame's drive where it leads onto more forbidden floor than the base covers now; bool [E]: where it did.

        `forbidden`: points [m], [E, P, 3] -> bool [E, P]. Call it after the action is set and before physics steps.
        """

    @abc.abstractmethod
    def carry(self, slowed: Callable[[Tensor], Tensor]) -> None:
        """Change this frame's drive to what is left of it: `slowed`: velocity over the floor [m/s], [E, 2] -> [E, 2].

        Call it after the action is set and before physics steps.
        """

    @abc.abstractmethod
    def arm(self) -> NDArray[np.float64]:
        """Arm joints [rad] of the first environment, [J]."""

    @property
    @abc.abstractmethod
    def arm_limits(self) -> NDArray[np.float64]:
        """Lower and upper limit of each arm joint [rad], [J, 2]."""

    @property
    @abc.abstractmethod
    def stretched(self) -> tuple[NDArray[np.float64], ...]:
        """Arm joints from which to look for a way to reach something [rad], [J] each."""

    @abc.abstractmethod
    def kinematics(self, arm: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Were the arm at `arm` [J]: the hand's position [3], rotation matrix [3, 3], and Jacobian [6, J] (linear, angular)."""

    @abc.abstractmethod
    def action(self, forward: float, turn: float, arm: NDArray[np.float64], open_hand: bool) -> NDArray[np.float32]:
        """The env's action that drives `forward` [m] and turns `turn` [rad] within one frame while the arm goes to `arm` [J]."""

    def use_hand(self, point: NDArray[np.float64], attempt: int = 0) -> None:  # noqa: B027 one hand needs no choice
        """Choose the hand that is to reach for `point` [m], in the first environment: another one at every further attempt.

        A hand that holds something stays in use.
        """

    def base(self) -> tuple[float, float, float]:
        """x, y [m] and heading [rad] of the base in the first environment."""
        position, heading = self.base_pose()
        return float(position[0, 0]), float(position[0, 1]), float(heading[0])

    def hand(self) -> NDArray[np.float64]:
        """Middle between the fingers in the first environment [m], [3]."""
        return self.gripper_pose()[0][0].cpu().numpy().astype(np.float64)

    def shoulder(self) -> NDArray[np.float64]:
        """Where the arm begins in the first environment [m], [3]."""
        x, y, heading = self.base()
        ahead, height = self.build.shoulder
        return np.array([x + ahead * np.cos(heading), y + ahead * np.sin(heading), height])
