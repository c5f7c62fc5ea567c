"""One environment that a CPU simulates and a GPU draws, as `gym.make` chooses on a machine with a GPU."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments

pytestmark = [pytest.mark.gpu, pytest.mark.render]

SIDE, FRAMES = 64, 20
MODES = ("rgb+depth+segmentation", "rgb+depth+segmentation+position+normal+albedo", "pointcloud", "sensor_data")


def leaves(obs: Any) -> list[Any]:
    """All values of a nested observation."""
    return [leaf for value in obs.values() for leaf in leaves(value)] if isinstance(obs, dict) else [obs]


def made(env_id: str, obs_mode: str, render_backend: str, **more: Any) -> gym.Env:
    size = {} if render_backend == "none" else {"sensor_configs": {"width": SIDE, "height": SIDE}}
    return gym.make(
        env_id, obs_mode=obs_mode, sim_backend="cpu", render_backend=render_backend, render_mode=None, **size, **more
    )


@pytest.mark.parametrize("obs_mode", MODES)
def test_an_observation_is_on_one_device(obs_mode: str) -> None:
    env = made("HazardFire-v1", obs_mode, "gpu")
    try:
        first, _ = env.reset(seed=0)
        second = env.step(env.action_space.sample() * 0)[0]
        for obs in (first, second):
            assert {str(torch.as_tensor(leaf).device) for leaf in leaves(obs)} == {"cpu"}
    finally:
        env.close()


@pytest.mark.parametrize("env_id", ["HazardFire-v1", "HazardFlood-v1", "HazardWind-v1"])
def test_what_draws_changes_nothing_of_the_episode(env_id: str) -> None:
    ends = []
    for obs_mode, backend in (("rgb+depth", "gpu"), ("state", "none")):
        env = made(env_id, obs_mode, backend)
        base: Any = env.unwrapped
        env.reset(seed=3)
        env.action_space.seed(0)
        for _ in range(FRAMES):
            env.step(env.action_space.sample())
        ends.append([base.world.position.clone(), base.agent.robot.get_qpos().clone(), base.world.rotation.clone()])
        env.close()
    assert all(torch.equal(a, b) for a, b in zip(*ends, strict=True))


def test_a_glance_has_the_labels_of_a_look() -> None:
    env = made("HazardFire-v1", "rgb+depth+segmentation", "gpu")
    base: Any = env.unwrapped
    env.reset(seed=0)
    picture, look = base.observer.look()
    glance = base.observer.glance()
    env.close()
    assert picture.float().std() > 5.0
    assert look.labels is not None and glance.labels is not None and (look.labels > 0).any()
    np.testing.assert_array_equal(look.labels, glance.labels)
    np.testing.assert_array_equal(look.depth, glance.depth)


def test_a_ray_traced_picture_shows_the_room() -> None:
    env = gym.make(
        "HazardFire-v1", obs_mode="rgb+segmentation", render_backend="gpu", sensor_configs={"shader_pack": "rt-fast"}
    )
    obs, _ = env.reset(seed=0)
    seen = next(iter(obs["sensor_data"].values()))
    env.close()
    assert seen["rgb"].float().std() > 5.0 and str(seen["rgb"].device) == "cpu"


def test_a_film_of_a_gpu_is_not_black() -> None:
    env = gym.make("HazardFire-v1", obs_mode="state", render_backend="gpu", render_mode="rgb_array")
    env.reset(seed=0)
    picture = torch.as_tensor(env.render()).float()
    env.close()
    assert picture.std() > 5.0
