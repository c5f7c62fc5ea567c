"""Controllers of ManiSkill that reach SAPIEN's joints directly where there is one scene on a CPU.

They set the same targets, bit for bit: ManiSkill's own go through a tensor and several checks for each joint, which for
one scene takes as long as the physics of the frame. Many scenes on a GPU go through ManiSkill as before.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from mani_skill.agents.controllers import (
    PDBaseForwardVelController,
    PDJointPosController,
    PDJointPosMimicController,
    PDJointVelController,
)
from numpy.typing import NDArray
from torch import Tensor

from hazard_ms.spec import rounding
from hazard_ms.spec.undocumented import BaseController, CombinedController

Floats = NDArray[np.float32]
ONE, MINUS_ONE = np.float32(1.0), np.float32(-1.0)  # numbers of Python would be converted each time


class DirectController(BaseController):
    """A controller of ManiSkill with its own way to the present joints, to commands in their units, and to SAPIEN."""

    def _initialize_joints(self) -> None:
        super()._initialize_joints()
        self._one = not self.scene.gpu_sim_enabled
        self._motors = [joint._objs[0] for joint in self.joints]
        self._numbers = self.active_joint_indices.cpu().numpy()

    def _clip_and_scale_action_space(self) -> None:
        super()._clip_and_scale_action_space()
        self._middle = 0.5 * (self.action_space_high + self.action_space_low)
        self._half = 0.5 * (self.action_space_high - self.action_space_low)
        self._scale = self._middle.cpu().numpy(), self._half.cpu().numpy()

    def _clip_and_scale_action(self, action: Tensor) -> Tensor:
        return self._middle + self._half * torch.clip(action, -1, 1)

    def act(self, action: Floats) -> None:
        """Do in the one scene what `action` says, [N]; the same as `set_action`."""
        self.set_action(torch.from_numpy(action[None]))

    def _commands(self, action: Floats) -> Floats:
        """The commands that `action` gives, [N], in the joints' units, [N]."""
        if not self._normalize_action:
            return action
        middle, half = self._scale
        return middle + half * np.minimum(np.maximum(action, MINUS_ONE), ONE)

    def _joints_now(self) -> Floats:
        """Positions of the controller's joints in the one scene [rad] or [m], [J]."""
        positions: Floats = self.articulation._objs[0].qpos[self._numbers]
        return positions

    @property
    def qpos(self) -> Tensor:
        """Positions of the controller's joints [rad] or [m], [E, J]."""
        return torch.from_numpy(self._joints_now()[None]) if self._one else super().qpos

    def set_drive_targets(self, targets: Tensor) -> None:
        """Bring the joints to `targets` [rad] or [m], [E, J]."""
        if not self._one:
            self.articulation.set_joint_drive_targets(targets, self.joints, self.active_joint_indices)
            return
        for motor, target in zip(self._motors, targets[0].tolist(), strict=True):
            motor.set_drive_target(target)

    def set_drive_velocity_targets(self, targets: Tensor) -> None:
        """Drive the joints at `targets` [rad/s] or [m/s], [E, J]."""
        if not self._one:
            self.articulation.set_joint_drive_velocity_targets(targets, self.joints, self.active_joint_indices)
            return
        for motor, target in zip(self._motors, targets[0].tolist(), strict=True):
            motor.set_drive_velocity_target(target)


class JointPos(DirectController, PDJointPosController):
    """Brings joints to positions, or changes them."""

    _target_qpos: Tensor

    def act(self, action: Floats) -> None:
        """Bring the joints where `action` says, or move them by it, [N]."""
        if self.config.interpolate:
            super().act(action)
            return
        targets = self._commands(action)
        if self.config.use_delta:
            targets = (self._target_qpos[0].numpy() if self.config.use_target else self._joints_now()) + targets
        if len(targets) != len(self._motors):
            targets = np.repeat(targets, len(self._motors))
        self._target_qpos = torch.from_numpy(targets[None].copy())
        for motor, target in zip(self._motors, targets.tolist(), strict=True):
            motor.set_drive_target(target)


class JointVel(DirectController, PDJointVelController):
    """Drives joints at velocities."""

    def set_action(self, action: Tensor) -> None:
        """Drive the joints as `action` says, [E, J]."""
        self.set_drive_velocity_targets(self._preprocess_action(action))


