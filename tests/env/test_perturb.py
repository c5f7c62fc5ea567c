"""Perturbations of environments: the seed decides, level 0 changes no bit, higher levels are farther from training."""

from __future__ import annotations

import math
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.lerobot.environment import RobotEnv
from tests.worlds.perturbed import SIDE, begun, made

ALL = "lighting:2,camera:2,objects:2,words:2,start:2,noise:2"


@pytest.mark.render
@pytest.mark.parametrize("perturb", ["lighting:1", "camera:1", "noise:1", "objects:3", "start:1"])
def test_the_same_seed_gives_the_same_picture_and_another_one_another(perturb: str) -> None:
    (one, *_), (other, *_), (again, *_) = begun(perturb, (1, 2, 1))
    (plain, *_), (plain_other, *_) = begun(None, (1, 2))
    assert (one == again).all()
    assert (one != other).any()
    assert (plain == plain_other).all()  # of one scene: all the difference is the perturbation's
    assert (one != plain).any()


@pytest.mark.render
@pytest.mark.parametrize("perturb", ["", "lighting:0,camera:0,objects:0,words:0,start:0,noise:0,hazard:0"])
def test_level_0_changes_no_bit(perturb: str) -> None:
    episodes = []
    for asked in (None, perturb):
        env = made(asked, obs_mode="rgb+depth+segmentation+state")
        obs, _ = env.reset(seed=3)
        still = np.zeros(env.unwrapped.single_action_space.shape, np.float32)
        for _ in range(20):
            obs, *_ = env.step(still)
        rgb, view = env.unwrapped.observer.look()
        told = (env.unwrapped.task_description, env.unwrapped.task.text)
        episodes.append((*leaves(obs), *leaves(env.unwrapped.get_state_dict()), rgb, view.depth, view.cam2world))
        assert told[0] == told[1]
        env.close()
    for a, b in zip(*episodes, strict=True):
        np.testing.assert_array_equal(np.asarray(a), np.asarray(b))


def leaves(value: Any) -> list[Any]:
    """All arrays of nested dictionaries."""
    if isinstance(value, dict):
        return [leaf for key in sorted(value) for leaf in leaves(value[key])]
    return [value.cpu().numpy() if isinstance(value, torch.Tensor) else value]


