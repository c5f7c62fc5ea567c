"""Reinforcement learning over skills in one file: PPO on hundreds of rescues at once, with nothing but torch.

    python examples/ppo_skills.py                                    # 20 scenes, 300,000 decisions: some minutes
    python examples/ppo_skills.py --scenes 4 --decisions 50000       # a quick look
    python examples/ppo_skills.py --task HazardWind-v1 --reward paper

A decision is the number of an option: fetch target 3, bring it to cart 0, search at landmark 5, look around. The
network sees 545 numbers, and options that cannot be chosen have no chance. `hazard-ms train ppo` learns better, with a
network that treats targets as a set; this is the shortest program that learns anything, in the manner of CleanRL.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence

import gymnasium as gym
import numpy as np
import torch
from torch import Tensor, nn

import hazard_ms  # noqa: F401 registers the environments

RESCUES, STEPS = 128, 32  # rescues at once; decisions of each between two updates
EPOCHS, PARTS = 4, 4  # passes over the decisions of an update; steps of the optimiser in a pass
RATE, CLIP, ENTROPY, WORTH, STEEPEST = 7e-4, 0.2, 0.01, 0.5, 0.5
TRACE = 0.95  # of advantages; nothing is discounted, since what is rescued late counts as much
HIDDEN = 128
FIRST_SCENE = 25  # number of the first generated scene: lower ones belong to the splits of the benchmark


class Network(nn.Module):
    """Logits of the options, and the value that is still to come."""

    def __init__(self, seen: int, options: int) -> None:
        super().__init__()
        self.body = nn.Sequential(nn.Linear(seen, HIDDEN), nn.Tanh(), nn.Linear(HIDDEN, HIDDEN), nn.Tanh())
        self.options, self.worth = nn.Linear(HIDDEN, options), nn.Linear(HIDDEN, 1)

    def forward(self, obs: Tensor, mask: Tensor) -> tuple[torch.distributions.Categorical, Tensor]:
        """The distribution over options and the values [N] at `obs` [N, F]; `mask` [N, A] says what can be chosen."""
        found = self.body(obs)
        logits = self.options(found).masked_fill(~mask, -1e8)
        return torch.distributions.Categorical(logits=logits), self.worth(found)[:, 0]


def advantages(rewards: Tensor, values: Tensor, over: Tensor, last: Tensor) -> Tensor:
    """How much better each decision was than expected, [S, N], from `rewards`, `values` and `over` [S, N].

    `over`: whether the decision was the last of its episode; `last`: values of what followed, [N].
    """
    made, trace, after = torch.zeros_like(rewards), torch.zeros_like(last), last
    for step in reversed(range(len(rewards))):
        goes_on = (~over[step]).float()
        surprise = rewards[step] + goes_on * after - values[step]
        trace = surprise + goes_on * TRACE * trace
        made[step], after = trace, values[step]
    return made


def collect(envs: gym.vector.VectorEnv, network: Network, obs: np.ndarray, mask: np.ndarray) -> tuple:
    """STEPS decisions of each rescue: what a step of learning reads, what is seen now, and the episodes that ended."""
    rows, ended = [], []
    for _ in range(STEPS):
        seen, allowed = torch.from_numpy(obs), torch.from_numpy(mask)
        with torch.no_grad():
            chances, values = network(seen, allowed)
            options = chances.sample()
        obs, rewards, terminated, truncated, info = envs.step(options.numpy())
        mask, over = info["action_mask"], terminated | truncated
        if over.any():
            ended += info["final_info"]["value"][over].tolist()
        reward = torch.from_numpy(rewards.astype(np.float32))
        rows.append((seen, allowed, options, chances.log_prob(options), values, reward, torch.from_numpy(over)))
    with torch.no_grad():
        last = network(torch.from_numpy(obs), torch.from_numpy(mask))[1]
    parts = [torch.stack(part) for part in zip(*rows, strict=True)]
    gained = advantages(parts[5], parts[4], parts[6], last)
    made = [part.flatten(0, 1) for part in (*parts[:4], gained, gained + parts[4])]
    return made, obs, mask, ended


def learn(network: Network, optimiser: torch.optim.Optimizer, parts: Sequence[Tensor]) -> None:
    """Go over the decisions of an update EPOCHS times."""
    for _ in range(EPOCHS):
        for some in torch.randperm(len(parts[0])).chunk(PARTS):
            obs, mask, options, before, gained, wanted = (part[some] for part in parts)
            chances, values = network(obs, mask)
            ratio = (chances.log_prob(options) - before).exp()
            gained = (gained - gained.mean()) / (gained.std() + 1e-8)
            policy = -torch.min(ratio * gained, ratio.clamp(1 - CLIP, 1 + CLIP) * gained).mean()
            loss = policy + WORTH * (values - wanted).pow(2).mean() - ENTROPY * chances.entropy().mean()
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(network.parameters(), STEEPEST)
            optimiser.step()


def main(arguments: Sequence[str] | None = None) -> list[float]:
    """Learn, and print the mean Value of the episodes of each update; return these means."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--task", default="HazardFire-v1")
    parser.add_argument("--reward", default="value", choices=["value", "paper"])
    parser.add_argument("--scenes", type=int, default=20)
    parser.add_argument("--decisions", type=int, default=300_000)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args(arguments)
    name, _, version = asked.task.rpartition("-v")
    envs = gym.make_vec(
        f"hazard_ms:{name}Skills-v{version}",
        num_envs=RESCUES,
        backend="sketch",
        reward=asked.reward,
        stop=False,  # or an untrained policy ends its episodes at once
        generated=(FIRST_SCENE, asked.scenes),
    )
    torch.manual_seed(asked.seed)
    seen, options = envs.single_observation_space.shape[0], int(envs.single_action_space.n)
    network = Network(seen, options)
    optimiser = torch.optim.Adam(network.parameters(), RATE, eps=1e-5)
    obs, info = envs.reset(seed=asked.seed)
    mask, means, start = info["action_mask"], list[float](), time.monotonic()
    for update in range(1, 1 + max(1, asked.decisions // (RESCUES * STEPS))):
        parts, obs, mask, ended = collect(envs, network, obs, mask)
        learn(network, optimiser, parts)
        means.append(float(np.mean(ended)) if ended else 0.0)
        rate = update * RESCUES * STEPS / (time.monotonic() - start)
        print(f"{update * RESCUES * STEPS:9,} decisions, {rate:6,.0f}/s, mean Value {means[-1]:.3f} of {len(ended)}")
    envs.close()
    return means


if __name__ == "__main__":
    main()
