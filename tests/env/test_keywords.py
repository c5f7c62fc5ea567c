"""Wrong keywords of gym.make and wrong options of a reset: what is said about them, and that it is said at once."""

from __future__ import annotations

import re
import time
from typing import Any

import gymnasium as gym
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments


def make(**keywords: Any) -> Any:
    return gym.make("HazardFire-v1", **{"obs_mode": "state", "render_backend": "none", **keywords})


WRONG = {
    "keyword": (
        {"phisics": "paper"},
        "keyword of gym.make must be one of .*physics.*, got .phisics. .did you mean .phy",
    ),
    "ours": ({"scene_evry": 2}, "did you mean 'scene_every'"),
    "preset": (
        {"physics": "papr"},
        "physics must be one of paper, shipped, realistic, got 'papr' .did you mean 'paper'",
    ),
    "flag": ({"deterministic": 1}, "deterministic must be True or False, got 1"),
    "turns": ({"scene_every": -1}, "scene_every must be a whole number from 0 to .*, got -1"),
    "control": (
        {"control_mode": "pd_joint_poss"},
        "control_mode must be one of .*, got .*did you mean .pd_j",
    ),
    "robot": ({"robot_uids": "fetsh"}, "robot_uids must be one of fetch, g1, got 'fetsh' .did you mean 'fetch'"),
    "robots": ({"robot_uids": ("fetch",) * 5}, "robot_uids must be at most 4 robots, got 5"),
    "small": (
        {"sensor_configs": {"height": 8}},
        "height in sensor_configs must be a whole number from 16 .* got 8",
    ),
    "head": ({"sensor_configs": {"head": {"width": 15}}}, "width in sensor_configs must be .*, got 15"),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_keywords_are_named_with_what_is_allowed(case: str) -> None:
    keywords, said = WRONG[case]
    with pytest.raises(ValueError, match=said):
        make(**keywords)


def test_what_can_be_known_before_building_is_refused_before() -> None:
    for case in ("keyword", "robot", "small"):
        start = time.process_time()
        with pytest.raises(ValueError):
            make(**WRONG[case][0])
        assert time.process_time() - start < 0.2  # to build a scene takes 0.5 s and more


@pytest.mark.skipif(torch.cuda.is_available(), reason="a GPU runs several environments in one batch")
def test_several_environments_without_a_gpu_are_told_how() -> None:
    with pytest.raises(ValueError, match="num_envs must be 1 without a CUDA GPU, got 4") as error:
        make(num_envs=4)
    assert str(error.value).endswith("hazard_ms.vector.make(..., num_envs=4)")


@pytest.mark.parametrize("robot", ["fetch", "hazard_fetch", ("fetch",), ("hazard_fetch",), ["fetch"]])
def test_a_robot_may_be_called_as_in_maniskill(robot: Any) -> None:
    env = make(robot_uids=robot)
    assert env.unwrapped.agent.uid == "hazard_fetch"
    env.close()


def test_a_window_without_a_display_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(ValueError, match="render_mode must be one of rgb_array, sensors, all without a display"):
        make(render_mode="human")


def test_without_a_renderer_no_picture_is_offered() -> None:
    env = make(render_mode="rgb_array")  # as ManiSkill's replay_trajectory makes every environment
    env.reset(seed=0)
    assert env.metadata["render_modes"] == []
    with pytest.raises(ValueError, match="render_backend must be auto, gpu or cpu for render.., got none"):
        env.render()
    env.close()


def test_a_wrong_scene_is_told_the_nearest_few() -> None:
    env = make()
    with pytest.raises(ValueError) as error:
        env.reset(options={"scene": "kitchen_a/77"})
    named = re.findall(r"\w+/\d\d", str(error.value).split(", got")[0])
    assert 1 <= len(named) <= 5 and "kitchen_a/07" in named
    assert "got 'kitchen_a/77'" in str(error.value) and "hazard-ms scenes list" in str(error.value)
    env.close()


@pytest.mark.render
def test_cameras_of_any_size_show_the_hazard() -> None:
    env = gym.make("HazardFire-v1", obs_mode="rgb+depth", sensor_configs={"width": 40, "height": 24})
    seen = env.reset(seed=0)[0]["sensor_data"]["head"]
    assert seen["rgb"].shape == (1, 24, 40, 3) and seen["hazard"].shape == (1, 24, 40, 1)
    env.close()


def test_another_default_type_of_numbers_is_refused() -> None:
    torch.set_default_dtype(torch.float64)
    try:
        with pytest.raises(ValueError, match="must be torch.float32, got torch.float64"):
            gym.make("HazardFire-v1", render_backend="none")
    finally:
        torch.set_default_dtype(torch.float32)