@pytest.mark.render
def test_light_and_cameras_leave_physics_alone() -> None:
    states = []
    for perturb in (None, "lighting:3,camera:3,noise:3,words:3"):
        env = made(perturb, obs_mode="rgb")
        env.reset(seed=4)
        for _ in range(20):
            env.step(np.zeros(env.unwrapped.single_action_space.shape, np.float32))
        states.append(leaves(env.unwrapped.get_state_dict()))
        env.close()
    for a, b in zip(*states, strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.render
def test_scenes_are_lit_as_drawn() -> None:
    (_, _, plain), *_ = begun(None, (1,))
    for _, _, mood in begun("lighting:3", (1, 2, 3)):
        factor = (
            np.array(mood.ambient) @ (0.2126, 0.7152, 0.0722) / (np.array(plain.ambient) @ (0.2126, 0.7152, 0.0722))
        )
        assert abs(math.log2(factor)) > 0.6  # of 0.75 to 1 stop, in colours that are not quite white


@pytest.mark.render
def test_noise_is_as_strong_as_its_level_says_and_new_in_each_frame() -> None:
    env = made("noise:3", obs_mode="rgb")
    env.reset(seed=1, options={"scene": "kitchen_a/03"})
    (plain, *_), *_ = begun(None, (1,))
    first = env.unwrapped.get_obs()["sensor_data"]["head"]["rgb"].numpy().astype(float)
    middle = (plain > 100) & (plain < 155)  # where nothing is cut off
    assert (first - plain)[middle].std() == pytest.approx(0.18 * 255.0, rel=0.05)
    look, _ = env.unwrapped.observer.look()
    assert (look.numpy() == first[0]).all()
    env.step(np.zeros(env.unwrapped.single_action_space.shape, np.float32))
    second = env.unwrapped.get_obs()["sensor_data"]["head"]["rgb"].numpy().astype(float)
    assert (second - first)[middle].std() > 0.18 * 255.0
    env.close()


def test_words_are_those_of_the_seed_and_the_level() -> None:
    env = gym.make("HazardFlood-v1", obs_mode="state", render_backend="none", perturb="words:2")
    said: dict[int, str] = {}
    for seed in (0, 1, 2, 3, 4, 5, 0):
        env.reset(seed=seed)
        sentence = env.unwrapped.task_description  # type: ignore[attr-defined]
        assert said.setdefault(seed, sentence) == sentence
    assert set(said.values()) <= set(env.unwrapped.task.rewordings[1])  # type: ignore[attr-defined]
    assert len(set(said.values())) > 1
    assert all("the bag that you carry" in sentence and "flood" in sentence for sentence in said.values())
    env.close()


def test_objects_and_start_are_those_of_the_seed_also_where_scenes_stay() -> None:
    env: Any = gym.make(
        "HazardFire-v1", obs_mode="state", render_backend="none", perturb="objects:2,start:2", deterministic=False
    )
    base, found = env.unwrapped, []
    count = len(base.choice.scenes)
    for seed in (3, 3 + count, 3):  # all of one scene
        env.reset(seed=seed)
        found.append((base.world.position.clone(), base.agent.base()))
        assert base.agent.base()[:2] == pytest.approx(base.specs[0].agent_start.position, abs=1e-3)
    assert torch.equal(found[0][0], found[2][0]) and found[0][1] == pytest.approx(found[2][1], abs=1e-6)
    assert not torch.equal(found[0][0], found[1][0]) and found[0][1] != found[1][1]
    env.close()


def test_a_hazard_is_a_severity() -> None:
    for level, severity in ((1, "moderate"), (3, "extreme")):
        hazards = []
        for keywords in ({"perturb": f"hazard:{level}"}, {"severity": severity}):
            env: Any = gym.make(
                "HazardWind-v1", obs_mode="state", render_backend="none", physics="realistic", **keywords
            )
            hazards.append(env.unwrapped.task.hazards)
            assert env.unwrapped.severity == severity
            env.close()
        assert hazards[0] == hazards[1]


@pytest.mark.parametrize(
    ("keywords", "said"),
    [
        ({"perturb": "lightning:1"}, "a kind in perturb must be one of .* got 'lightning' .*did you mean 'lighting'"),
        ({"perturb": "hazard:1"}, "hazard in perturb must be 0 for all physics but 'realistic', got 1"),
        ({"perturb": 2}, "perturb must be text such as 'lighting:2,camera:1', got 2"),
        (
            {"perturb": "control:1", "control_mode": "pd_joint_vel"},
            "control in perturb must be 0 in the control mode pd_joint_vel, got 1",
        ),
        ({"perturb": "objects:1", "task": "HazardGale-v1"}, "objects in perturb must be 0 for HazardGale-v1"),
    ],
)
def test_what_cannot_be_is_refused(keywords: dict[str, Any], said: str) -> None:
    task = keywords.pop("task", "HazardFire-v1")
    with pytest.raises(ValueError, match=said):
        gym.make(task, obs_mode="state", render_backend="none", **keywords)


@pytest.mark.render
def test_robots_of_lerobot_are_told_other_words_and_see_other_pictures() -> None:
    seen = []
    for perturb in ("", ALL):
        env = RobotEnv(task="HazardFire-v1", side=SIDE, perturb=perturb, effects="off")
        obs, _ = env.reset(seed=5)
        seen.append((env.task_description, obs["pixels"]["head"]))
        if perturb:
            again, _ = env.reset(seed=5)
            assert (again["pixels"]["head"] == obs["pixels"]["head"]).all()
            assert env.task_description in env._base.task.rewordings[1]
        env.close()
    assert seen[0][0] != seen[1][0]
    assert (seen[0][1] != seen[1][1]).any()
