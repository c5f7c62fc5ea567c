"""Cameras of a robot beside that of its head: they are there if asked for, and move with what carries them."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch
from scipy.spatial.transform import Rotation

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.spec.registry.robots import robot_class, skill_control_mode

pytestmark = pytest.mark.render
SIDE = 32


def made(robot: str, *cameras: str, **more: Any) -> gym.Env:
    size = {"width": SIDE, "height": SIDE}
    return gym.make("HazardFire-v1", robot_uids=robot, cameras=cameras, obs_mode="rgb", sensor_configs=size, **more)


def matrix(position: Any, rotation: Any) -> np.ndarray:
    """The matrix, [4, 4], of a place [m] and a rotation (w, x, y, z)."""
    found = np.eye(4)
    found[:3, :3] = Rotation.from_quat(np.roll(np.asarray(rotation, float), -1)).as_matrix()
    found[:3, 3] = position
    return found


@pytest.mark.parametrize("robot", ["fetch", "g1"])
def test_cameras_hang_where_the_robot_says_and_move_with_its_links(robot: str) -> None:
    mounts = robot_class(robot).mounted_cameras
    env = made(robot, *mounts, control_mode=skill_control_mode(robot))
    seen, _ = env.reset(seed=2)
    assert set(seen["sensor_data"]) == {"head", *mounts}
    agent = env.unwrapped.agent
    before = {}
    for frame in range(8):
        for name, mount in mounts.items():
            assert seen["sensor_data"][name]["rgb"].shape == (1, SIDE, SIDE, 3)
            pose = agent.robot.links_map[mount.link].pose
            want = matrix(pose.p[0], pose.q[0]) @ matrix(mount.position, mount.rotation)
            got = seen["sensor_param"][name]["cam2world_gl"][0].numpy()
            # of OpenGL's frame, that looks along -z with y up, to one that looks along x with z up
            np.testing.assert_allclose(got[:3, 3], want[:3, 3], atol=1e-5)
            np.testing.assert_allclose(got[:3, :3], want[:3, :3] @ [[0, 0, -1], [-1, 0, 0], [0, 1, 0]], atol=1e-5)
            focal = float(seen["sensor_param"][name]["intrinsic_cv"][0, 1, 1])
            assert focal == pytest.approx(SIDE / 2 / np.tan(mount.fov / 2), rel=1e-5)
            if frame == 0:
                before[name] = got
            elif frame == 7:
                assert np.abs(got - before[name]).max() > 0.05, name
        action = agent.action(0.0, 0.05, agent.arm(), True)
        seen, *_ = env.step(action)
    env.close()


def test_without_being_asked_for_there_is_the_head_alone() -> None:
    env = made("fetch")
    seen, _ = env.reset(seed=2)
    assert list(seen["sensor_data"]) == ["head"]
    env.close()


def test_a_picture_of_a_look_is_that_of_an_observation() -> None:
    env = made("fetch", "wrist")
    seen, _ = env.reset(seed=2)
    observer = env.unwrapped.observer
    observer.look()
    assert torch.equal(observer.picture("wrist"), seen["sensor_data"]["wrist"]["rgb"][0])
    env.close()


@pytest.mark.parametrize(
    ("cameras", "message"),
    [
        ("wrist", "cameras must be a list of some of wrist, shoulder, got 'wrist'"),
        (("elbow",), "cameras must be one of wrist, shoulder, got 'elbow'"),
        (("wrist_left",), "cameras must be one of wrist, shoulder"),
        (("head",), "cameras must be one of wrist, shoulder"),
        (7, "cameras must be a list"),
    ],
)
def test_unknown_cameras_are_refused(cameras: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        gym.make("HazardFire-v1", cameras=cameras, render_backend="none")
