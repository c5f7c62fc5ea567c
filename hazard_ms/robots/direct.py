"""Controllers of ManiSkill that reach SAPIEN's joints directly where there is one scene on a CPU.

They set the same targets, bit for bit: ManiSkill's own go through a tensor and several checks for each joint, which for
one scene takes as long as the physics of the frame. Many scenes on a GPU go through ManiSkill as before.
"""

from __future__ import annotations

from typing import Any

import torch
from mani_skill.agents.controllers import (
    PDBaseForwardVelController,
    PDJointPosController,
    PDJointPosMimicController,
    PDJointVelController,
)
from mani_skill.agents.controllers.base_controller import BaseController
from torch import Tensor


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

    def _clip_and_scale_action(self, action: Tensor) -> Tensor:
        return self._middle + self._half * torch.clip(action, -1, 1)

    @property
    def qpos(self) -> Tensor:
        """Positions of the controller's joints [rad] or [m], [E, J]."""
        if not self._one:
            return super().qpos
        return torch.from_numpy(self.articulation._objs[0].qpos[None, self._numbers])

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

    def set_action(self, action: Tensor) -> None:
        """Bring both joints where `action` says, [E, 1]."""
        if self._pair is None or self.config.use_delta or self.config.interpolate:
            super().set_action(action)
            return
        led, follower = self._pair
        action = self._preprocess_action(action)
        self._target_qpos[:, led : led + 1] = action
        self._target_qpos[:, follower : follower + 1] = action * self._multiplier + self._offset
        self.set_drive_targets(self._target_qpos)


class BaseForwardVel(DirectController, PDBaseForwardVelController):
    """Drives the base ahead and turns it."""

    def set_action(self, action: Tensor) -> None:
        """Drive as `action` says, [E, 2]."""
        action = self._preprocess_action(action)
        heading = self.qpos[:, 2:3]
        # ManiSkill turns (forward, 0) by a matrix, whose sums with a product of 0 have no negative zeros
        along = torch.cat([heading.cos(), heading.sin()], dim=1) * action[:, :1] + 0.0
        self.set_drive_velocity_targets(torch.cat([along, action[:, 1:]], dim=1))


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
