"""Two controllers of the G1: hands that are open or shut, and legs that follow the hips down and up.

The legs' angles are those of two bars, thigh and shin, between the hips' axis and an ankle that stays where it is on
the floor.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from gymnasium import spaces
from mani_skill.agents.controllers import PDJointPosControllerConfig
from torch import Tensor

from hazard_ms.robots.direct import DirectController, JointPos
from hazard_ms.robots.g1_description import DOWN
from hazard_ms.spec import rounding

THIGH, SHIN = 0.30698, 0.30007  # hips' axis to knee, knee to ankle [m] (the installed URDF)
STANDING = 0.59942  # hips' axis above the ankle [m] (the installed URDF)
THIGH_TILT, SHIN_TILT = 0.15687, -0.16053  # forward from straight down, joints at 0 [rad] (the installed URDF)
RIGHT, LEFT = 0, 1  # the hands, in this order wherever there are two


def leg_angles(crouch: Tensor) -> Tensor:
    """Hip pitch, knee and ankle pitch [rad], [E, 3], with the hips `crouch` [m], [E], down their way.

    The foot stays flat on its place.
    """
    back, height = -DOWN[0] * crouch, STANDING + DOWN[2] * crouch
    span = torch.hypot(back, height)
    tilt = torch.atan2(back, height)
    thigh = tilt + rounding.acos(((THIGH**2 - SHIN**2 + span**2) / (2.0 * THIGH * span)).clamp(max=1.0))
    shin = tilt - rounding.acos(((SHIN**2 - THIGH**2 + span**2) / (2.0 * SHIN * span)).clamp(max=1.0))
    hip = THIGH_TILT - thigh
    knee = SHIN_TILT - hip - shin
    return torch.stack([hip, knee, -hip - knee], dim=-1)


class LegsController(JointPos):
    """Takes no action: the legs go where the crouch joint takes the hips until the end of the frame."""

    config: LegsControllerConfig
    act = DirectController.act

    def _initialize_action_space(self) -> None:
        self.single_action_space = spaces.Box(-1.0, 1.0, (0,), dtype=np.float32)

    def set_action(self, action: Any) -> None:
        """Aim at the legs' posture in a frame from now."""
        crouch = self.articulation.joints_map[self.config.crouch_joint].active_index[0]
        joints = self.articulation
        there = joints.get_qpos()[:, crouch] + joints.get_qvel()[:, crouch] / self._control_freq
        self._target_qpos = leg_angles(there.clamp(min=0.0)).repeat(1, len(self.joints) // 3)
        self.set_drive_targets(self._target_qpos)

    def before_simulation_step(self) -> None:
        """Nothing: the aim holds for the frame."""


@dataclass
class LegsControllerConfig(PDJointPosControllerConfig):
    """`joint_names`: hip pitch, knee, ankle pitch of each leg."""

    crouch_joint: str = "crouch_joint"
    controller_cls = LegsController


class HandsController(JointPos):
    """Two actions, for the right hand and the left: below 0 it shuts, else it opens.

    One hand of the two is in use: that which shut while the other did not hold. It stays in use until it has opened.
    """

    config: HandsControllerConfig
    act = DirectController.act
    shut: Tensor  # [E, 2], bool: commanded shut in the last frame
    used: Tensor  # [E], RIGHT or LEFT

    def _initialize_joints(self) -> None:
        super()._initialize_joints()
        self.shut = torch.zeros(self.scene.num_envs, 2, dtype=torch.bool, device=self.device)
        self.used = torch.full((self.scene.num_envs,), RIGHT, device=self.device)

    def _initialize_action_space(self) -> None:
        self.single_action_space = spaces.Box(-1.0, 1.0, (2,), dtype=np.float32)

    def reset(self) -> None:
        """Both hands open, the right one in use, in the environments that are reset."""
        super().reset()
        self.shut[self.scene._reset_mask] = False
        self.used[self.scene._reset_mask] = RIGHT

    def set_action(self, action: Tensor) -> None:
        """Shut or open each hand."""
        action = self._preprocess_action(action)
        before, self.shut = self.shut, action < 0.0
        rows = torch.arange(len(self.used), device=self.device)
        free = ~self.shut[rows, self.used] & ~before[rows, self.used]
        self.used = torch.where(free & self.shut[rows, 1 - self.used], 1 - self.used, self.used)
        grip = torch.tensor(self.config.grip, device=self.device)  # fingers of the right hand, then of the left
        half = len(self.joints) // 2
        self._target_qpos = self.shut.repeat_interleave(half, dim=1) * grip
        self.set_drive_targets(self._target_qpos)

    def closed(self) -> Tensor:
        """Whether the hand in use was last commanded shut, [E], bool."""
        return self.shut.gather(1, self.used[:, None])[:, 0]

    def use(self, hand: int) -> None:
        """Use `hand` of the first environment, unless the other one is shut."""
        self.used[0] = torch.where(self.shut[0, self.used[0]], self.used[0], hand)

    def get_state(self) -> dict[str, Tensor]:
        """The controller's state: the hand in use, [E, 1], and whether each hand is shut, [E, 2]."""
        return {"used": self.used[:, None].float(), "shut": self.shut.float()}

    def set_state(self, state: dict[str, Tensor] | None) -> None:
        """Restore the state that `get_state` gave."""
        if state is not None:
            self.used = state["used"][:, 0].to(self.used)
            self.shut = state["shut"] > 0.5


@dataclass
class HandsControllerConfig(PDJointPosControllerConfig):
    """`joint_names`: the right hand's fingers, then the left's, in the same order.

    `grip`: their joints when shut [rad]; 0 is open.
    """

    grip: tuple[float, ...] = ()
    controller_cls = HandsController
