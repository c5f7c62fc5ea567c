"""200 scenes per hazard, 300 frames each, with a robot that drives about: nothing breaks, and what must not go
backwards does not.
"""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.hazards.flood.realistic.floor_plan import CELL
from hazard_ms.hazards.flood.realistic.inundation_state import InundationState
from hazard_ms.scenes import splits

pytestmark = [pytest.mark.long, pytest.mark.timeout(3600)]

SCENES, FRAMES = 200, 300
ENCLOSED = 0.3  # how far the middle of a body may press into the walls of its world [m]


def names(family: str) -> list[str]:
    every = splits.all_scene_names(family)
    return [every[k % len(every)] for k in range(SCENES)]


@pytest.mark.parametrize("env_id", ["HazardFire-v1", "HazardFlood-v1", "HazardWind-v1"])
@pytest.mark.parametrize("half", [0, 1])
def test_nothing_breaks_in_many_scenes(env_id: str, half: int) -> None:
    env = gym.make(env_id, obs_mode="state", render_backend="none", physics="paper" if half else "realistic")
    base: Any = env.unwrapped
    for number, name in enumerate(names("outdoor" if env_id == "HazardWind-v1" else "indoor")):
        if number % 2 != half:
            continue
        obs, _ = env.reset(seed=number, options={"scene": name})
        env.action_space.seed(number)
        world, state = base.world, next(iter(base.episode.states.values()))
        before = None
        for frame in range(FRAMES):
            obs, reward, _, truncated, info = env.step(env.action_space.sample())
            assert not bool(truncated) and not bool(info["sim_error"]), (name, frame)
            now = _progress(env_id, state)
            assert before is None or bool((now >= before - 1e-6).all()), (name, frame)
            before = now.clone()
        assert bool(torch.isfinite(torch.as_tensor(obs)).all()) and bool(
            torch.isfinite(torch.as_tensor(reward)).all()
        ), name
        room = base.specs[0].room
        place = world.position[0][(world.exists & world.movable & ~world.away & ~world.held)[0]]
        low, high = -room.beyond - ENCLOSED, torch.tensor(room.size) + room.beyond + ENCLOSED
        assert (
            bool((place[:, :2] > low).all())
            and bool((place[:, :2] < high).all())
            and bool((place[:, 2] > -ENCLOSED).all())
        ), name
    env.close()


def _progress(env_id: str, state: Any) -> torch.Tensor:
    """What never falls: how far things have burned, the level of the water or all of it, what lies settled in carts."""
    if env_id == "HazardFire-v1":
        return state.status
    if isinstance(state, InundationState):
        held = CELL**2 * state.depth.double().sum(-1)
        assert float((held - state.inflow).abs()) <= 1e-4 * float(state.inflow)  # the sum of some 4,000 floats
        return state.inflow
    return state.level if env_id == "HazardFlood-v1" else state.settled.long()
