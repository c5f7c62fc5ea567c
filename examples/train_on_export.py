"""Behaviour cloning on an export for ManiSkill, with ManiSkill's reader: from recorded frames to a policy that acts.

    hazard-ms demos record -e HazardFire-v1 --agent oracle -n 5 --obs state -o demos
    hazard-ms demos export demos/HazardFire-v1/oracle -f maniskill -o out
    python examples/train_on_export.py out/trajectory.state.pd_joint_pos.physx_cpu.h5

Nothing here knows this package but the name of the environment, which stands in the export: a training script of yours
reads the file in the same way. A network that maps one observation to one action learns the movements, not the rescue:
it forgets what it was doing. `clone_pick_up.py` shows what works at the level of frames, docs/demonstrations.md what
works at the level of decisions.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from mani_skill.trajectory.dataset import ManiSkillTrajectoryDataset
from torch import Tensor, nn

HIDDEN, BATCH, RATE = 256, 256, 3e-4  # as in ManiSkill's own baseline


class Policy(nn.Module):
    """An action for an observation, both scaled to what is usual in the data."""

    def __init__(self, obs: Tensor, action: Tensor) -> None:
        super().__init__()
        for name, data in (("obs", obs), ("action", action)):
            self.register_buffer(f"{name}_mean", data.mean(0))
            self.register_buffer(f"{name}_spread", data.std(0).clamp_min(1e-3))
        sizes = (obs.shape[1], HIDDEN, HIDDEN, action.shape[1])
        layers = [layer for a, b in zip(sizes, sizes[1:], strict=False) for layer in (nn.Linear(a, b), nn.ReLU())]
        self.net = nn.Sequential(*layers[:-1])

    def forward(self, obs: Tensor) -> Tensor:
        scaled = ((obs - self.obs_mean) / self.obs_spread).clamp(-10.0, 10.0)
        return self.net(scaled) * self.action_spread + self.action_mean

    def loss(self, obs: Tensor, action: Tensor) -> Tensor:
        return (((self(obs) - action) / self.action_spread) ** 2).mean()


def load(path: Path) -> tuple[list[tuple[Tensor, Tensor]], dict[str, Any]]:
    """Observations and actions of each episode, and what the environment was made with."""
    data, about = ManiSkillTrajectoryDataset(str(path)), json.loads(path.with_suffix(".json").read_text())
    frames = [(torch.as_tensor(data[n]["obs"]), torch.as_tensor(data[n]["action"])) for n in range(len(data))]
    lengths = [episode["elapsed_steps"] for episode in about["episodes"]]
    ends = np.cumsum([0, *lengths])
    stacked = [torch.stack(part) for part in zip(*frames, strict=True)]
    return [(stacked[0][a:b], stacked[1][a:b]) for a, b in zip(ends, ends[1:], strict=False)], about["env_info"]


def train(episodes: Sequence[tuple[Tensor, Tensor]], steps: int) -> Policy:
    """A policy trained on all episodes but the last, on which its loss is printed."""
    torch.manual_seed(0)
    obs, action = (torch.cat(part) for part in zip(*episodes[:-1], strict=True))
    policy = Policy(obs, action)
    optimiser = torch.optim.Adam(policy.parameters(), RATE)
    for step in range(steps + 1):
        if step % max(1, steps // 5) == 0:
            with torch.no_grad():
                print(f"step {step}: loss {policy.loss(*episodes[-1]):.3f} in an episode that it is not trained on")
        some = torch.randint(len(obs), (BATCH,))
        optimiser.zero_grad()
        policy.loss(obs[some], action[some]).backward()
        optimiser.step()
    return policy


def play(policy: Policy, about: dict[str, Any], frames: int) -> float:
    """The sum of rewards of `frames` in the environment of the export."""
    env = gym.make(about["env_id"], **about["env_kwargs"])
    obs, _ = env.reset(seed=0)
    total = 0.0
    for _ in range(frames):
        with torch.no_grad():
            action = policy(obs)
        obs, reward, *_ = env.step(action.numpy())
        total += float(reward)
    env.close()
    return total


def main(words: Sequence[str] | None = None) -> None:
    """Train on a file, and play."""
    parser = argparse.ArgumentParser(description="Clone the frames of an export for ManiSkill.")
    parser.add_argument("file", type=Path, help="trajectory.state.*.h5, with its .json beside it")
    parser.add_argument("--steps", type=int, default=2000, help="steps of training")
    parser.add_argument("--frames", type=int, default=300, help="frames to play")
    asked = parser.parse_args(words)
    episodes, about = load(asked.file)
    if len(episodes) < 2:
        parser.error(f"the file must hold at least 2 episodes, got {len(episodes)}")
    torch.set_num_threads(1)  # quicker for so small a network
    print(f"{len(episodes)} episodes of {about['env_id']}, {sum(len(obs) for obs, _ in episodes)} frames")
    policy = train(episodes, asked.steps)
    print(f"played {asked.frames} frames: rewards of {play(policy, about, asked.frames):.3f} in all")


if __name__ == "__main__":
    main()
