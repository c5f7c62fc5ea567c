"""Noise in control, for evaluations and demonstrations in which arm and base do not go quite where they are sent.

Arms go beside where they are sent, smoothly. A base that drives slips now and then: it turns to a side for a moment.
What is recorded as the action is what was sent. So demonstrations under such noise show how a teacher comes back from
where noise has led it, with labels that are free of noise (DART: Laskey et al., CoRL 2017, arXiv 1703.09327).
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from hazard_ms.simulation.chance import Chance
from hazard_ms.simulation.world import World
from hazard_ms.spec import rounding
from hazard_ms.spec.perturbation import LEAST_SHARE

MOST = (0.0, 0.03, 0.06, 0.12)  # greatest standard deviation of each joint by level, 0 to 3 [rad] [ours]
SPEEDS = "pd_joint_vel"  # ManiSkill's control mode that sends joints nowhere
KNOT = 5  # frames from one independent draw to the next, between which noise is led smoothly [ours]
TURNED = (0.0, 0.26, 0.52, 1.05)  # most that a base turns in one slip by level: 15, 30, 60 degrees [rad] [ours]
SLIP, APART, SHARE = 8, 30, 0.5  # frames of a slip; of a stretch in which one may be, and how many have one [ours]
BASE = 3  # joints that move the base of a robot: x, y, turn


def check_mode(level: int, control_mode: str | None) -> None:
    """Refuse noise of a `level` where actions are speeds of joints, which it would not change. Raises ValueError."""
    if level and control_mode == SPEEDS:
        raise ValueError(f"control in perturb must be 0 in the control mode {SPEEDS}, got {level}")


def lead_astray(agent: Any, world: World, level: int, fps: int) -> None:
    """Let the drives of all arms of `agent`, a robot, aim beside where this frame's action sends them, by `arm_noise`.

    A base that is sent to move turns by `slip` instead of as it is sent, where it slips. `world`: that of the robot,
    since each of a team has noise of its own; `fps`: frames a second. Call it after the action is set and before
    physics steps.
    """
    chance, robot = world.chance, world.crew.number
    _turn(agent, *slip(chance, level, robot), fps)
    numbers = agent.arm_joints
    joints = [agent.robot.active_joints[number] for number in numbers]
    targets = torch.stack([joint.drive_target.reshape(-1) for joint in joints], dim=-1)
    targets = targets + arm_noise(chance, len(numbers), level, robot)
    agent.robot.set_joint_drive_targets(targets, joints, torch.tensor(numbers, dtype=torch.int32, device=agent.device))
    if agent.scene.gpu_sim_enabled:
        agent.scene.px.gpu_apply_articulation_target_position()  # ManiSkill has sent those of the action already


def arm_noise(chance: Chance, joints: int, level: int, robot: int = 0) -> Tensor:
    """Angle by which each joint is off in this frame [rad], [E, joints], under a perturbation of `level`.

    Normal, as strong in all frames of an episode, and a function of its seed, of the frame and the number of the
    `robot` alone.
    """
    knot, share = chance.frame // KNOT, (chance.frame % KNOT).float()[:, None] / KNOT
    one, two = (_at(chance, frame).normal(_own("perturbed control", robot), joints) for frame in (knot, knot + 1))
    noise = ((1.0 - share) * one + share * two) / rounding.sqrt((1.0 - share) ** 2 + share**2)
    drawn = _at(chance, torch.zeros_like(knot)).uniform(_own("perturbed control amount", robot), 1)
    return MOST[level] * (LEAST_SHARE + (1.0 - LEAST_SHARE) * drawn) * noise


def slip(chance: Chance, level: int, robot: int = 0) -> tuple[Tensor, Tensor]:
    """Whether the base slips in this frame if it drives, [E], bool, and by how much it then turns in it [rad], [E].

    A function of the seed, the frame and the number of the `robot` alone: half of all stretches of APART frames have a
    slip of SLIP frames, to either side, under a perturbation of `level`.
    """
    drawn = _at(chance, chance.frame // APART).uniform(_own("perturbed drive", robot), 4)
    begin = (drawn[:, 1] * (APART - SLIP + 1)).floor()
    since = chance.frame % APART - begin
    slips = (drawn[:, 0] < SHARE) & (since >= 0) & (since < SLIP)
    amount = TURNED[level] * (LEAST_SHARE + (1.0 - LEAST_SHARE) * drawn[:, 2])
    return slips, torch.where(drawn[:, 3] < 0.5, -amount, amount) / SLIP


def _own(name: str, robot: int) -> str:
    """What the numbers called `name` are drawn by for a robot: the first, or the only one, has the plain name."""
    return f"{name} {robot}" if robot else name


def _turn(agent: Any, slips: Tensor, angle: Tensor, fps: int) -> None:
    """Turn the bases that slip and are sent to move by `angle` [rad] in this frame, [E], whatever they are sent."""
    joints = agent.robot.active_joints[:BASE]
    speeds = torch.stack([joint.drive_velocity_target.reshape(-1) for joint in joints], dim=-1)
    slips = slips & (speeds != 0.0).any(dim=-1)
    speeds[:, -1] = torch.where(slips, angle * fps, speeds[:, -1])
    agent.robot.set_joint_drive_velocity_targets(
        speeds, joints, torch.arange(BASE, dtype=torch.int32, device=agent.device)
    )
    if agent.scene.gpu_sim_enabled:
        agent.scene.px.gpu_apply_articulation_target_velocity()


def _at(chance: Chance, frames: Tensor) -> Chance:
    """The chance of the same episodes at other `frames`, [E]."""
    made = Chance(len(frames), frames.device)
    made.restart(torch.arange(len(frames), device=frames.device), chance.seed, frames)
    return made
