"""What is let go over the bag is rescued: an arm that something holds up gets there, or keeps what the hand holds."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from hazard_ms.skills import failures
from hazard_ms.skills.motor import stowing
from hazard_ms.skills.motor.arm import go, reach_for
from hazard_ms.skills.motor.grasping import pick_up
from hazard_ms.skills.motor.motion import turn_to
from hazard_ms.skills.motor.stowing import drop
from tests.worlds.arena import BAG_REACH, Arena, Box

HAND = (0.78, 0.0, 0.72)  # where the hand is at first, between boards and walls [m]
CAN = Box("can", (-0.65, 0.0, 0.03), (0.05, 0.05, 0.06), 0.2)
COMPARTMENT = (
    *(Box(f"board_{s}", (HAND[0], 0.0, HAND[2] + 0.14 * s), (0.3, 0.4, 0.04), target=False) for s in (-1, 1)),
    *(Box(f"wall_{s}", (HAND[0], 0.15 * s, HAND[2]), (0.3, 0.04, 0.3), target=False) for s in (-1, 1)),
)


def holding(arena: Arena) -> Arena:
    """The arena, with the can in the hand of the robot."""
    arena.restart(heading=np.pi)
    assert arena.run(pick_up(arena.stage, arena.index("can"))).ok
    return arena


@pytest.fixture(scope="module")
def outstretched() -> torch.Tensor:
    """All joints of a robot whose hand is there."""
    arena = holding(Arena((CAN,)))
    arena.run(turn_to(arena.stage, (1.0, 0.0)))
    assert arena.run(reach_for(arena.stage, HAND)).ok
    joints = arena.agent.robot.get_qpos().clone()
    arena.close()
    return joints


def test_an_arm_that_is_held_up_in_furniture_still_gets_over_the_bag(outstretched: torch.Tensor) -> None:
    arena = holding(Arena((*COMPARTMENT, CAN)))
    arena.agent.robot.set_qpos(outstretched)
    arena.agent.robot.set_qvel(torch.zeros_like(outstretched))
    folded = arena.run(go(arena.stage, arena.agent.tucked, 60))
    away = float(np.linalg.norm(arena.agent.hand() - arena.agent.bag_position()[0].numpy()))
    assert folded.reason == failures.BLOCKED and away > BAG_REACH  # let go now, the can would fall
    dropped = arena.run(drop(arena.stage))
    assert dropped.ok and bool(arena.world.safe[0, arena.index("can")]) and dropped.frames < 150
    arena.close()


def test_what_cannot_be_brought_over_the_bag_stays_in_the_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    arena = holding(Arena((CAN,)))
    monkeypatch.setattr(stowing, "OVER_BAG", 0.0)  # [m]: nowhere
    dropped = arena.run(drop(arena.stage))
    assert not dropped.ok and dropped.reason == failures.BLOCKED and arena.stage.held == arena.index("can")
    arena.close()
