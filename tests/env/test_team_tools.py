"""Tools of teams: every robot has its own hand and its own jet, and doors do not turn against anybody."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import torch

from hazard_ms.simulation.jet import spray
from hazard_ms.simulation.walls import blocked
from tests.env.test_teams import PLAIN, lay


def test_each_robot_of_a_team_has_a_jet_of_its_own() -> None:
    """Two extinguishers in two hands: an open jet uses up what its own robot holds, and both reach the fire."""
    env: Any = gym.make("HazardHouseFire-v1", robot_uids=("fetch", "fetch"), affects_agent=False, **PLAIN)
    env.reset(seed=1)
    base = env.unwrapped
    tools = base.world.equipment
    first, second = torch.nonzero(tools.tool[0]).flatten().tolist()
    for member, thing in zip(base.members, (first, second), strict=True):
        lay(base, thing, member.agent.gripper_pose()[0][0])
    grips = {m.name: m.agent.action(0.0, 0.0, m.agent.tucked, False) for m in base.members}
    env.step(grips)
    assert [int(m.hand.held[0]) for m in base.members] == [first, second]
    (own,) = base.members[1].world.jets
    place = base.members[1].agent.gripper_pose()[0]
    own.open(torch.tensor([0]), "powder", place, place + torch.tensor([[1.0, 0.0, 0.0]]))
    env.step(grips)
    left = tools.state.charge[0]
    assert left[first] == tools.full[0, first] and left[second] < tools.full[0, second]
    assert [bool(jet.flowing[0]) for jet in base.world.jets] == [False, True]
    ahead = place + torch.tensor([[2.0, 0.0, 0.0]])
    (hit,) = (spray(jet, base.world.walls, ahead[None])[0] for jet in base.world.jets if bool(jet.flowing[0]))
    assert bool(blocked(base.world.walls, place[None], ahead[None]).any()) or float(hit[0]) > 0.0
    state = base.get_state_dict()
    for _ in range(2):  # hands open, and then nothing is in them
        env.step({m.name: m.agent.action(0.0, 0.0, m.agent.tucked, True) for m in base.members})
    assert not base.world.jets[1].flowing.any()
    base.set_state_dict(state)
    assert bool(base.world.jets[1].flowing[0]) and not bool(base.world.jets[0].flowing[0])
    env.close()
