"""Noise in control: as strong as its level says, smooth in arms, of the seed, and not in what was sent."""

from __future__ import annotations

import math
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.env.control_noise import APART, KNOT, MOST, SHARE, SLIP, TURNED, arm_noise, slip
from hazard_ms.simulation.chance import Chance

FRAMES = 1500


def drawn(level: int, seeds: tuple[int, ...], frames: int = FRAMES, joints: int = 3) -> np.ndarray:
    """The noise of each frame, [frames, E, joints]."""
    chance = Chance(len(seeds))
    chance.restart(torch.arange(len(seeds)), torch.tensor(seeds))
    made = []
    for _ in range(frames):
        made.append(arm_noise(chance, joints, level).numpy())
        chance.tick()
    return np.stack(made)


@pytest.mark.parametrize("level", [1, 2, 3])
def test_an_episode_has_three_quarters_of_a_level_or_more_in_every_frame(level: int) -> None:
    noise = drawn(level, tuple(range(6)))
    for part in (noise[::KNOT], noise[2::KNOT]):  # at draws, and between two of them
        spread = part.std(axis=(0, 2))
        assert (spread > 0.75 * MOST[level] * 0.9).all() and (spread < MOST[level] * 1.1).all()
    assert np.ptp(noise.std(axis=(0, 2))) > 0.05 * MOST[level]  # not as much in each episode
    assert abs(noise.mean()) < 0.05 * MOST[level]


def test_it_is_smooth_and_forgets_within_two_draws() -> None:
    noise = drawn(3, (5,))[:, 0]
    steps, apart = np.diff(noise, axis=0).std(), noise.std()
    assert steps < 2.0 * apart / KNOT  # of one draw to the next it would be sqrt(2) of them all
    later = np.corrcoef(noise[: -2 * KNOT].ravel(), noise[2 * KNOT :].ravel())[0, 1]
    assert abs(later) < 4.0 / math.sqrt(3 * FRAMES / KNOT)
    joints = np.corrcoef(noise.T) - np.eye(3)
    assert np.abs(joints).max() < 5.0 / math.sqrt(FRAMES / KNOT)


def test_it_follows_from_seed_and_frame_whatever_is_beside() -> None:
    alone, many = drawn(2, (7,), 30), drawn(2, (3, 7), 30)
    np.testing.assert_array_equal(alone[:, 0], many[:, 1])
    assert (many[:, 0] != many[:, 1]).all()


@pytest.mark.parametrize("robot", ["fetch", "g1"])
def test_arms_go_beside_where_they_are_sent_and_come_back(robot: str) -> None:
    """Noise of a frame is not added to that of the last one, and the same seed gives the same bits."""
    seen = []
    for perturb in ("", "control:2", "control:2"):
        env: Any = gym.make(
            "HazardFire-v1",
            obs_mode="none",
            render_backend="none",
            robot_uids=robot,
            control_mode="pd_joint_pos",
            perturb=perturb,
        )
        env.reset(seed=1)
        agent, off = env.unwrapped.agent, []
        still = agent.action(0.0, 0.0, agent.tucked, True)
        sent = [agent.robot.active_joints[number].drive_target.item() for number in agent.arm_joints]
        for _ in range(80):
            env.step(still)
            now = [agent.robot.active_joints[number].drive_target.item() for number in agent.arm_joints]
            off.append(np.array(now) - sent)
        joints = env.unwrapped.agent.robot.get_qpos()[0].numpy().copy()
        seen.append((np.array(off), joints))
        env.close()
    (none, calm), (one, moved), (again, same) = seen
    assert np.abs(none).max() == 0.0
    assert 0.5 * MOST[2] < one.std() < 1.5 * MOST[2] and np.abs(one.mean(0)).max() < MOST[2]
    assert np.abs(moved - calm)[3:].max() > 0.01  # [rad]
    np.testing.assert_array_equal(one, again)
    np.testing.assert_array_equal(moved, same)


def slips(level: int, seeds: tuple[int, ...], frames: int = FRAMES) -> tuple[np.ndarray, np.ndarray]:
    """Whether bases slip, and by how much they then turn [rad], [frames, E] each."""
    chance = Chance(len(seeds))
    chance.restart(torch.arange(len(seeds)), torch.tensor(seeds))
    made = []
    for _ in range(frames):
        made.append([part.numpy() for part in slip(chance, level)])
        chance.tick()
    return np.stack([one for one, _ in made]), np.stack([angle for _, angle in made])


@pytest.mark.parametrize("level", [1, 2, 3])
def test_half_of_all_stretches_have_one_slip_of_a_level_to_either_side(level: int) -> None:
    slipping, angle = slips(level, tuple(range(8)))
    stretches = slipping.reshape(-1, APART, 8).sum(1)
    assert set(np.unique(stretches)) == {0, SLIP}
    many = stretches.size
    assert abs((stretches > 0).mean() - SHARE) < 3.0 * math.sqrt(0.25 / many)
    turned = np.abs((angle * slipping).reshape(-1, APART, 8).sum(1))[stretches > 0]
    assert (turned > 0.75 * TURNED[level] - 1e-6).all() and (turned < TURNED[level] + 1e-6).all()
    begins = slipping.reshape(-1, APART, 8).argmax(1)[stretches > 0]
    assert begins.min() == 0 and begins.max() == APART - SLIP  # anywhere in its stretch
    assert abs((angle[slipping] > 0).mean() - 0.5) < 0.15
    np.testing.assert_array_equal(slips(level, (5,), 90)[1][:, 0], angle[:90, 5])  # whatever is beside


@pytest.mark.parametrize("robot", ["fetch", "g1"])
def test_a_base_turns_aside_where_it_slips_and_only_if_it_drives(robot: str) -> None:
    env: Any = gym.make(
        "HazardFire-v1",
        obs_mode="none",
        render_backend="none",
        robot_uids=robot,
        control_mode="pd_joint_pos",
        perturb="control:2",
    )
    slipping, angle = slips(2, (1,), 2 * APART)
    assert slipping.any()
    for forward, turn in ((0.0, 0.0), (0.004, 0.0), (0.0, 0.02)):
        env.reset(seed=1)
        agent = env.unwrapped.agent
        action, fps = agent.action(forward, turn, agent.tucked, True), env.unwrapped.control_freq
        heading, sent = [], []
        for _ in range(2 * APART):
            before = agent.base_pose()[1].item()
            env.step(action)
            heading.append(agent.base_pose()[1].item() - before)
            sent.append(agent.robot.active_joints[2].drive_velocity_target.item() / fps)
        driven = forward != 0.0 or turn != 0.0
        np.testing.assert_allclose(sent, np.where(slipping[:, 0] & driven, angle[:, 0], turn), atol=2e-4)
        np.testing.assert_allclose(heading, sent, atol=0.3 * TURNED[2] / SLIP)  # it takes a frame to turn faster
    env.close()
