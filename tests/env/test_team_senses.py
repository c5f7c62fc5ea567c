"""Cameras, senses and perturbations of teams: each robot has its own, under its name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

from hazard_ms.env.control_noise import arm_noise, slip
from hazard_ms.skills.decision import EXPLORE, Action
from hazard_ms.skills.team import TeamSkills
from tests.env.test_teams import PLAIN, still

PAIR = ("fetch", "fetch")
SMALL = {"sensor_configs": {"width": 64, "height": 64}, "effects": "fast"}


@pytest.fixture(scope="module")
def sensed() -> Iterator[Any]:
    made = gym.make(
        "HazardFire-v1",
        robot_uids=PAIR,
        obs_mode="rgb+depth",
        cameras=("wrist", "shoulder"),
        senses=("thermal", "degraded"),
        control_mode="pd_joint_pos",
        **SMALL,
    )
    yield made
    made.close()


@pytest.mark.render
def test_each_robot_has_its_cameras_and_senses_under_its_name(sensed: Any) -> None:
    obs, _ = sensed.reset(seed=1)
    seen = obs["sensor_data"]
    names = [f"fetch-{k}-{camera}" for k in (0, 1) for camera in ("head", "wrist", "shoulder")]
    assert sorted(seen) == sorted(names)
    for name in names:
        head = name.endswith("head")
        assert ("thermal" in seen[name]) == ("hazard" in seen[name]) == head
        assert seen[name]["rgb"].shape == (1, 64, 64, 3)
    single = sensed.unwrapped.single_observation_space
    assert {"thermal", "rgb", "depth", "hazard"} <= set(single["sensor_data"]["fetch-1-head"].spaces)
    for camera in ("head", "wrist", "shoulder"):
        one, two = (seen[f"fetch-{k}-{camera}"]["rgb"] for k in (0, 1))
        assert not torch.equal(one, two)


@pytest.mark.render
def test_cameras_are_carried_by_their_own_robot(sensed: Any) -> None:
    obs, _ = sensed.reset(seed=1)
    base = sensed.unwrapped
    turning = still(sensed)
    agent = base.members[1].agent
    turning["fetch-1"] = agent.action(0.0, agent.build.turn_step, agent.tucked, True)
    before = {name: params["cam2world_gl"].clone() for name, params in obs["sensor_param"].items()}
    for _ in range(5):
        obs, *_ = sensed.step(turning)
    for name, params in obs["sensor_param"].items():
        moved = float((params["cam2world_gl"] - before[name]).abs().max())
        assert (moved > 0.2) == name.startswith("fetch-1"), name


def test_a_camera_that_one_robot_of_a_team_lacks_is_refused() -> None:
    with pytest.raises(ValueError, match="cameras of fetch must be one of wrist, shoulder, got 'wrist_left'"):
        gym.make("HazardFire-v1", robot_uids=("g1", "fetch"), cameras=("wrist_left",), **PLAIN)


class Clock:
    """Seeds and a frame, as the chance of a world has them."""

    def __init__(self) -> None:
        from hazard_ms.simulation.chance import Chance

        self.chance = Chance(200)
        self.chance.seed[:] = torch.arange(200)


def test_the_first_robot_has_the_noise_of_one_and_the_second_one_of_its_own() -> None:
    chance = Clock().chance
    alone, first, second = arm_noise(chance, 7, 2), arm_noise(chance, 7, 2, 0), arm_noise(chance, 7, 2, 1)
    assert torch.equal(alone, first)
    both = np.corrcoef(first.flatten().numpy(), second.flatten().numpy())[0, 1]
    assert abs(both) < 0.1
    chance.frame[:] = 12
    slips = [slip(chance, 2, robot)[0] for robot in (0, 1)]
    assert slips[0].any() and slips[1].any() and not torch.equal(*slips)


def turned(perturb: str) -> list[float]:
    """How far each robot has turned that drives straight ahead for 240 frames, as far as it can [rad]."""
    env: Any = gym.make("HazardWind-v1", robot_uids=PAIR, perturb=perturb, **PLAIN)
    env.reset(seed=2)
    base = env.unwrapped
    start = [m.agent.base()[2] for m in base.members]
    for frame in range(240):
        way = 0.2 if frame % 2 else -0.2  # there and back, so that nothing is in the way
        env.step({m.name: m.agent.action(way / 62.0, 0.0, m.agent.tucked, True) for m in base.members})
    made = [m.agent.base()[2] - then for m, then in zip(base.members, start, strict=True)]
    env.close()
    return made


def test_under_noise_of_control_each_robot_goes_astray_by_itself() -> None:
    assert max(map(abs, turned(""))) < 0.01
    one, two = turned("control:3")
    assert abs(one) > 0.05 and abs(two) > 0.05 and abs(one - two) > 0.05


@pytest.mark.render
def test_perturbed_scenes_starts_and_pictures_are_those_of_the_seed() -> None:
    perturb = "lighting:2,camera:2,objects:2,words:2,start:2,noise:2"
    env: Any = TeamSkills.make("HazardFire-v1", PAIR, perturb=perturb, obs_mode="rgb", **SMALL)
    base = env.base
    plain: Any = gym.make("HazardFire-v1", robot_uids=PAIR, **PLAIN)
    seen = []
    for seed in (1, 2, 1):
        decisions, _ = env.reset(seed=seed)
        pictures = [observer.look()[0].clone() for observer in base.observers]
        seen.append((*pictures, torch.tensor([robot.base() for robot in base.robots.values()])))
        plain.reset(seed=seed)
        ours, usual = (list(e.robots.values()) for e in (base, plain.unwrapped))
        assert ours[0].base()[:2] == pytest.approx(base.specs[0].agent_start.position)
        assert np.hypot(*np.subtract(ours[0].base()[:2], usual[0].base()[:2])) > 0.1
        assert np.hypot(*np.subtract(ours[0].base()[:2], ours[1].base()[:2])) < 2.0
        assert base.task.text != env.brief("fetch-0").text == env.brief("fetch-1").text
    assert all(torch.equal(a, b) for a, b in zip(seen[0], seen[2], strict=True))
    assert not any(torch.equal(a, b) for a, b in zip(seen[0], seen[1], strict=True))
    env.step({name: Action(EXPLORE) for name in decisions})
    env.close()
    plain.close()
