"""One rescue in the sketch as gymnasium's environment, made by the same id as that in the simulator."""

from __future__ import annotations

import warnings
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.sketch.environments.settings import Settings
from hazard_ms.sketch.environments.single import SketchSkills
from hazard_ms.skills.options.interface import INFO
from hazard_ms.skills.options.options import COUNT, END, FIRST, LOOK
from hazard_ms.spec.registry import TASKS
from hazard_ms.tasks import task_of

ID = "hazard_ms:HazardFireSkills-v1"
TWO = ["kitchen_a/00", "kitchen_a/03"]


@pytest.fixture(scope="module")
def env() -> Any:
    return gym.make(ID, backend="sketch", scenes=TWO)


def test_the_checkers_of_gymnasium_and_stable_baselines_have_nothing_to_say(env: Any) -> None:
    from stable_baselines3.common.env_checker import check_env as check_for_sb3

    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        check_env(env.unwrapped)
        check_for_sb3(env.unwrapped)


def test_info_has_the_keys_and_types_that_the_simulator_gives(env: Any) -> None:
    _, first = env.reset(seed=0)
    _, _, _, _, info = env.step(FIRST[LOOK])
    assert set(first) == set(info) == {row.key for row in INFO}
    assert info["option"] == "look" and info["ok"] is True and info["frames"] == info["frame"] > 30
    mask = info.pop("action_mask")
    assert np.array_equal(mask, env.unwrapped.action_masks()) and mask.shape == (COUNT,)
    assert {type(value) for value in info.values()} <= {int, float, str, bool}


def test_the_rewards_of_an_episode_add_up_to_its_value(env: Any) -> None:
    chance = np.random.default_rng(0)
    for seed in range(4):
        env.reset(seed=seed)
        total, over = 0.0, False
        while not over:
            allowed = np.flatnonzero(env.unwrapped.action_masks()[: FIRST[END]])
            obs, reward, terminated, truncated, info = env.step(int(chance.choice(allowed)))
            total, over = total + reward, terminated or truncated
            assert env.observation_space.contains(obs) and type(reward) is float
        assert total == pytest.approx(info["value"], abs=1e-12)
        with pytest.raises(ValueError, match="reset"):
            env.step(0)


def test_a_seed_chooses_the_scene_and_begins_a_series(env: Any) -> None:
    played = [env.reset(seed=seed)[0] for seed in (0, 1, 0)]
    np.testing.assert_array_equal(played[0], played[2])
    assert (played[0] != played[1]).any()
    named, _ = env.reset(seed=0, options={"scene": TWO[1]})
    assert (named != played[0]).any()
    told, _ = env.reset(seed=0, options={"lerobot_new_rollout": True, "scene": TWO[1]})  # as lerobot-eval does
    np.testing.assert_array_equal(told, named)
    series = [[env.reset(seed=4)[0], env.reset()[0], env.reset()[0]] for _ in range(2)]
    np.testing.assert_array_equal(*series)


def test_what_is_forbidden_costs_time_and_says_so(env: Any) -> None:
    env.reset(seed=0)
    forbidden = int(np.flatnonzero(~env.unwrapped.action_masks())[0])
    _, reward, terminated, truncated, info = env.step(forbidden)
    assert (reward, terminated, truncated, info["ok"], info["reason"]) == (0.0, False, False, False, "not_available")
    assert info["frames"] == 10
    for wrong in (COUNT, -1, 0.5):
        with pytest.raises(ValueError, match="action"):
            env.step(wrong)


def test_the_task_is_told_in_the_words_of_the_simulator(env: Any) -> None:
    assert env.get_wrapper_attr("task_description") == task_of("HazardFire-v1", "paper").text != ""


@pytest.mark.parametrize("task", TASKS)
def test_spaces_are_those_of_the_simulator(task: str) -> None:
    """Which has 15 numbers for each target and 10 of the whole with one hazard, and 2 and 1 more with each further.

    Where fires can be put out there are 8 for each of 6 fires and 7 of the tool, and an option for each.
    """
    made = SketchSkills(task=task)
    hazards = len(made.settings.ranges)
    size = 32 * (13 + 2 * hazards) + 3 * 5 + 8 * 5 + 9 + hazards
    numbers, options = (6 * 8 + 7, 6 + 1) if task == "HazardHouseFire-v1" else (0, 0)
    assert made.observation_space.shape == (size + numbers,)
    assert made.action_space == gym.spaces.Discrete(COUNT + options)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"backend": "sketsch"}, "did you mean 'sketch'"),
        ({"actions": "option"}, "did you mean 'options'"),
        ({"split": "tran"}, "did you mean 'train'"),
        ({"scenes": ["kitchen_a/99"]}, "scene must be"),
        ({"scenes": []}, "scenes must hold at least one"),
        ({"reward": "gold"}, "reward must be one of value, paper"),
        ({"max_frames": 0}, "max_frames"),
        ({"robot_uids": "fetsch"}, "did you mean 'fetch'"),
        ({"stop": 1}, "stop"),
        ({"render_mode": "rgb_array"}, "render_mode must be None"),
        ({"generated": (3, 2)}, "first must be"),
        ({"generated": 25}, r"generated must be \(first, count\)"),
        ({"generated": (25, 10**9)}, "the count of generated must be"),
        ({"generated": (25, 2), "scenes": TWO}, "scenes must be None beside it"),
    ],
)
def test_wrong_keywords_are_refused_at_once(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        gym.make(ID, **{"backend": "sketch", **wrong})


def test_scenes_have_the_length_of_their_split() -> None:
    assert [Settings.of("HazardFire-v1", split=split).max_frames for split in ("train", "hard")] == [1500, 900]
    assert Settings.of("HazardFire-v1", max_frames=70).max_frames == 70
    assert Settings.of("HazardFire-v1", generated=(25, 1)).scene(0).max_frames == 1500
    assert Settings.of("HazardFire-v1", generated=(25, 1), max_frames=70).scene(0).max_frames == 70


def test_generated_scenes_are_asked_for_by_number() -> None:
    made = Settings.of("HazardFire-v1", generated=(25, 2))
    assert [made.number(name) for name in ("25", "26", None)] == [0, 1, None]
    with pytest.raises(ValueError, match="reset option 'scene' must be one of 25, 26, got '27'"):
        made.number("27")


def test_many_at_once_are_made_by_the_same_id() -> None:
    made = gym.make_vec(ID, num_envs=3, backend="sketch", scenes=TWO[:1])
    obs, info = made.reset(seed=0)
    assert obs.shape[0] == 3 == len(info["action_mask"])
    with pytest.raises(ValueError, match="vectorization_mode='async'"):
        gym.make_vec(ID, num_envs=3)
