"""Skills as a gymnasium environment, as learners meet it: checkers, vector environments, rewards, masks, ends."""

from __future__ import annotations

import subprocess
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.skills.options.environment import IDLE
from hazard_ms.skills.options.options import FIRST, LOOK
from hazard_ms.spec.registry import TASKS

SMALL = {"sensor_configs": {"width": 64, "height": 64}}
LOOK_AROUND, STOP = FIRST[LOOK], 44


@pytest.fixture(scope="module")
def env() -> Iterator[Any]:
    made = gym.make("HazardFireSkills-v1", **SMALL)
    yield made
    made.close()


def test_every_task_has_an_environment_of_skills() -> None:
    names = [name.replace("-v1", "Skills-v1") for name in TASKS]
    assert set(names) <= set(gym.registry) and "HazardCompoundSkills-v1" in names


def test_without_a_renderer_it_is_refused_at_once() -> None:
    with pytest.raises(ValueError, match="render_backend must be a renderer, got none"):
        gym.make("HazardFireSkills-v1", render_backend="none")


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"actions": "option"}, "did you mean 'options'"),
        ({"obs_mode": "state"}, "obs_mode must not be given"),
        ({"stop": 1}, "stop"),
        ({"max_frames": 0}, "max_frames"),
        ({"robot_uids": "fetsch"}, "did you mean 'fetch'"),
    ],
)
def test_wrong_keywords_are_refused_at_once(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        gym.make("HazardFireSkills-v1", **wrong)


@pytest.mark.long
@pytest.mark.render
def test_the_checkers_of_gymnasium_and_stable_baselines_have_nothing_to_say() -> None:
    from stable_baselines3.common.env_checker import check_env as check_for_sb3

    made = gym.make(
        "HazardFireSkills-v1",
        render_mode="rgb_array",
        effects="off",  # their shaders take a minute to compile
        human_render_camera_configs={"width": 64, "height": 64},
        **SMALL,
    ).unwrapped
    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)  # gymnasium and Stable-Baselines3 warn about what they dislike
        check_env(made)
        check_for_sb3(made)
    picture = made.render()
    assert picture is not None and picture.dtype == np.uint8 and picture.ndim == 3
    made.close()


@pytest.mark.render
def test_the_rewards_of_an_episode_add_up_to_its_value(env: Any) -> None:
    """Until two targets are rescued: rewards are shares of the value of all, as the score counts them."""
    obs, info = env.reset(seed=3)
    total, frame, rng = 0.0, 0, np.random.default_rng(1)
    number = LOOK_AROUND
    for _ in range(25):
        obs, reward, terminated, truncated, info = env.step(number)
        total += reward
        assert env.observation_space.contains(obs) and type(reward) is float
        assert info["frame"] == frame + info["frames"] > frame
        frame = info["frame"]
        assert total == pytest.approx(info["value"], abs=1e-12)
        if info["rescued"] >= 2 or terminated or truncated:
            break
        allowed = np.flatnonzero(env.unwrapped.action_masks()[:STOP])
        targets = allowed[allowed < FIRST["cart"]]
        number = int(rng.choice(targets if len(targets) else allowed))
    base = env.unwrapped.skills.base
    worth = base.world.value[0] * (0.5 * base.episode.rescue.damaged[0] + 1.0 * ~base.episode.rescue.damaged[0])
    saved, targets_all = base.world.safe[0] & base.world.target[0], base.world.target[0]
    assert info["rescued"] >= 1 and total == pytest.approx(
        float(worth[saved].sum()) / float(base.world.value[0][targets_all].sum())
    )


