"""The practice tasks: rewards worked out by hand, starts that are possible, and what is observed."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch
from gymnasium.utils.env_checker import check_env

import hazard_ms
from hazard_ms.simulation.clearance import obstacle
from tests.worlds.practice_rooms import HERE, made, reward, stand
from tests.worlds.registering import practising

TASKS = ("HazardWalkTo-v1", "HazardPickUp-v1", "HazardStow-v1", "HazardFetch-v1")
WALKING = ("HazardWalkTo-v1", "HazardFetch-v1")


@pytest.fixture(scope="module", autouse=True)
def practice() -> Iterator[Any]:
    with practising() as module:
        yield module


@pytest.fixture(scope="module", params=TASKS)
def each(request: pytest.FixtureRequest) -> Iterator[Any]:
    yield from made(request.param)


@pytest.fixture(scope="module")
def walk() -> Iterator[Any]:
    yield from made("HazardWalkTo-v1")


@pytest.fixture(scope="module")
def reach() -> Iterator[Any]:
    yield from made("HazardPickUp-v1")


# distance [m] and direction [rad] of the thing from the robot, which drives ahead at a speed [m/s]; the hint, from
# -1 to 1, in shares of 0.5 m/s; whether it has arrived
WALKS = (
    (2.0, 0.0, 0.25, 0.5, False),  # straight at it
    (5.0, 0.0, 0.25, 0.5, False),  # from wherever
    (2.0, math.pi / 3, 0.25, 0.25, False),  # half of the speed brings it nearer
    (2.0, math.pi / 2, 0.25, 0.0, False),  # past it
    (2.0, math.pi, 0.25, -0.5, False),  # away from it
    (2.0, math.pi, -0.25, 0.5, False),  # backwards
    (2.0, 0.0, 0.0, 0.0, False),
    (2.0, 0.0, 3.0, 1.0, False),  # no more for a robot that is thrown
    (0.80, 0.0, 0.0, 0.0, True),
    (0.80, 0.29, 0.0, 0.0, True),  # within its bearing, and just not
    (0.80, 0.31, 0.0, 0.0, False),
    (0.80, -0.31, 0.0, 0.0, False),
    (0.84, 0.0, 0.1, 0.2, True),  # within its distance, and just not
    (0.86, 0.0, 0.1, 0.2, False),
)


@pytest.mark.parametrize(("distance", "direction", "speed", "hint", "arrived"), WALKS)
def test_a_walk_pays_as_worked_out_by_hand(
    walk: Any, distance: float, direction: float, speed: float, hint: float, arrived: bool
) -> None:
    base = walk.unwrapped
    walk.reset(seed=0)
    stand(base, *HERE, heading=0.7)
    moving = torch.zeros_like(base.agent.robot.get_qvel())
    moving[:, :2] = speed * torch.tensor([math.cos(0.7), math.sin(0.7)])
    base.agent.robot.set_qvel(moving)
    at = np.array(HERE) + distance * np.array([math.cos(0.7 + direction), math.sin(0.7 + direction)])
    base.world.position[0, base.world.target[0], :2] = torch.from_numpy(at).float()
    assert reward(base) == pytest.approx(hint / 450 + arrived, abs=1e-5)
    info = base.get_info()
    assert bool(info["success"]) == arrived and float(info["distance"]) == pytest.approx(distance, abs=1e-5)
    assert float(base.compute_sparse_reward(None, None, info)) == float(arrived)


# [m] from the hand to the box of the thing; the hint: half at 0.25 m from where the hand could take it, which is 0.15 m
GAPS = ((0.0, 1.0), (0.15, 1.0), (0.4, 0.5), (0.65, 1 / 3), (0.9, 0.25))


@pytest.mark.parametrize(("gap", "hint"), GAPS)
def test_a_reach_pays_as_worked_out_by_hand(reach: Any, gap: float, hint: float) -> None:
    base = reach.unwrapped
    reach.reset(seed=0)
    hand, world = base.agent.gripper_pose()[0][0], base.world
    thing = world.target[0].nonzero()[0, 0]
    world.position[0, world.target[0]] += 50.0  # the others, out of the way
    world.position[0, thing] = hand + torch.tensor([0.0, 0.0, gap]) + world.extent[0, thing] * torch.tensor([0, 0, 0.5])
    assert reward(base) == pytest.approx(hint / 120, abs=1e-5)
    world.held[0, thing] = True
    assert reward(base) == pytest.approx(1.0 + hint / 120, abs=1e-5) and bool(base.get_info()["success"])


def test_nobody_gains_by_waiting(each: Any) -> None:
    """All hints of an episode of the usual length are worth less than success, which ends the episode."""
    base = each.unwrapped
    assert (base.task.goal.largest - 1.0) * each.spec.max_episode_steps <= 1.0 + 1e-9


def test_the_hand_takes_what_it_shuts_beside(reach: Any) -> None:
    reach.reset(seed=0)
    base = reach.unwrapped
    shut = torch.zeros(1, 13)
    shut[:, 7] = -1.0
    _, _, terminated, *_ = reach.step(shut)
    assert not terminated.any()  # nothing is near
    reach.step(-shut)
    base.episode.begin(torch.tensor([0]), torch.tensor([0]))
    thing = base.world.target[0].nonzero()[0, 0]
    base.world.position[0, thing] = base.agent.gripper_pose()[0][0]
    base.world.place(torch.tensor([0]))
    _, gained, terminated, _, info = reach.step(shut)
    assert terminated.all() and info["success"].all() and 1.0 < float(gained) <= base.task.goal.largest


def test_robots_start_clear_of_everything_where_the_task_says(each: Any) -> None:
    base, starts = each.unwrapped, set()
    for seed in range(10):
        obs, _ = each.reset(seed=seed)
        x, y, heading = base.agent.base()
        assert obstacle(base.world, 0, (x, y), base.agent.build.radius) == ""
        ahead, left, _ = obs["extra"]["thing"][0].tolist()
        starts.add((round(x, 3), round(y, 3), round(heading, 3)))
        if each.spec.id in WALKING:
            assert math.hypot(ahead, left) > 2.0
        else:
            assert 0.59 < math.hypot(ahead, left) < 0.86 and abs(math.atan2(left, ahead)) < 0.301
        assert not base.get_info()["success"].any()
    assert len(starts) == 10


def test_starts_in_one_room_follow_from_the_seed(each: Any) -> None:
    room, starts = {"scene": "practice/7"}, []
    for seed in (3, 4, 5, 3):
        each.reset(seed=seed, options=room)
        starts.append(each.unwrapped.agent.base())
    assert starts[0] == starts[3] and len(set(starts)) == 3


def test_what_is_observed_does_not_depend_on_where_in_the_room_everything_is(each: Any) -> None:
    """But for the first joints, which are the place of the base."""
    base, seen = each.unwrapped, []
    for x, y, heading in ((3.0, 2.5, 0.2), (4.0, 3.5, 1.9)):
        each.reset(seed=3)
        world = base.world
        stand(base, x, y, heading)
        c, s = math.cos(heading), math.sin(heading)
        for i in range(world.num_bodies):
            ahead, left = 0.4 + 0.1 * i, 0.3 - 0.2 * i
            world.position[0, i, :2] = torch.tensor([x + c * ahead - s * left, y + s * ahead + c * left])
        world.extent[..., :2] = 0.0  # boxes would turn against the frame
        seen.append({key: value.clone() for key, value in base._get_obs_extra({}).items()})
        each.reset(seed=3, options={"reconfigure": True})
    for key in seen[0]:
        torch.testing.assert_close(seen[0][key], seen[1][key], atol=1e-4, rtol=0.0)
    torch.testing.assert_close(seen[0]["thing"][0, :2], torch.tensor([0.4, 0.3]), atol=1e-4, rtol=0.0)


def test_fingers_point_where_the_kinematics_say(reach: Any) -> None:
    obs, _ = reach.reset(seed=4)
    agent = reach.unwrapped.agent
    _, turned, _ = agent.kinematics(agent.arm())
    heading = agent.base()[2]
    c, s = math.cos(heading), math.sin(heading)
    wanted = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ turned[:, 0]
    np.testing.assert_allclose(obs["extra"]["fingers"][0].numpy(), wanted, atol=1e-3)


def test_rooms_of_the_splits_differ_and_have_what_they_need(practice: Any) -> None:
    assert not set(practice.names("train")) & set(practice.names("test"))
    for name in (*practice.names("train")[:10], *practice.names("test")[:10]):
        for walking, targets in ((True, 1), (False, 6)):
            spec = practice.scene(name, walking)
            assert len(spec.targets) == targets and spec == practice.scene(name, walking)
    with pytest.raises(ValueError, match=r"^scene must be one of"):
        practice.scene("kitchen_a/00", True)


@pytest.mark.long
@pytest.mark.parametrize("task", (*TASKS, "HazardOpenDoor-v1"))
def test_checkers_find_nothing(task: str) -> None:
    from stable_baselines3.common.env_checker import check_env as check_for_learners

    env = hazard_ms.NumpyEnv(gym.make(task, obs_mode="state", render_backend="none", max_episode_steps=5))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # unbounded observations
        check_env(env)
        check_for_learners(env)
    env.close()
