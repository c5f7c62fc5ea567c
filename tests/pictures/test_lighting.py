"""Light of a scene: it is drawn by the seed, lamps fail, and neither light nor effects change an episode."""

from __future__ import annotations

import hashlib
from types import SimpleNamespace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.simulation.drawing.lighting import DRAWN, FIRST_FAILURE, LAST_FAILURE, LIGHTINGS, Lighting
from hazard_ms.tasks import task_of

FRAMES = 40  # of an episode: the fire has spread by then


def bare(mode: str, count: int = 1) -> Lighting:
    """Light without a renderer, in `count` scenes."""
    task = task_of("HazardFire-v1", "paper")
    spec = task.build(task.scenes("train")[0])
    return Lighting(SimpleNamespace(can_render=lambda: False), (spec,) * count, mode)


def test_random_light_is_drawn_by_the_seed_alone() -> None:
    seeds = torch.arange(400)
    drawn = bare("random", 400).chosen(seeds)
    assert drawn == bare("random", 400).chosen(seeds)
    assert set(drawn) == set(DRAWN)
    assert all(60 < drawn.count(name) < 140 for name in DRAWN)  # 100 expected of each
    assert bare("random").chosen(seeds[7:8]) == drawn[7:8]  # alone as among others


def test_failing_lamps_shine_then_flicker_then_stay_dark() -> None:
    light, seed = bare("failing"), torch.tensor([5])
    course = torch.stack([light._failing(seed, torch.tensor([f]))[0] for f in range(LAST_FAILURE + 1)])
    for lamp in course.T:
        dark = int((lamp == 0.0).nonzero()[0])
        assert FIRST_FAILURE <= dark <= LAST_FAILURE
        assert (lamp[dark:] == 0.0).all()
        assert (lamp[: max(0, dark - 151)] == 1.0).all()
    assert ((course > 0.0) & (course < 1.0)).any()


def test_unknown_light_is_refused() -> None:
    with pytest.raises(ValueError, match="lighting must be one of day, evening, night, failing, random, got 'dusk'"):
        gym.make("HazardFire-v1", lighting="dusk")


def episode(lighting: str, effects: str, draw: bool) -> tuple[str, np.ndarray]:
    """Hash of all state after some frames, and the labels of the head camera."""
    made = gym.make("HazardFire-v1", obs_mode="none", render_mode="rgb_array", lighting=lighting, effects=effects)
    env: Any = made.unwrapped
    env.reset(seed=3)
    still = np.zeros(env.single_action_space.shape, np.float32)
    for frame in range(FRAMES):
        env.advance(still)
        if draw and frame == FRAMES // 2:
            env.render()
    digest = hashlib.sha256()
    _feed(digest, env.get_state_dict())
    camera = env._sensors[env.agent.head_camera]
    env.observer.show()
    env.scene.update_render(update_sensors=True, update_human_render_cameras=False)
    camera.capture()
    labels = camera.get_obs(rgb=False, depth=False, position=False, segmentation=True)["segmentation"]
    made.close()
    return digest.hexdigest(), labels.cpu().numpy()


def _feed(digest: Any, state: Any) -> None:
    if isinstance(state, dict):
        for key in sorted(state):
            digest.update(str(key).encode())
            _feed(digest, state[key])
    else:
        digest.update(np.ascontiguousarray(torch.as_tensor(state).cpu().numpy()).tobytes())


@pytest.mark.render
def test_light_and_effects_change_neither_episode_nor_labels() -> None:
    plain = episode("day", "full", draw=False)
    for lighting, effects in (("night", "full"), ("random", "off")):
        digest, labels = episode(lighting, effects, draw=True)
        assert digest == plain[0], lighting
        np.testing.assert_array_equal(labels, plain[1], err_msg=lighting)


@pytest.mark.render
@pytest.mark.long
@pytest.mark.parametrize("lighting", LIGHTINGS)
@pytest.mark.parametrize("effects", ["full", "fast", "off"])
def test_every_light_and_every_look_leaves_the_episode_alone(lighting: str, effects: str) -> None:
    assert episode(lighting, effects, draw=True)[0] == episode("day", "full", draw=False)[0]
