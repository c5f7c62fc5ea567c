"""Saved states with numbers that no sound simulation has are refused, whole, and change nothing."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments


@pytest.fixture(scope="module")
def base() -> Iterator[Any]:
    env = gym.make("HazardFire-v1", obs_mode="none", render_backend="none")
    env.reset(seed=0)
    yield env.unwrapped
    env.close()


def refused(base: Any, state: Any, words: str) -> None:
    before = base.get_state()
    with pytest.raises(ValueError, match=words):
        base.set_state_dict(state)
    assert torch.equal(base.get_state(), before)


@pytest.mark.parametrize("factor", [0.0, 0.9, 1.1])
def test_rotations_have_length_1(base: Any, factor: float) -> None:
    state = base.get_state_dict()
    name = next(iter(state["actors"]))
    state["actors"][name][:, 3:7] *= factor  # position, rotation, velocities, in ManiSkill's order
    refused(base, state, f"state.actors.{name} must hold a unit quaternion, got one of length")


@pytest.mark.parametrize("number", [float("nan"), float("inf"), -float("inf"), 1e20])
def test_temperatures_are_finite(base: Any, number: float) -> None:
    state = base.get_state_dict()
    state["hazard_ms"]["fire"]["temperature"][0, 0] = number
    refused(base, state, "state.hazard_ms.fire.temperature must hold")