class Fingers(DirectController, PDJointPosMimicController):
    """Brings one joint to a position, which a second one repeats."""

    def _initialize_joints(self) -> None:
        super()._initialize_joints()
        pairs = [*zip(self.mimic_control_joint_indices.tolist(), self.mimic_joint_indices.tolist(), strict=True)]
        self._pair = pairs[0] if len(pairs) == 1 else None
        self._factor, self._shift = self._multiplier.cpu().numpy(), self._offset.cpu().numpy()

    def act(self, action: Floats) -> None:
        """Bring both joints where `action` says, [1]."""
        if self._pair is None or self.config.use_delta or self.config.interpolate:
            super().act(action)
            return
        led, follower = self._pair
        targets = self._target_qpos.numpy()[0]  # the same memory
        targets[led] = self._commands(action)[0]
        targets[follower] = (targets[led] * self._factor + self._shift)[0]
        for motor, target in zip(self._motors, targets.tolist(), strict=True):
            motor.set_drive_target(target)


class BaseForwardVel(DirectController, PDBaseForwardVelController):
    """Drives the base ahead and turns it."""

    def set_action(self, action: Tensor) -> None:
        """Drive as `action` says, [E, 2]."""
        action = self._preprocess_action(action)
        heading = self.qpos[:, 2:3]
        # ManiSkill turns (forward, 0) by a matrix, whose sums with a product of 0 have no negative zeros
        along = torch.cat([rounding.cos(heading), rounding.sin(heading)], dim=1) * action[:, :1] + 0.0
        self.set_drive_velocity_targets(torch.cat([along, action[:, 1:]], dim=1))

    def act(self, action: Floats) -> None:
        """Drive as `action` says, [2]."""
        forward, turn = self._commands(action)
        heading = torch.from_numpy(self._joints_now()[2:3])
        along = (
            float(np.float32(way.item()) * forward) + 0.0 for way in (rounding.cos(heading), rounding.sin(heading))
        )
        for motor, speed in zip(self._motors, (*along, float(turn)), strict=True):
            motor.set_drive_velocity_target(speed)


Part = tuple[Callable[[Floats], None], int, int]  # what acts on a part of an action, from and to where


def going_on(controller: Any) -> tuple[BaseController, ...]:
    """The parts of ManiSkill's `controller` that have something to do in the middle of a frame."""
    every = controller.controllers.values() if isinstance(controller, CombinedController) else (controller,)
    return tuple(p for p in every if not isinstance(p, DirectController) or getattr(p.config, "interpolate", False))


def parts_of(controller: Any) -> tuple[Part, ...]:
    """Functions that act in the one scene, each with its part of an action of ManiSkill's `controller`."""
    if not isinstance(controller, CombinedController):
        return ((_by_tensor(controller), 0, controller.single_action_space.shape[0]),)
    every = ((part, *controller.action_mapping[name]) for name, part in controller.controllers.items())
    return tuple((part.act if isinstance(part, DirectController) else _by_tensor(part), a, b) for part, a, b in every)


def _by_tensor(controller: BaseController) -> Callable[[Floats], None]:
    return lambda action: controller.set_action(torch.from_numpy(action[None]))


DIRECT = {c.__bases__[1]: c for c in (JointPos, JointVel, Fingers, BaseForwardVel)}


def direct(modes: dict[str, Any]) -> dict[str, Any]:
    """ManiSkill's configurations of controllers by control mode, with our controllers in the place of ManiSkill's."""
    for mode in modes.values():
        for part in mode.values() if isinstance(mode, dict) else ():
            part.controller_cls = DIRECT.get(part.controller_cls, part.controller_cls)
    return modes


def pose_of(link: Any) -> tuple[Tensor, Tensor]:
    """Position [m], [E, 3], and rotation w x y z, [E, 4], of ManiSkill's `link`, world frame."""
    if link.scene.gpu_sim_enabled:
        pose = link.pose
        return pose.p, pose.q
    pose = link._objs[0].entity_pose
    return torch.from_numpy(pose.p[None]), torch.from_numpy(pose.q[None])
