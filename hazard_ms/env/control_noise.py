"""Noise in the control of arms, for evaluations and demonstrations in which joints do not go quite where they are sent.

What is recorded as the action is what was sent. So demonstrations under such noise show how a teacher comes back from
where noise has led it, with labels that are free of noise (DART: Laskey et al., CoRL 2017, arXiv 1703.09327).
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from hazard_ms.simulation.chance import Chance
from hazard_ms.spec import rounding
from hazard_ms.spec.perturbation import LEAST_SHARE

MOST = (0.0, 0.03, 0.06, 0.12)  # greatest standard deviation of each joint by level, 0 to 3 [rad] [ours]
SPEEDS = "pd_joint_vel"  # ManiSkill's control mode that sends joints nowhere
KNOT = 5  # frames from one independent draw to the next, between which noise is led smoothly [ours]


def check_mode(level: int, control_mode: str | None) -> None:
    """Refuse noise of a `level` where actions are speeds of joints, which it would not change. Raises ValueError."""
    if level and control_mode == SPEEDS:
        raise ValueError(f"control in perturb must be 0 in the control mode {SPEEDS}, got {level}")


def lead_astray(agent: Any, chance: Chance, level: int) -> None:
    """Let the drives of all arms of `agent`, a robot, aim beside where this frame's action sends them, by `arm_noise`.

    Call it after the action is set and before physics steps.
    """
    numbers = agent.arm_joints
    joints = [agent.robot.active_joints[number] for number in numbers]
    targets = torch.stack([joint.drive_target.reshape(-1) for joint in joints], dim=-1)
    targets = targets + arm_noise(chance, len(numbers), level)
    agent.robot.set_joint_drive_targets(targets, joints, torch.tensor(numbers, dtype=torch.int32, device=agent.device))
    if agent.scene.gpu_sim_enabled:
        agent.scene.px.gpu_apply_articulation_target_position()  # ManiSkill has sent those of the action already


def arm_noise(chance: Chance, joints: int, level: int) -> Tensor:
    """Angle by which each joint is off in this frame [rad], [E, joints], under a perturbation of `level`.

    Normal, as strong in all frames of an episode, and a function of its seed and of the frame alone.
    """
    knot, share = chance.frame // KNOT, (chance.frame % KNOT).float()[:, None] / KNOT
    one, two = (_at(chance, frame).normal("perturbed control", joints) for frame in (knot, knot + 1))
    noise = ((1.0 - share) * one + share * two) / rounding.sqrt((1.0 - share) ** 2 + share**2)
    drawn = _at(chance, torch.zeros_like(knot)).uniform("perturbed control amount", 1)
    return MOST[level] * (LEAST_SHARE + (1.0 - LEAST_SHARE) * drawn) * noise


def _at(chance: Chance, frames: Tensor) -> Chance:
    """The chance of the same episodes at other `frames`, [E]."""
    made = Chance(len(frames), frames.device)
    made.restart(torch.arange(len(frames), device=frames.device), chance.seed, frames)
    return made
