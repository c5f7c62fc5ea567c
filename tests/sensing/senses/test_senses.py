"""The extra senses of an environment: which keys there are, what they leave alone, and what they show of hazards."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

import hazard_ms  # noqa: F401 registers
from hazard_ms.hazards.fire.fire_state import BURNING
from hazard_ms.sensing.modes import check_senses

MODE = "rgb+depth+segmentation"


def played(
    task: str, physics: str, senses: tuple[str, ...], frames: int = 60, seed: int = 3
) -> tuple[Any, dict[str, Any]]:
    """An environment after some frames in which nobody acts, and what its head camera gives."""
    env: Any = gym.make(task, physics=physics, obs_mode=MODE, senses=senses).unwrapped
    env.reset(seed=seed)
    for _ in range(frames):
        env.advance(torch.zeros(env.action_space.shape))
    return env, env.get_obs(env.get_info())["sensor_data"][env.agent.head_camera]


@pytest.mark.parametrize(
    ("senses", "mode", "words"),
    [
        ("thermal", "rgb", "senses must be a list"),
        (("infrared",), "rgb", "senses"),
        (("thermal",), "state", "obs_mode must be one with pictures"),
        (("thermal",), None, "obs_mode must be one with pictures"),
        (("degraded",), "rgb+position", "obs_mode must have only colour and depth"),
        (("degraded",), "pointcloud", "obs_mode must have only colour and depth"),
    ],
)
def test_senses_that_cannot_be_are_refused(senses: Any, mode: str | None, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        check_senses(senses, mode)


def test_each_sense_is_kept_once() -> None:
    assert check_senses(["degraded", "thermal", "degraded"], "rgb") == ("degraded", "thermal")


@pytest.mark.render
def test_a_thermal_image_is_beside_pictures_that_stay_as_they_are() -> None:
    plain_env, plain = played("HazardFire-v1", "paper", ())
    plain_env.close()
    env, seen = played("HazardFire-v1", "paper", ("thermal",))
    assert set(seen) == {*plain, "thermal"} and "thermal" not in plain
    assert all(torch.equal(seen[key], plain[key]) for key in plain)
    image = seen["thermal"]
    assert image.shape == (1, 256, 256, 1) and image.dtype == torch.float32
    space = env.single_observation_space["sensor_data"][env.agent.head_camera]["thermal"]
    assert space.shape == (256, 256, 1) and float(space.low.min()) == -20.0 and float(space.high.max()) == 650.0
    env.close()
    again_env, again = played("HazardFire-v1", "paper", ("thermal",))
    assert torch.equal(again["thermal"], image)
    again_env.close()


@pytest.mark.render
def test_things_look_as_warm_as_they_are() -> None:
    """In `paper`: median of the pixels of each thing in view, but for their 5 % of the room's light."""
    env, seen = played("HazardFire-v1", "paper", ("thermal",), frames=300)
    state, table = env.episode.states["fire"], env.observer.labels[0]
    labels = table[seen["segmentation"][0, ..., 0].long()].numpy()
    image = seen["thermal"][0, ..., 0].numpy()
    compared = 0
    for b in np.unique(labels[labels >= 0]).tolist():
        inside = labels == b
        if inside.sum() > 300 and state.status[0, b] != BURNING:
            warm = float(state.temperature[0, b])
            assert np.median(image[inside]) == pytest.approx(
                20.0 + 0.95 * (warm - 20.0), abs=0.04 * (warm - 20.0) + 1.0
            )
            compared += 1
    assert compared >= 3
    env.close()


@pytest.mark.render
def test_what_burns_outshines_the_room() -> None:
    env, seen = played("HazardFire-v1", "realistic", ("thermal",), frames=0)
    state = env.episode.states["fire"]
    labels = env.observer.labels[0][seen["segmentation"][0, ..., 0].long()]
    b = max(labels[labels >= 0].unique().tolist(), key=lambda k: int((labels == k).sum()))
    cool = float(seen["thermal"][0, ..., 0][labels == b].median())
    state.temperature[0, b] = 500.0
    hot = env.get_obs(env.get_info())["sensor_data"][env.agent.head_camera]["thermal"][0, ..., 0]
    assert cool < 60.0 and float(hot[labels == b].median()) == pytest.approx(487.0, abs=8.0)
    env.close()


@pytest.mark.render
def test_smoke_takes_depth_and_colour_and_what_the_agent_knows() -> None:
    """Smoke of 1.5 per metre from the floor up: nothing is seen beyond 2 m."""
    env, _ = played("HazardFire-v1", "realistic", ("degraded",), frames=0)
    state = env.episode.states["fire"]
    state.zone_height[:], state.zone_density[:], state.zone_low_density[:] = 0.0, 1.5, 1.5
    seen = env.get_obs(env.get_info())["sensor_data"][env.agent.head_camera]
    params = env.observer.camera.get_params()
    true = env.observer._textures(depth=True)["depth"].float()[0, ..., 0] * 1e-3
    k = params["intrinsic_cv"][0]
    row, column = torch.meshgrid(torch.arange(256) + 0.5, torch.arange(256) + 0.5, indexing="ij")
    slant = ((column - k[0, 2]) / k[0, 0]) ** 2 + ((row - k[1, 2]) / k[1, 1]) ** 2
    ray = true * (1.0 + slant).sqrt()
    found = seen["depth"][0, ..., 0]
    assert (found[ray > 2.03] == 0).all() and (found[ray < 1.97] > 0).all() and bool((ray < 1.97).any())
    _, view = env.observer.look()
    assert (view.labels[view.depth == 0.0] == -3).all() and (view.depth == 0.0).mean() > 0.3
    env.close()


@pytest.mark.render
@pytest.mark.parametrize(("task", "physics"), [("HazardFlood-v1", "paper"), ("HazardWind-v1", "realistic")])
def test_where_nothing_is_warm_the_camera_shows_the_room_and_its_noise(task: str, physics: str) -> None:
    env, seen = played(task, physics, ("thermal", "degraded"), frames=20)
    image = seen["thermal"]
    assert float(image.mean()) == pytest.approx(20.0, abs=0.05) and float(image.std()) == pytest.approx(0.28, abs=0.03)
    env.close()
