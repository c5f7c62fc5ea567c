"""Contacts of robots are looked for where two of them can touch, and gaps only when something may have closed them."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from hazard_ms.tasks.episode.encounters import MARGIN, Contacts, _aside, _gaps
from tests.env.test_teams import PLAIN, still


def test_gaps_of_boxes_and_of_cylinders() -> None:
    ones = np.array([[[0.0, 5.0], [0.0, 0.0], [0.0, 0.0]], [[1.0, 6.0], [1.0, 1.0], [1.0, 1.0]]])
    other = np.array([[[1.5], [0.2], [3.0]], [[2.0], [0.4], [4.0]]])
    assert _gaps(ones, other).tolist() == [[2.0], [3.0]]  # along z; along x
    discs, another = np.array([[0.0, 3.0], [0.0, 4.0], [1.0, 2.0]]), np.array([[0.0], [0.0], [0.5]])
    assert _aside(discs, another).tolist() == [[-1.5], [2.5]]


@pytest.mark.parametrize("robots", [("fetch", "fetch"), ("fetch", "g1")])
def test_gaps_are_looked_at_again_when_robots_have_moved(robots: tuple[str, str], monkeypatch: Any) -> None:
    env: Any = gym.make("HazardFire-v1", robot_uids=robots, **PLAIN)
    env.reset(seed=1)
    base, looks = env.unwrapped, []
    before = Contacts._look_at_gaps
    monkeypatch.setattr(Contacts, "_look_at_gaps", lambda self: looks.append(before(self)) or looks[-1])
    for _ in range(20):
        env.step(still(env))
    assert len(looks) <= 3 and looks[-1] > MARGIN  # they settle, and then they stand
    radii = [m.agent.build.radius for m in base.members]
    (x, y, _), (ox, oy, _) = (m.agent.base() for m in base.members)
    gap = np.hypot(ox - x, oy - y) - sum(radii)
    assert looks[-1] <= gap + 1e-6  # never more than there is
    looks.clear()
    mover = base.members[1].agent
    mover.robot.set_qpos(mover.robot.get_qpos() + np.eye(mover.robot.get_qpos().shape[1])[:1].astype("float32") * 0.4)
    env.step(still(env))
    assert len(looks) == 1
    env.close()
