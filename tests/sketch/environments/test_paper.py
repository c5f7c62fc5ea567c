"""The six actions and the map as gymnasium's environments, made by the same ids as options."""

from __future__ import annotations

import warnings
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.skills.options.interface import INFO
from hazard_ms.skills.options.paper_actions import COUNT, LET_GO, LOOK
from hazard_ms.spec.registry import TASKS

ID = "hazard_ms:HazardFireSkills-v1"
SCENE = {"scenes": ["kitchen_a/00"], "actions": "paper", "reward": "paper"}
SMALL = {"sensor_configs": {"width": 64, "height": 64}}
A_PICTURE = "It seems that your observation"  # Stable-Baselines3 takes any map for a picture


def checked(env: Any) -> None:
    """Have both checkers look at `env`; all that they may say is that its maps are no pictures."""
    from stable_baselines3.common.env_checker import check_env as check_for_sb3

    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        check_env(env)
        warnings.filterwarnings("ignore", message=A_PICTURE)
        check_for_sb3(env)


@pytest.mark.parametrize("masked", [False, True])
def test_the_checkers_of_gymnasium_and_stable_baselines(masked: bool) -> None:
    env = gym.make(ID, backend="sketch", masked=masked, **SCENE).unwrapped
    checked(env)
    obs, info = env.reset(seed=0)
    assert obs.shape == (5, 64, 64) and env.action_space == gym.spaces.Discrete(6)
    mask = env.action_masks()
    assert mask[LOOK] and mask.all() is not masked and np.array_equal(mask, info["action_mask"])
    assert mask[LET_GO] is np.bool_(not masked)  # nothing is in the hand
    _, reward, _, _, info = env.step(LET_GO)
    assert set(info) == {row.key for row in INFO} and reward == pytest.approx(-5.1)
    assert (info["option"], info["ok"], info["reason"], info["frames"]) == ("drop", False, "not_available", 10)
    with pytest.raises(ValueError, match="action must be a whole number from 0 to 5"):
        env.step(6)


@pytest.mark.render
@pytest.mark.parametrize("masked", [False, pytest.param(True, marks=pytest.mark.long)])
def test_the_simulator_has_the_same_spaces_and_punishes_alike(masked: bool) -> None:
    env: Any = gym.make(ID, split="train", actions="paper", reward="paper", masked=masked, **SMALL).unwrapped
    if masked:
        checked(env)
    sketch = gym.make(ID, backend="sketch", **SCENE)
    assert env.observation_space == sketch.observation_space and env.action_space == sketch.action_space
    env.reset(seed=0)
    assert env.action_masks()[LET_GO] == (not masked)
    obs, reward, terminated, truncated, info = env.step(LET_GO)
    assert reward == pytest.approx(-5.1, abs=0.05) and not terminated and not truncated
    assert (info["option"], info["reason"], info["frames"]) == ("drop", "not_available", 10)
    obs, _, _, _, info = env.step(LOOK)
    assert env.observation_space.contains(obs) and info["option"] == "explore" and info["ok"]
    possible = [k for k in range(COUNT) if k != LOOK and (not masked or env.action_masks()[k])]
    obs, *_ = env.step(possible[0])
    assert env.observation_space.contains(obs)
    env.close()


def test_many_at_once_have_the_same_spaces() -> None:
    envs = gym.make_vec(ID, 4, backend="sketch", masked=True, **SCENE)
    obs, info = envs.reset(seed=0)
    assert envs.single_action_space == gym.spaces.Discrete(6) and obs.shape == (4, 5, 64, 64)
    chance = np.random.default_rng(0)
    for _ in range(30):
        mask = info["action_mask"]
        obs, rewards, _, _, info = envs.step((chance.random(mask.shape) * mask).argmax(axis=1))
        assert envs.observation_space.contains(obs) and (rewards > -200.0).all()


@pytest.mark.parametrize("task", TASKS)
def test_every_hazard_has_a_plane(task: str) -> None:
    made = gym.make(task.replace("-v1", "Skills-v1"), backend="sketch", actions="paper")
    planes = 6 if task == "HazardCompound-v1" else 5
    assert made.observation_space.shape == (planes, 64, 64)


@pytest.mark.parametrize("backend", ["sketch", "simulator"])
def test_options_always_have_masks(backend: str) -> None:
    with pytest.raises(ValueError, match="masked must be False with actions='options'"):
        gym.make(ID, backend=backend, masked=True)
    with pytest.raises(ValueError, match="masked"):
        gym.make(ID, backend=backend, actions="paper", masked=1)
