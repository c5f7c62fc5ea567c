"""Practice that ends in the bag, and practice among hazards: rewards worked out by hand, and what is harmed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

from tests.worlds.practice_rooms import HERE, alone, made, reward, stand
from tests.worlds.registering import practising

TASKS = ("HazardWalkTo-v1", "HazardPickUp-v1", "HazardStow-v1", "HazardFetch-v1")


@pytest.fixture(scope="module", autouse=True)
def practice() -> Iterator[Any]:
    with practising() as module:
        yield module


@pytest.fixture(scope="module")
def reach() -> Iterator[Any]:
    yield from made("HazardPickUp-v1")


@pytest.fixture(scope="module")
def stow() -> Iterator[Any]:
    yield from made("HazardStow-v1")


@pytest.fixture(scope="module")
def fetch() -> Iterator[Any]:
    yield from made("HazardFetch-v1")


# [m] from the hand to the thing that is not held, and the hint: half of that of a pick-up
@pytest.mark.parametrize(("gap", "hint"), [(0.15, 0.5), (0.4, 0.25), (0.9, 0.125)])
def test_a_stow_pays_half_for_the_reach(stow: Any, gap: float, hint: float) -> None:
    base = stow.unwrapped
    stow.reset(seed=0)
    alone(base, gap)
    assert reward(base) == pytest.approx(hint / 240, abs=1e-5)


# [m] from the hand that holds the thing to the bag, and the hint: what is over the bag is within 0.45 m
@pytest.mark.parametrize(("away", "hint"), [(0.1, 1.0), (0.45, 1.0), (0.70, 0.75), (1.20, 0.625)])
def test_a_stow_pays_the_other_half_for_the_way_to_the_bag(
    stow: Any, monkeypatch: pytest.MonkeyPatch, away: float, hint: float
) -> None:
    base = stow.unwrapped
    stow.reset(seed=0)
    base.world.held[0, alone(base, 0.0)] = True
    hand = base.agent.gripper_pose()[0]
    monkeypatch.setattr(base.agent, "bag_position", lambda: hand + torch.tensor([[away, 0.0, 0.0]]))
    assert reward(base) == pytest.approx(hint / 240, abs=1e-5)


def test_a_fetch_pays_for_the_walk_then_for_the_reach_then_for_success(fetch: Any) -> None:
    base = fetch.unwrapped
    fetch.reset(seed=0)
    world, ahead = base.world, torch.tensor([math.cos(0.7), math.sin(0.7)])
    stand(base, *HERE, heading=0.7)
    moving = torch.zeros_like(base.agent.robot.get_qvel())
    moving[:, :2] = 0.25 * ahead
    base.agent.robot.set_qvel(moving)
    thing = world.target[0].nonzero()[0, 0]
    world.position[0, thing, :2] = torch.tensor(HERE) + 2.0 * ahead
    assert reward(base) == pytest.approx(0.25 * 0.5 / 750, abs=1e-5)  # at half of the full speed
    hand = base.agent.gripper_pose()[0][0]
    world.position[0, thing] = hand + torch.tensor([0.0, 0.0, 0.4]) + world.extent[0, thing] * torch.tensor([0, 0, 0.5])
    assert math.hypot(*(world.position[0, thing, :2] - torch.tensor(HERE)).tolist()) < 0.85
    assert reward(base) == pytest.approx((0.25 + 0.75 * 0.25) / 750, abs=1e-5)
    world.safe[0, thing] = True
    assert reward(base) > 1.0 and bool(base.get_info()["success"]) and not base.get_info()["fail"].any()


def test_what_is_harmed_counts_no_more(reach: Any, stow: Any) -> None:
    for env in (reach, stow):
        base = env.unwrapped
        env.reset(seed=0)
        thing, others = alone(base, 0.0), base.world.target[0].nonzero()[1:, 0]
        base.world.held[0, thing] = True
        base.world.safe[0, thing] = env is stow
        assert bool(base.get_info()["success"])
        base.episode.damage.damaged[0, thing] = True
        info = base.get_info()
        assert not info["success"] and not info["fail"] and float(info["gap"]) > 40.0  # the next target is far away
        base.episode.damage.damaged[0, others] = True
        assert bool(base.get_info()["fail"])


@pytest.mark.parametrize("task", TASKS)
def test_hazards_act_in_the_rooms_where_they_are_asked_for(task: str) -> None:
    calm = gym.make(task, obs_mode="none", render_backend="none", deterministic=False)
    env = gym.make(task, obs_mode="none", render_backend="none", hazards=["fire", "flood"], deterministic=False)
    for each_env in (calm, env):
        each_env.reset(seed=3)
    assert calm.unwrapped.specs == env.unwrapped.specs and calm.unwrapped.agent.base() == env.unwrapped.agent.base()
    assert [hazard.name for hazard in env.unwrapped.task.hazards] == ["flood", "fire"]
    (spec,) = env.unwrapped.specs
    middles = np.array([thing.position[:2] for thing in spec.targets])
    assert len(spec.fires) == 2
    for place in spec.fires:
        assert 0.19 < place[0] < 6.81 and 0.19 < place[1] < 5.81
        assert np.linalg.norm(middles - place, axis=1).min() < 0.91
    for _ in range(60):
        env.unwrapped.advance(None)
    assert env.unwrapped.episode.flames().lit.any()
    calm.close()
    env.close()


def test_hazards_are_graded_where_physics_is_realistic(practice: Any) -> None:
    made = [practice.fetch("realistic", ["fire"], name).hazards[0] for name in ("moderate", "severe", "extreme")]
    assert len(set(made)) == 3
    with pytest.raises(ValueError, match="severity must be 'severe' without hazards, got 'moderate'"):
        practice.fetch("realistic", (), "moderate")
    with pytest.raises(ValueError, match="hazards for practice must be ones that act indoors, got wind"):
        practice.pick_up("paper", ["wind"])
    with pytest.raises(ValueError, match="hazards must be some of"):
        practice.pick_up("paper", ["storm"])
