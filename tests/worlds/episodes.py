"""Hashes of whole episodes; run as a program by the determinism tests, in a process of its own."""

from __future__ import annotations

import argparse
import hashlib
import json
from typing import Any

import gymnasium as gym
import numpy as np
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.spec.registry.robots import robot_class


def feed(digest: Any, value: Any) -> None:
    """Add every number of a nested state to `digest`, bit by bit."""
    if isinstance(value, dict):
        for key in sorted(value):
            digest.update(key.encode())
            feed(digest, value[key])
    else:
        array = value.cpu().numpy() if isinstance(value, torch.Tensor) else np.asarray(value)
        digest.update(np.ascontiguousarray(array).tobytes())


def made(env_id: str, robot: str = "fetch", physics: str = "paper") -> Any:
    """An environment in the control mode in which the robot's own actions are given."""
    return gym.make(
        env_id,
        obs_mode="state",
        render_backend="none",
        physics=physics,
        robot_uids=robot,
        control_mode=robot_class(robot).skill_control_mode,
    )


def actions(env: Any, seed: int, steps: int) -> np.ndarray:
    """A drive through the room: bursts of forward motion and turns, with the arm tucked, into things."""
    rng = np.random.default_rng(seed)
    made = np.zeros((steps, *env.unwrapped.single_action_space.shape), np.float32)
    made[:, :-2] = env.unwrapped.agent.action(0.0, 0.0, env.unwrapped.agent.tucked, True)[:-2]
    made[:, -2:] = np.repeat(rng.uniform(-1, 1, (steps // 20 + 1, 2)), 20, axis=0)[:steps]
    made[:, -2] = np.abs(made[:, -2])
    return made


def episode(env: Any, seed: int, steps: int) -> str:
    """Hash of state, observation and reward of every step."""
    digest = hashlib.sha256()
    obs, _ = env.reset(seed=seed)
    feed(digest, obs)
    for action in actions(env, seed, steps):
        obs, reward, terminated, truncated, _ = env.step(action)
        feed(digest, obs)
        feed(digest, reward)
        feed(digest, env.unwrapped.get_state_dict())
    return digest.hexdigest()


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--env-id", default="HazardFire-v1")
    parser.add_argument("--steps", type=int, default=300)
    parser.add_argument("--physics", default="paper")
    parser.add_argument("--robot", default="fetch")
    parser.add_argument("seeds", type=int, nargs="+")
    args = parser.parse_args()
    torch.set_num_threads(1)
    env = made(args.env_id, args.robot, args.physics)
    print(json.dumps({str(s): episode(env, s, args.steps) for s in args.seeds}))


if __name__ == "__main__":
    main()
