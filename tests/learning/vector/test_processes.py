"""Environments in processes are like gymnasium's own vector environment, and refuse what is wrong.

A small environment stands for the real ones, which take seconds to start: `test_real_environments.py` has those.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import hazard_ms
from hazard_ms.learning.vector import make
from hazard_ms.learning.vector.processes import ProcessVectorEnv
from tests.worlds.naughty_env import ODD, RAISE, WALK, Naughty
from tests.worlds.naughty_vector import NAME, naughty, pids


def test_the_package_offers_it() -> None:
    assert hazard_ms.vector.make is make


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_it_is_as_gymnasiums_own(mode: AutoresetMode) -> None:
    """Five environments in two processes, of which one has three, beside gymnasium's in one process."""
    own = SyncVectorEnv([lambda: Naughty(speed=2.0)] * 5, autoreset_mode=mode)
    with naughty(5, speed=2.0, autoreset_mode=mode) as envs:
        assert envs.single_observation_space == own.single_observation_space
        assert envs.observation_space == own.observation_space and envs.action_space == own.action_space
        assert envs.metadata["autoreset_mode"] == mode == own.metadata["autoreset_mode"]
        assert data_equivalence(envs.reset(seed=3), own.reset(seed=3), exact=True)
        ends = 0
        for _ in range(25):
            made, theirs = (some.step(np.full(5, WALK)) for some in (envs, own))
            assert data_equivalence(made, theirs, exact=True)
            over = made[2] | made[3]
            ends += int(over.sum())
            if mode == AutoresetMode.DISABLED and over.any():
                again = [some.reset(options={"reset_mask": over.copy(), "place": 1.0}) for some in (envs, own)]
                assert data_equivalence(again[0][0], again[1][0], exact=True)
        assert ends > 10
        seeds = [9, 8, 7, 6, None]
        made, theirs = envs.reset(seed=seeds), own.reset(seed=seeds)  # type: ignore[assignment]
        assert data_equivalence(made[0], theirs[0], exact=True)


def test_what_is_handed_out_stays_as_it_was() -> None:
    with naughty(2) as envs:
        obs, _ = envs.reset(seed=0)
        before = obs["place"].copy()
        envs.step([WALK, WALK])
        np.testing.assert_array_equal(obs["place"], before)


def test_attributes_and_methods_are_those_of_each_environment() -> None:
    with naughty(3) as envs:
        envs.set_attr("mood", ["sad", "glad", "mad"])
        assert envs.call("mood_of", "it", mark="!") == ("it is sad!", "it is glad!", "it is mad!")
        assert envs.get_attr("mood") == ("sad", "glad", "mad")
        assert envs.call_some([2, 0], "mood_of", "it") == ("it is mad", "it is sad")
        envs.set_attr("mood", "fine")
        assert envs.get_attr("mood") == ("fine",) * 3
        with pytest.raises(AttributeError):
            envs.get_attr("wealth")
        with pytest.raises(ValueError, match="a list of 3, got 2"):
            envs.set_attr("mood", ["sad", "glad"])


def test_errors_of_an_environment_are_its_own_and_name_it() -> None:
    with naughty(3) as envs:
        with pytest.raises(ValueError, match="call reset first"):
            envs.step([WALK] * 3)
        envs.reset(seed=0)
        with pytest.raises(ValueError, match="told to raise") as raised:
            envs.step([WALK, WALK, RAISE])
        assert "in environment 2:" in str(raised.value.__cause__) and "naughty_env.py" in str(raised.value.__cause__)
        with pytest.raises(ValueError, match="call reset first"):  # the others went on
            envs.step([WALK] * 3)
        envs.reset(seed=0)
        with pytest.raises(RuntimeError, match="OddError: odd: 1 and 2"):
            envs.step([ODD, WALK, WALK])
        with pytest.raises(ValueError, match="options must be place"):
            envs.reset(options={"time": 3})
        envs.reset(seed=0)
        assert envs.step([WALK] * 3)[1].shape == (3,)


@pytest.mark.parametrize(
    ("actions", "word"),
    [([WALK] * 2, r"shape \(3,\)"), ([[WALK] * 3], r"shape \(3,\)"), ([0.0, np.nan, 0.0], "finite")],
)
def test_wrong_actions_are_refused_before_anything_happens(actions: Any, word: str, three: ProcessVectorEnv) -> None:
    before = three.reset(seed=1)[0]
    with pytest.raises(ValueError, match=word):
        three.step(actions)
    again = three.step([WALK] * 3)[0]
    three.reset(seed=1)
    np.testing.assert_array_equal(three.step([WALK] * 3)[0]["place"], again["place"])
    assert before["place"].shape == (3, 2)


@pytest.fixture(scope="module")
def three() -> Iterator[ProcessVectorEnv]:
    with naughty(3) as envs:
        yield envs


@pytest.mark.parametrize(
    ("keywords", "word"),
    [
        ({"seed": [1, 2]}, "3 of them, got 2"),
        ({"seed": "one"}, "seed must be a whole number"),
        ({"seed": -1}, "seed must be a whole number"),
        ({"options": {"reset_mask": np.zeros(3, bool)}}, "at least one of them True"),
        ({"options": {"reset_mask": [True, False]}}, "3 flags"),
    ],
)
def test_wrong_seeds_and_masks_are_refused(keywords: dict[str, Any], word: str, three: ProcessVectorEnv) -> None:
    with pytest.raises(ValueError, match=word):
        three.reset(**keywords)


@pytest.mark.parametrize(
    ("keywords", "word"),
    [
        ({"num_envs": 0}, "num_envs must be a whole number from 1"),
        ({"num_envs": 1.5}, "num_envs must be a whole number from 1"),
        ({"processes": 0}, "processes must be"),
        ({"patience": 0}, "patience must be positive"),
        ({"autoreset_mode": "Never"}, "autoreset_mode must be one of NextStep, SameStep, Disabled, got 'Never'"),
        ({"speed": -1}, "speed must be positive, got -1"),
    ],
)
def test_wrong_keywords_are_refused(keywords: dict[str, Any], word: str) -> None:
    before = pids()
    with pytest.raises(ValueError, match=word):
        make(NAME, **{"num_envs": 2, **keywords})
    assert pids() == before


def test_names_that_do_not_exist_are_refused_as_gymnasium_does() -> None:
    for name in ("HazardFir-v1", "HazardFire-v9"):
        with pytest.raises(gym.error.Error) as single:
            gym.make(name)
        with pytest.raises(type(single.value), match=re.escape(str(single.value))):
            make(name, 2)


def test_no_file_of_shared_memory_is_left(three: ProcessVectorEnv) -> None:
    three.reset(seed=0)
    assert not [*Path("/dev/shm").glob("hazard_ms-*")]
