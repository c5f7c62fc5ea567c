"""Vector environments of real tasks: the bits of single ones, and learners that run on them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.wrappers.vector import DictInfoToList, RecordEpisodeStatistics

from hazard_ms import NumpyEnv
from hazard_ms.learning.vector import make, make_for_sb3
from hazard_ms.learning.vector.batched import BatchedEnv

TASK, FRAMES = "HazardFire-v1", 3  # of an episode
KEYWORDS = {"obs_mode": "state", "render_backend": "none", "max_episode_steps": FRAMES}
Played = list[tuple[Any, ...]]


@pytest.fixture(scope="module")
def three() -> Iterator[VectorEnv[Any, Any, Any]]:
    """Three environments in two processes, one of which has two."""
    envs = make(TASK, 3, processes=2, autoreset_mode="SameStep", **KEYWORDS)
    yield envs
    envs.close()


def actions(steps: int) -> np.ndarray:
    return np.random.default_rng(0).uniform(-1.0, 1.0, (steps, 3, 13)).astype(np.float32)


def alone(env: gym.Env, seed: int, number: int, steps: int, mode: AutoresetMode) -> Played:
    """What environment `number` does by itself, reset as gymnasium's documentation of the modes says."""
    played, over = [(*env.reset(seed=seed),)], False
    for action in actions(steps)[:, number]:
        if over and mode == AutoresetMode.NEXT_STEP:
            obs, info = env.reset()
            played.append((obs, 0.0, False, over := False, info))
            continue
        obs, reward, terminated, truncated, info = env.step(action)
        over = terminated or truncated
        if over and mode == AutoresetMode.SAME_STEP:
            final, (obs, again) = {"final_obs": obs, "final_info": info}, env.reset()
            info = {**final, **again}
        played.append((obs, reward, terminated, truncated, info))
    return played


def row(played: tuple[Any, ...], number: int) -> tuple[Any, ...]:
    """The part of one environment of what a vector environment returned."""
    *parts, info = played
    return (*(part[number] for part in parts), told(info, number))


def told(info: dict[str, Any], number: int) -> dict[str, Any]:
    return {
        name: told(value, number) if isinstance(value, dict) else value[number]
        for name, value in info.items()
        if not name.startswith("_") and info[f"_{name}"][number]
    }


def same(one: Any, other: Any) -> bool:
    """Whether two results hold the same bits."""
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[name], other[name]) for name in one)
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    return np.asarray(one).tobytes() == np.asarray(other, np.asarray(one).dtype).tobytes()


def test_environments_in_processes_give_the_bits_of_single_ones(three: VectorEnv[Any, Any, Any]) -> None:
    """Over three episodes each, of which the first has a seed; two of them play by turns in one process."""
    steps = 3 * FRAMES - 1
    together = [three.reset(seed=[7, 2**31, 7]), *(three.step(action) for action in actions(steps))]
    env = NumpyEnv(gym.make(TASK, **KEYWORDS))
    for number, seed in enumerate((7, 2**31, 7)):
        single = alone(env, seed, number, steps, AutoresetMode.SAME_STEP)
        for played, expected in zip(together, single, strict=True):
            assert same(row(played, number), expected), number
    env.close()
    assert not same(row(together[-1], 0), row(together[-1], 2))  # the same scene, other actions
    assert three.get_attr("num_envs") == (1, 1, 1)


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_the_batch_of_a_gpu_has_the_same_interface(mode: AutoresetMode) -> None:
    """Here a batch of one on the processor, beside the single environment: what resets when, and what is told."""
    steps = 3 * FRAMES + 1
    env = BatchedEnv(gym.make(TASK, **KEYWORDS), mode)
    single = alone(NumpyEnv(gym.make(TASK, **KEYWORDS)), 7, 0, steps, mode)
    together = [
        env.reset(seed=7, options={"lerobot_new_rollout": True}),
        *(env.step(action[:1]) for action in actions(steps)),
    ]
    assert env.metadata["autoreset_mode"] == mode
    for played, expected in zip(together, single, strict=True):
        obs, *numbers, info = row(played, 0)
        assert same((obs, *numbers), expected[:-1])
        assert same(info.get("final_obs"), expected[-1].get("final_obs"))
        assert info["elapsed_steps"] == expected[-1]["elapsed_steps"]
        assert same(info.get("final_info", {}).get("value"), expected[-1].get("final_info", {}).get("value"))
    assert env.observation_space.contains(together[-1][0])
    env.close()


def test_wrappers_of_gymnasium_fit(three: VectorEnv[Any, Any, Any]) -> None:
    wrapped = DictInfoToList(RecordEpisodeStatistics(three))
    obs, told = wrapped.reset(seed=1, options={"lerobot_new_rollout": True})  # as lerobot-eval does
    assert wrapped.observation_space.contains(obs) and [info["elapsed_steps"] for info in told] == [0] * 3
    sums = np.zeros(3)
    for action in actions(FRAMES):
        _, rewards, _, truncated, info = wrapped.step(action)  # type: ignore[assignment]
        sums += rewards
    assert truncated.all() and [each["episode"]["l"] for each in info] == [FRAMES] * 3
    np.testing.assert_allclose([each["episode"]["r"] for each in info], sums, rtol=1e-6)


