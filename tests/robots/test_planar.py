"""Geometry of robots that stand on a floor."""

from __future__ import annotations

import math
from typing import Any

import pytest
import torch

from hazard_ms.robots.planar import turned
from tests.worlds.episodes import actions, made


def test_what_a_robot_carries_turns_with_it_anticlockwise() -> None:
    ahead = torch.tensor([[1.0, 0.0, 0.7], [1.0, 0.0, 0.7], [0.0, 2.0, -1.0]])
    headings = torch.tensor([math.pi / 2, -math.pi / 6, math.pi])
    expected = [[0.0, 1.0, 0.7], [math.sqrt(0.75), -0.5, 0.7], [0.0, -2.0, -1.0]]
    for row, wanted in zip(turned(ahead, headings).tolist(), expected, strict=True):
        assert row == pytest.approx(wanted, abs=1e-6)


@pytest.mark.parametrize("robot", ["fetch", "g1"])
def test_kinematics_do_not_depend_on_when_a_skill_first_asks(robot: str) -> None:
    """The model is made at the first question, which an episode may ask at its start or late."""
    env: Any = made("HazardFire-v1", robot)
    answers = []
    for frames in (0, 30):
        env.reset(seed=0)
        agent = env.unwrapped.agent
        for action in actions(env, 0, frames):
            env.step(action)
        assert "_model" not in vars(agent)
        agent.place(torch.tensor([0]), torch.tensor([[2.0, 1.0]]), torch.tensor([0.5]))
        answers.append([part.tobytes() for part in (*agent.kinematics(agent.tucked), agent.arm_places(agent.tucked))])
    env.close()
    assert answers[0] == answers[1]
