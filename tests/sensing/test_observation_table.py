"""The table of observations against the observations that live environments give."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.env.interface import actions, describe
from hazard_ms.env.wrappers import plain
from hazard_ms.sensing.observation_table import Row, leaves
from hazard_ms.spec.registry import ROBOTS, TASKS

FRAMES = 60
IMAGES = "rgb+depth+segmentation+position+normal+albedo"
MAY_BE_NAN = ("normal",)  # where the surface has none


def made(task: str, mode: str, robot: str = "fetch", **more: Any) -> Any:
    draws = mode not in ("state", "state_dict", "none")
    small = {"sensor_configs": {"width": 32, "height": 32}} if draws else {"render_backend": "none"}
    return gym.make(task, obs_mode=mode, robot_uids=robot, **small, **more)


def check_rows(observation: Any, rows: list[Row]) -> None:
    """Every number of one environment's observation is described, and in its range."""
    numbers = [np.asarray(value) for _, value in leaves(plain(observation))]
    told = iter(rows)
    for value in numbers:
        width = 0
        while width < value.size:
            row = next(told)
            part = value if row.shape == value.shape else value.reshape(-1)[width : width + int(np.prod(row.shape))]
            width += int(np.prod(row.shape))
            assert row.meaning, f"{row.key} is not described"
            assert str(value.dtype) == row.dtype and part.shape == row.shape, row.key
            low, high = row.bounds()
            bad = (part < low) | (part > high) | (np.isnan(part) & (not row.key.endswith(MAY_BE_NAN)))
            assert not bad.any(), f"{row.key}: {part[bad][:5]} is not in {row.low} to {row.high}"
        assert width == value.size
    assert next(told, None) is None


def play(env: Any, frames: int) -> None:
    """Random actions, full swings of every joint among them; every observation is checked, and is in the space."""
    observation, _ = env.reset(seed=5)
    base = env.unwrapped
    rng = np.random.default_rng(0)
    space = base.single_action_space
    rows = describe(base)["observation"]
    for frame in range(frames):
        check_rows(observation, rows)
        if not any(name in base.obs_mode for name in MAY_BE_NAN):
            assert base.single_observation_space.contains(plain(observation))
        if frame % 10 == 0:
            swing = rng.random(space.shape) < 0.5
        action = np.where(
            rng.random() < 0.7, np.where(swing, space.high, space.low), rng.uniform(space.low, space.high)
        )
        observation, *_ = env.step(action.astype(np.float32))
    env.close()


@pytest.mark.parametrize("robot", list(ROBOTS))
@pytest.mark.parametrize("task", list(TASKS))
def test_states_of_every_task_and_robot(task: str, robot: str) -> None:
    play(made(task, "state" if robot == "fetch" else "state_dict", robot), FRAMES)


@pytest.mark.parametrize("mode", ["pd_joint_target_delta_pos", "pd_ee_target_delta_pose"])
def test_states_of_controllers(mode: str) -> None:
    play(made("HazardFire-v1", "state_dict", control_mode=mode), 10)


@pytest.mark.render
@pytest.mark.parametrize("mode", [IMAGES, "rgb+state", "pointcloud", "sensor_data"])
def test_every_image_mode(mode: str) -> None:
    play(made("HazardCompound-v1", mode), 3)


@pytest.mark.parametrize("physics", ["paper", "realistic"])
@pytest.mark.parametrize("hazards", [("fire",), ("flood",), ("wind",)])
def test_every_entry_of_info_is_described(hazards: tuple[str, ...], physics: str) -> None:
    env = made("HazardCompound-v1", "none", physics=physics, hazards=hazards, affects_agent=True)
    env.reset(seed=0)
    rows = {row.key: row for row in describe(env.unwrapped)["info"]}
    for _ in range(3):
        info = env.step(None)[4]
        assert set(info) == set(rows)
        for key, value in info.items():
            assert rows[key].meaning, f"{key} is not described"
            number = float(value[0])
            assert np.min(rows[key].low) <= number <= np.max(rows[key].high), key
    env.close()


def test_a_row_of_an_unknown_key_has_no_meaning() -> None:
    """So that the tests above fail for an observation that nobody described."""
    env = made("HazardFire-v1", "state_dict")
    observation, _ = env.reset(seed=0)
    table, state = env.unwrapped.observation_table, env.unwrapped._get_obs_state_dict({})
    observation["extra"]["surprise"] = observation["extra"]["held"]
    rows = {row.key: row for row in table.rows(observation, state)}
    assert rows["extra/surprise"].meaning == "" and rows["extra/held"].meaning != ""
    with pytest.raises(AssertionError, match="surprise is not described"):
        check_rows(observation, list(rows.values()))
    env.close()


@pytest.mark.parametrize("robot", list(ROBOTS))
def test_every_number_of_an_action_is_named(robot: str) -> None:
    """In every control mode; the numbers follow each other without a gap."""
    env = made("HazardFire-v1", "none", robot)
    base = env.unwrapped
    for mode in base.agent.supported_control_modes:
        base.agent.set_control_mode(mode)
        end = 0
        for row in actions(base):
            start, _, stop = row.key.partition("]")[0].strip("[").partition(":")
            assert int(start) == end and row.meaning and row.dtype == "float32", (mode, row.key)
            assert len(row.entries) in (0, row.shape[0]) and int(stop) - int(start) == row.shape[0], (mode, row.key)
            end = int(stop)
        assert (end,) == base.agent.single_action_space.shape, mode
    env.close()