def test_stable_baselines_learns_on_it(three: VectorEnv[Any, Any, Any]) -> None:
    pytest.importorskip("stable_baselines3")
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

    from hazard_ms.learning.vector.stable_baselines import SB3VecEnv

    envs = SB3VecEnv(three)
    envs.seed(5)
    first = envs.reset()
    assert same(first, three.reset(seed=5)[0]) and envs.has_attr("spec") and not envs.has_attr("wealth")
    ends = 0
    for action in actions(2 * FRAMES):
        obs, rewards, done, infos = envs.step(action)
        for n in np.flatnonzero(done):
            assert infos[n]["TimeLimit.truncated"] and infos[n]["episode"]["l"] == FRAMES
            assert infos[n]["elapsed_steps"] == FRAMES and not same(infos[n]["terminal_observation"], obs[n])
            ends += 1
    assert ends == 6 and rewards.dtype == np.float32
    model = PPO("MlpPolicy", VecNormalize(VecMonitor(envs)), n_steps=4, batch_size=12, n_epochs=1, seed=3, device="cpu")
    model.learn(24)
    assert model.num_timesteps == 24 and np.isfinite(model.rollout_buffer.observations).all()
    assert model.ep_info_buffer and model.ep_info_buffer[0]["l"] == FRAMES


def test_other_times_of_resets_are_refused_for_stable_baselines() -> None:
    pytest.importorskip("stable_baselines3")
    from hazard_ms.learning.vector.stable_baselines import SB3VecEnv

    env = BatchedEnv(gym.make(TASK, **KEYWORDS), AutoresetMode.NEXT_STEP)
    with pytest.raises(ValueError, match="must be SameStep for Stable-Baselines3"):
        SB3VecEnv(env)
    env.close()


def test_the_sketch_is_one_batch() -> None:
    settings = {"backend": "sketch", "scenes": ["kitchen_a/00"]}
    envs = make("hazard_ms:HazardFireSkills-v1", 4, **settings)
    own = gym.make_vec("HazardFireSkills-v1", 4, vectorization_mode="vector_entry_point", **settings)
    assert type(envs) is type(own) and data_equivalence(envs.reset(seed=1), own.reset(seed=1), exact=True)
    assert envs.metadata["autoreset_mode"] == AutoresetMode.SAME_STEP
    with pytest.raises(ValueError, match="must be SameStep with backend='sketch', got 'NextStep'"):
        make("HazardFireSkills-v1", 4, autoreset_mode="NextStep", **settings)


def test_the_sketch_gives_its_masks_to_stable_baselines() -> None:
    """Of what is seen now, also right after an episode has ended, as MaskablePPO asks for them."""
    pytest.importorskip("sb3_contrib")
    from sb3_contrib.common.maskable.utils import get_action_masks, is_masking_supported

    envs = make_for_sb3("HazardFireSkills-v1", 4, backend="sketch", scenes=["kitchen_a/00"], max_frames=200)
    assert is_masking_supported(envs)
    envs.seed(0)
    envs.reset()
    rng, ends = np.random.default_rng(0), 0
    while ends < 8:
        masks = get_action_masks(envs)
        assert masks.dtype == bool and masks.shape == (4, envs.action_space.n) and masks.any(axis=1).all()
        np.testing.assert_array_equal(masks, envs.envs.action_masks())
        _, _, done, _ = envs.step(np.array([rng.choice(np.flatnonzero(mask)) for mask in masks]))
        ends += int(done.sum())


def test_wrong_keywords_are_refused_as_by_a_single_environment() -> None:
    with pytest.raises(ValueError) as single:
        gym.make(TASK, physicss="paper")
    with pytest.raises(ValueError) as several:
        make(TASK, 2, processes=1, physicss="paper")
    assert str(several.value) == str(single.value)


@pytest.mark.long
@pytest.mark.render
def test_decisions_in_the_simulator_are_played_in_processes() -> None:
    settings = {"backend": "simulator", "max_frames": 120}
    envs = make("HazardFireSkills-v1", 2, autoreset_mode="SameStep", **settings)
    env = gym.make("HazardFireSkills-v1", **settings)
    together = [envs.reset(seed=3), *(envs.step(np.array([0, 0])) for _ in range(4))]
    for number in range(2):
        obs, _ = env.reset(seed=3 + number)
        assert same(obs, together[0][0][number])
        for played in together[1:]:
            obs, reward, terminated, truncated, info = env.step(0)
            assert reward == played[1][number] and terminated == played[2][number] and truncated == played[3][number]
            if terminated or truncated:
                break
            assert same(obs, played[0][number]) and info["frame"] == played[4]["frame"][number]
    assert np.stack(envs.call("action_masks")).shape == (2, envs.single_action_space.n)  # type: ignore[attr-defined]
    envs.close()
    env.close()
