"""Rooms for practice, and robots and things that are put where a test wants them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import torch

HERE = (3.5, 3.0)  # in the middle of the room [m]


def made(task: str) -> Iterator[Any]:
    env = gym.make(task, obs_mode="state_dict", render_backend="none", reward_mode="dense", deterministic=False)
    env.reset(seed=0)
    yield env
    env.close()


def stand(base: Any, x: float, y: float, heading: float) -> None:
    base.agent.place(torch.tensor([0]), torch.tensor([[x, y]]), torch.tensor([heading]))
    base.episode.see(base.agent)


def reward(base: Any) -> float:
    return float(base.compute_dense_reward(None, None, base.get_info()))


def alone(base: Any, gap: float) -> Any:
    """One target, `gap` [m] above the hand; the others far away. Returns its index along B."""
    hand, world = base.agent.gripper_pose()[0][0], base.world
    thing = world.target[0].nonzero()[0, 0]
    world.position[0, world.target[0]] += 50.0
    world.position[0, thing] = hand + torch.tensor([0.0, 0.0, gap]) + world.extent[0, thing] * torch.tensor([0, 0, 0.5])
    return thing
