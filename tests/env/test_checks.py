"""Checks of numbers and names at their limits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms.spec import checks

MODES = {"pd_joint_pos": 3, "pd_ee_delta_pos": 2}


def action(value: Any, num_envs: int = 1) -> Any:
    return checks.action(value, num_envs, "pd_joint_pos", MODES.__getitem__, MODES)


@pytest.mark.parametrize("value", [0, 2**32 - 1, np.uint32(7), np.array(3), [5], (5, 6), np.array([5, 6])], ids=str)
def test_seeds_from_0_to_the_last_of_numpy_s(value: Any) -> None:
    assert np.array_equal(checks.seeds(value, 2), value)


@pytest.mark.parametrize("value", [2**32, -1, True, 1.0, "1", [1, 2, 3], [], [True], [2**32], np.array(True)], ids=str)
def test_other_seeds_are_refused(value: Any) -> None:
    with pytest.raises(ValueError, match="seed must"):
        checks.seeds(value, 2)


def test_reset_options_of_other_tools_are_ignored_and_errors_in_names_are_not() -> None:
    """lerobot-eval gives its own to every environment."""
    assert checks.options({"lerobot_new_rollout": True, "scene": "kitchen_a/00"}, 1) == {"scene": "kitchen_a/00"}
    for wrong in ("lerobot_rollout", "scenes", "Lerobot_new_rollout", "_scene"):
        with pytest.raises(ValueError, match=f"a reset option must be one of .*got '{wrong}'"):
            checks.options({wrong: True}, 1)


def test_a_name_with_an_error_is_refused_with_the_one_that_was_meant() -> None:
    with pytest.raises(
        ValueError, match=r"task must be one of fire, flood, wind, got 'flod' \(did you mean 'flood'\?\)"
    ):
        checks.one_of("flod", ["fire", "flood", "wind"], "task")
    with pytest.raises(ValueError, match=r"one of 30 names such as .*scene_7.*; `scenes list` prints all"):
        checks.one_of("scene_77", [f"scene_{k}" for k in range(30)], "scene", "`scenes list` prints all")


@pytest.mark.parametrize("number", [1e39, -1e300, float("inf"), float("nan")])
def test_what_is_not_finite_in_float32_is_no_action(number: float) -> None:
    with pytest.raises(ValueError, match="action must hold numbers that are finite in float32"):
        action(np.array([0.0, number, 0.0]))
    assert action(np.array([0.0, 3e38, 0.0])).isfinite().all()


@pytest.mark.parametrize("shape", [(2,), (4,), (2, 3), (1, 1, 3), ()])
def test_actions_have_the_shape_of_their_control_mode(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=r"action must have shape \(1, 3\) or \(3,\) in control mode 'pd_joint_pos'"):
        action(np.zeros(shape))
    assert action(torch.zeros(3)).shape == (1, 3) and action(torch.zeros(4, 3), num_envs=4).shape == (4, 3)


def test_the_action_in_a_dict_has_the_shape_of_its_own_mode() -> None:
    given = action({"control_mode": "pd_ee_delta_pos", "action": np.zeros(2)})
    assert given["control_mode"] == "pd_ee_delta_pos" and given["action"].shape == (1, 2)
    for bad, words in (
        ({"control_mode": "pd_ee_delta_pos", "action": np.zeros(3)}, "in control mode 'pd_ee_delta_pos', got"),
        ({"control_mode": "pd_ee_delta_pos", "action": "forward"}, "action must be a numpy array or a torch tensor"),
        ({"control_mode": "fly", "action": np.zeros(3)}, "control_mode must be one of"),
        ({"control_mode": "pd_joint_pos"}, "an action dict must have control_mode and action"),
    ):
        with pytest.raises(ValueError, match=words):
            action(bad)
