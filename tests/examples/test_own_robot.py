"""A robot from outside the package drives at its own speed, is pushed with its own weight, and is played by name."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.spec.registry import ROBOTS
from tests.worlds.registering import loaded

EXAMPLE = Path(__file__).parents[2] / "examples" / "own_robot.py"
SHORT = "tests.examples.stopping:Stopping"
WALK, TURN = 1.0 / 62.0, np.deg2rad(6.0)  # of the benchmark's agent [m] and [rad] per frame (docs/benchmark.md 1)


@pytest.fixture(scope="module", autouse=True)
def example() -> Iterator[Any]:
    with loaded(EXAMPLE) as module:
        yield module
    assert "tracked" not in ROBOTS


@pytest.fixture(scope="module")
def env() -> Iterator[Any]:
    settings: dict[str, Any] = {"render_backend": "none", "control_mode": "pd_joint_pos", "physics": "realistic"}
    made = gym.make("HazardFlood-v1", robot_uids="tracked", affects_agent=True, obs_mode="state", **settings)
    yield made
    made.close()


def test_it_drives_at_its_own_speed(env: Any) -> None:
    env.reset(seed=0)
    agent = env.unwrapped.agent
    assert agent.uid == "tracked_fetch"
    at = [agent.base()]
    for _ in range(12):
        env.step(agent.action(0.0, 1.0, agent.tucked, True))
        at.append(agent.base())
    turned = np.diff(np.unwrap([heading for _, _, heading in at]))
    np.testing.assert_allclose(turned[-4:], TURN / 2, rtol=0.02)
    ahead = agent.action(WALK / 4, 0.0, agent.tucked, True)[-2:]
    np.testing.assert_allclose(ahead, [0.5, 0.0], atol=1e-6)  # half of its half speed


def test_water_feels_its_own_weight(env: Any) -> None:
    """Afloat where its box displaces its weight: 230 kg / (1000 kg/m3 x 0.7^2 m2) = 0.47 m; half that: half of it."""
    from hazard_ms.hazards.flood.wading import traction

    env.reset(seed=0)
    build = env.unwrapped.world.agent_build
    assert build.mass == 230.0 and build.friction == 0.9
    depth = env.unwrapped.world.position.new_tensor([0.0, 0.2347, 0.4694])
    np.testing.assert_allclose(traction(depth, build, 1000.0), [1.0, 0.5, 0.0], atol=1e-3)


def test_it_stands_in_scenes_of_maniskill_too() -> None:
    env = gym.make("Empty-v1", robot_uids="tracked_fetch", obs_mode="state", render_backend="none")
    env.reset(seed=0)
    env.step(env.action_space.sample())
    assert env.unwrapped.agent.build.mass == 230.0
    env.close()


@pytest.mark.render
def test_it_is_played_by_its_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["play", "--load", str(EXAMPLE), "-r", "tracked", "-a", SHORT, "--effects", "off"]) == 0
