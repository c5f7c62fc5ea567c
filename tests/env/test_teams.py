"""Several robots in one environment: places, actions, hands, collisions, states. What is allowed, and what is not."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

from hazard_ms.tasks.episode.grasp import PUT_AWAY_HEIGHT, distance_to_boxes
from tests.env.episode_hashes import feed

PAIR = ("fetch-0", "g1-1")
PLAIN: dict[str, Any] = dict(obs_mode="state_dict", render_backend="none", control_mode="pd_joint_pos")


@pytest.fixture(scope="module")
def env() -> Iterator[Any]:
    made = gym.make("HazardFire-v1", robot_uids=("fetch", "g1"), **PLAIN)
    yield made
    made.close()


def still(env: Any) -> dict[str, np.ndarray]:
    """Actions that keep all robots tucked where they are, hands open."""
    return {name: robot.action(0.0, 0.0, robot.tucked, True) for name, robot in env.unwrapped.robots.items()}


def lay(base: Any, thing: int, place: torch.Tensor) -> None:
    """Put the middle of `thing` at `place` [m], [3]."""
    world = base.world
    world.position[0, thing] = place
    world.place(torch.tensor([0]))
    world.read()


def targets(base: Any) -> list[int]:
    return torch.nonzero(base.world.target[0]).flatten().tolist()


def test_spaces_are_dicts_by_robot_as_maniskill_has_them(env: Any) -> None:
    obs, _ = env.reset(seed=1)
    assert list(env.action_space.spaces) == [*PAIR] == list(obs["agent"]) == list(obs["extra"])
    single = env.unwrapped.single_observation_space
    assert single.contains({k: _first(v) for k, v in obs.items()})
    assert np.isfinite(single["agent"]["g1-1"]["qpos"].low).all()  # bounds are those of its own joints
    place = obs["extra"]["g1-1"]["agent_pose"][0, :2].tolist()
    assert place == pytest.approx(env.unwrapped.robots["g1-1"].base()[:2])
    assert place != obs["extra"]["fetch-0"]["agent_pose"][0, :2].tolist()


def _first(value: Any) -> Any:
    return {k: _first(v) for k, v in value.items()} if isinstance(value, dict) else value[0].numpy()


@pytest.mark.parametrize("seed", range(4))
def test_robots_start_apart_and_where_they_fit(env: Any, seed: int) -> None:
    env.reset(seed=seed)
    base = env.unwrapped
    (ax, ay, _), (bx, by, _) = (robot.base() for robot in base.robots.values())
    assert (ax, ay) == pytest.approx(base.specs[0].agent_start.position)
    assert 0.29 + 0.26 + 0.3 - 1e-6 <= np.hypot(ax - bx, ay - by) < 2.0
    before = base.world.position.clone()
    env.step(still(env))
    assert (base.world.position - before).abs().max() < 0.01  # nothing was pushed out of the way


def test_each_hand_takes_its_own_and_both_rescues_count(env: Any) -> None:
    _, info = env.reset(seed=1)
    base = env.unwrapped
    first, second = targets(base)[:2]
    members = base.members
    for member, thing in zip(members, (first, second), strict=True):
        lay(base, thing, member.agent.gripper_pose()[0][0])
    actions = {m.name: m.agent.action(0.0, 0.0, m.agent.tucked, False) for m in members}
    env.step(actions)
    assert [int(m.hand.held[0]) for m in members] == [first, second]
    assert [torch.nonzero(m.world.held[0]).flatten().tolist() for m in members] == [[first], [second]]
    assert base.world.held[0].sum() == 2
    start = members[1].agent.base()
    for _ in range(30):
        env.step({m.name: m.agent.action(0.0, 0.1, m.agent.tucked, False) for m in members})
    assert abs(members[1].agent.base()[2] - start[2]) > 1.0  # each follows its own hand
    for member, thing in zip(members, (first, second), strict=True):
        assert float(distance_to_boxes(base.world, member.agent.gripper_pose()[0])[0, thing]) < 0.05
    actions["fetch-0"] = still(env)["fetch-0"]  # its tucked hand is over its bag
    _, _, _, _, info = env.step(actions)
    assert int(info["rescued"]) == 1 and bool(base.world.safe[0, first])
    env.step(actions)
    assert base.world.position[0, first, 2] < PUT_AWAY_HEIGHT / 2
    assert int(members[1].hand.held[0]) == second  # the other holds on
    assert [int(m.world.held.sum()) for m in members] == [0, 1]


def drive_at(base: Any, number: int, other: int, speed: float) -> dict[str, np.ndarray]:
    """Actions by which robot `number` faces robot `other`, then drives at it with `speed` [m per frame]."""
    mover, goal = base.members[number].agent, base.members[other].agent
    (x, y, heading), (gx, gy, _) = mover.base(), goal.base()
    off = np.arctan2(gy - y, gx - x) - heading
    off = float(np.arctan2(np.sin(off), np.cos(off)))
    actions = {m.name: m.agent.action(0.0, 0.0, m.agent.tucked, True) for m in base.members}
    actions[base.members[number].name] = mover.action(speed if abs(off) < 0.2 else 0.0, off, mover.tucked, True)
    return actions


@pytest.mark.parametrize(("speed", "collisions"), [(1.0 / 62.0, 1), (0.05 / 60.0, 0)])  # 1 m/s at 60 Hz; 0.05 m/s
@pytest.mark.parametrize("robots", [("fetch", "fetch"), ("g1", "g1")])
def test_robots_stop_each_other_and_fast_contacts_are_counted(
    robots: tuple[str, str], speed: float, collisions: int
) -> None:
    env: Any = gym.make("HazardFire-v1", robot_uids=robots, **PLAIN)
    env.reset(seed=1)
    base = env.unwrapped
    gap = base.members[0].agent.build.radius + base.members[1].agent.build.radius
    if collisions == 0:  # it comes near quickly, then slowly
        while _apart(base) > gap + 0.05:
            env.step(drive_at(base, 1, 0, 1.0 / 62.0))
    for _ in range(150):
        _, _, _, _, info = env.step(drive_at(base, 1, 0, speed))
    assert _apart(base) > 0.6 * gap  # they do not pass through each other
    assert _apart(base) < gap + 0.05
    assert int(info["robot_collisions"]) == collisions  # once, however long it pushes
    env.close()


def _apart(base: Any) -> float:
    (ax, ay, _), (bx, by, _) = (m.agent.base() for m in base.members)
    return float(np.hypot(ax - bx, ay - by))


def played(env: Any, frames: int) -> bytes:
    """Poses, records and rewards of `frames` with actions drawn from a fixed seed."""
    digest, draw, base = hashlib.sha256(), np.random.default_rng(5), env.unwrapped
    for _ in range(frames):
        actions = still(env)
        for name in actions:
            actions[name][-2:] = draw.uniform(-1.0, 1.0, 2)
        _, reward, _, _, _ = env.step(actions)
        for tensor in (base.world.position, base.world.rotation, reward):
            feed(digest, tensor)
        feed(digest, base.members.joints())
        for part in base.episode.parts.values():
            feed(digest, part.save())
    return digest.digest()


def test_the_same_seed_gives_the_same_bits(env: Any) -> None:
    env.reset(seed=3)
    first = played(env, 60)
    env.reset(seed=4)
    assert played(env, 60) != first
    env.reset(seed=3)
    assert played(env, 60) == first


def test_a_state_brings_back_both_hands_and_what_follows(env: Any) -> None:
    env.reset(seed=1)
    base = env.unwrapped
    things = targets(base)[:2]
    for member, thing in zip(base.members, things, strict=True):
        lay(base, thing, member.agent.gripper_pose()[0][0])
    env.step({m.name: m.agent.action(0.0, 0.0, m.agent.tucked, False) for m in base.members})
    state = base.get_state_dict()
    there = [m.agent.base() for m in base.members]
    env.reset(seed=1)
    assert base.world.held.sum() == 0 and [int(m.world.held.sum()) for m in base.members] == [0, 0]
    for _ in range(10):
        env.step(drive_at(base, 1, 0, 1.0 / 62.0))
    base.set_state_dict(state)
    assert [int(m.hand.held[0]) for m in base.members] == things
    assert [torch.nonzero(m.world.held[0]).flatten().tolist() for m in base.members] == [[t] for t in things]
    assert np.allclose([m.agent.base() for m in base.members], there, atol=1e-6)
    flat = base.get_state()
    base.set_state(flat)
    assert torch.equal(base.get_state(), flat)
    broken = base.get_state_dict()
    broken["hazard_ms"]["hand_1"]["held"][:] = base.world.num_bodies
    with pytest.raises(ValueError, match=r"state\.hazard_ms\.hand_1\.held must hold numbers from -1"):
        base.set_state_dict(broken)


def test_a_robot_of_a_team_is_put_where_asked(env: Any) -> None:
    env.reset(seed=1)
    base = env.unwrapped
    there = base.robots["g1-1"].base()
    x, y, _ = base.robots["fetch-0"].base()
    with pytest.raises(ValueError, match="too close to the robot fetch-0"):
        base.place_robot((x + 0.3, y), 0.0, robot=1)
    assert base.robots["g1-1"].base() == there
    base.place_robot((there[0], there[1]), 1.0, robot=1)
    assert base.robots["g1-1"].base() == pytest.approx((there[0], there[1], 1.0), abs=1e-6)


@pytest.mark.parametrize(
    ("action", "message"),
    [
        ({"fetch-0": np.zeros(13)}, "an action must be a dict with fetch-0, g1-1, got"),
        (np.zeros(13), "an action must be a dict with fetch-0, g1-1, got ndarray"),
        ({"fetch-0": np.zeros(3), "g1-1": np.zeros(17)}, r"action must have shape \(1, 13\) or \(13,\)"),
        ({"fetch-0": None, "g1-1": np.zeros(17)}, "the action of fetch-0 must be an array of numbers, got NoneType"),
    ],
)
def test_wrong_actions_are_refused(env: Any, action: Any, message: str) -> None:
    env.reset(seed=1)
    frame = int(env.unwrapped.world.frame[0])
    with pytest.raises(ValueError, match=message):
        env.step(action)
    assert int(env.unwrapped.world.frame[0]) == frame


@pytest.mark.parametrize(
    ("task", "given", "message"),
    [
        ("HazardFire-v1", {"robot_uids": ("fetch",) * 5}, "robot_uids must be at most 4 robots, got 5"),
        ("HazardFire-v1", {"robot_uids": ("fetch", "spot")}, "robot_uids must be one of fetch, g1, got 'spot'"),
        ("HazardFire-v1", {"num_envs": 2}, "num_envs must be 1 and sim_backend cpu for 2 robots"),
    ],
)
def test_what_a_team_cannot_do_is_refused_early(task: str, given: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        gym.make(task, **{**PLAIN, "robot_uids": ("fetch", "fetch"), **given})
