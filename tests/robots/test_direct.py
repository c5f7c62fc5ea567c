"""Our controllers set the joints' targets as ManiSkill's own do, but for the last bits of the base's drive."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch
from mani_skill.agents.controllers.base_controller import CombinedController
from numpy.typing import NDArray

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.robots.direct import DirectController

STEPS = 6
OTHER = 9.0  # a target that no action asks for


def targets(agent: Any) -> NDArray[np.float32]:
    """All targets of all joints, and then none of them any more."""
    motors = [joint._objs[0] for joint in agent.robot.active_joints]
    found = np.array([(*m.drive_target, *m.drive_velocity_target) for m in motors], np.float32)
    for motor in motors:
        motor.set_drive_target(OTHER)
        motor.set_drive_velocity_target(OTHER)
    return found


def of_maniskill(agent: Any, mode: str) -> CombinedController:
    """ManiSkill's controllers of a control mode."""
    parts = agent._controller_configs[mode]
    for part in parts.values():
        part.__dict__.pop("controller_cls", None)
    return CombinedController(parts, agent.robot, agent._control_freq, scene=agent.scene)


@pytest.mark.parametrize("robot", ["fetch", "g1"])
def test_targets_are_those_of_maniskill_in_every_control_mode(robot: str) -> None:
    env = gym.make("HazardFire-v1", obs_mode="none", render_backend="none", robot_uids=robot)
    env.reset(seed=0)
    agent: Any = env.unwrapped.agent
    rng = np.random.default_rng(0)
    direct = 0
    for mode in agent.supported_control_modes:
        agent.set_control_mode(mode)
        theirs, ours = of_maniskill(agent, mode), agent.controller
        direct += sum(isinstance(part, DirectController) for part in ours.controllers.values())
        assert sum(isinstance(part, DirectController) for part in theirs.controllers.values()) <= 2  # of the G1 alone
        theirs.reset()
        ours.reset()
        for step in range(STEPS):
            size = ours.single_action_space.shape[0]
            # beyond the range, too, and standing still in both signs of zero
            action = torch.from_numpy(rng.uniform(-1.2, 1.2, (1, size)).astype(np.float32)) * (step - 2)
            if mode == "pd_joint_pos":
                action = action * 0.1
            targets(agent)
            theirs.set_action(action.clone())
            wanted = targets(agent)
            agent.set_action(action.clone())
            for joint in agent.robot.active_joints[:3]:
                assert joint._objs[0].drive_velocity_target[0] != OTHER
            found = targets(agent)
            assert np.array_equal(np.signbit(found), np.signbit(wanted)), (mode, step)
            assert np.array_equal(found[2:], wanted[2:]), (mode, step)
            np.testing.assert_array_max_ulp(found, wanted, 2)  # ManiSkill's cosines are those of a library
            if not any(part.config.__dict__.get("use_delta") for part in ours.controllers.values()):
                ours.set_action(action.clone())  # as it is on a GPU
                assert targets(agent).tobytes() == found.tobytes(), (mode, step)
            qpos = agent.robot.get_qpos() + 0.1 * torch.from_numpy(rng.uniform(-1, 1, (1, 1)).astype(np.float32))
            agent.robot.set_qpos(qpos)
    env.close()
    assert direct >= len(agent.supported_control_modes) * 3