@pytest.mark.render
def test_info_is_plain_numbers_and_text(env: Any) -> None:
    _, first = env.reset(seed=0, options={"lerobot_new_rollout": True})  # as lerobot-eval does
    _, _, _, _, info = env.step(LOOK_AROUND)
    assert set(first) == set(info) and first["option"] == "" and first["value"] == 0.0
    assert info["option"] == "look" and info["ok"] is True and info["reason"] == ""
    assert 58 <= info["frames"] == info["frame"] <= 75  # about 60 frames (docs/benchmark.md 1)
    mask = info.pop("action_mask")
    assert mask.dtype == bool and np.array_equal(mask, env.unwrapped.action_masks())
    assert {type(v) for v in info.values()} <= {int, float, str, bool}


@pytest.mark.render
def test_an_option_that_is_not_available_costs_time_and_does_nothing(env: Any) -> None:
    before, _ = env.reset(seed=0)
    forbidden = int(np.flatnonzero(~env.unwrapped.action_masks())[0])
    _, reward, terminated, truncated, info = env.step(forbidden)
    assert (reward, terminated, truncated, info["ok"]) == (0.0, False, False, False)
    assert (info["reason"], info["frames"]) == ("not_available", IDLE)
    for wrong in (45, -1, 0.5):
        with pytest.raises(ValueError, match="action"):
            env.step(wrong)


@pytest.mark.render
def test_stop_terminates_and_the_end_of_time_truncates() -> None:
    made = gym.make("HazardFireSkills-v1", max_frames=90, **SMALL)
    made.reset(seed=0)
    assert made.step(STOP)[2:4] == (True, False)
    with pytest.raises(ValueError, match="reset"):
        made.step(LOOK_AROUND)
    made.reset(seed=0)
    ends = [made.step(number)[2:] for number in (LOOK_AROUND, 31, 31, 31)]
    assert [(terminated, truncated) for terminated, truncated, _ in ends][-1] == (False, True)
    assert ends[-1][2]["frame"] == 90 and not any(truncated for _, truncated, _ in ends[:-1])
    made.close()
    masked = gym.make("HazardFireSkills-v1", stop=False, **SMALL)
    masked.reset(seed=0)
    assert not masked.unwrapped.action_masks()[STOP]
    masked.close()


@pytest.mark.render
def test_a_seed_begins_a_sequence_of_episodes(env: Any) -> None:
    """The same ones after the same seed; unseeded resets play other scenes."""

    def scenes() -> list[str]:
        made = [env.reset(seed=7), env.reset(), env.reset()]
        assert len(made) == 3
        return [env.unwrapped.skills.base.specs[0].name]

    env.reset(seed=7)
    first = env.unwrapped.skills.base.specs[0].name
    assert scenes() == scenes() and scenes() != [first]


@pytest.mark.long
@pytest.mark.render
@pytest.mark.timeout(900)
def test_vector_environments_of_gymnasium_and_stable_baselines() -> None:
    """In a script of its own: spawned processes import the main module again."""
    code = f"""
import gymnasium as gym
def make():
    return gym.make("hazard_ms:HazardFireSkills-v1", **{SMALL!r})
if __name__ == "__main__":
    from stable_baselines3.common.vec_env import SubprocVecEnv
    envs = gym.vector.AsyncVectorEnv([make], context="spawn")
    obs, info = envs.reset(seed=[1])
    out = envs.step([43])
    print(obs.shape, out[0].dtype, out[4]["frame"].shape, envs.call("action_masks")[0].shape)
    envs.close()
    envs = SubprocVecEnv([make], start_method="spawn")
    envs.seed(1)
    obs = envs.reset()
    obs, reward, done, infos = envs.step([44])
    print(obs.shape, done.tolist(), infos[0]["terminal_observation"].shape, envs.env_method("action_masks")[0].shape)
    envs.close()
"""
    root = Path(__file__).parents[2]
    script = root / "tests" / "_spawn_skills.py"
    script.write_text(code)
    try:
        out = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=800, cwd=root)
    finally:
        script.unlink()
    assert out.returncode == 0, out.stderr[-2000:]
    assert out.stdout.splitlines() == ["(1, 545) float32 (1,) (45,)", "(1, 545) [True] (545,) (45,)"]
