"""Reinforcement learning of one motion in one file: PPO moves the robot's joints, with nothing but torch.

    python examples/ppo_low_level.py --task walk_to --minutes 15
    python examples/ppo_low_level.py --task pick_up --minutes 60 --out learned    # learned/pick_up.csv as it learns

Where there is a GPU, 512 robots practise in one batch of tensors; on a CPU, where a process has one environment, two
do in processes of their own. All else is the same. An action is kept for some frames: at thirty actions a second, noise
in each one moves nothing far. The policy, with the mean and variance of what it reads, is learned/pick_up.safetensors.
A run begins anew: nothing is resumed.
"""

from __future__ import annotations

import argparse
import os
import time
from collections import deque
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from gymnasium.vector import AsyncVectorEnv, AutoresetMode
from mani_skill.vector.wrappers.gymnasium import ManiSkillVectorEnv
from safetensors.torch import save_file
from torch import Tensor, nn

from hazard_ms import NumpyEnv

IDS = {"walk_to": "hazard_ms.tasks.practice:HazardWalkTo-v1", "pick_up": "hazard_ms.tasks.practice:HazardPickUp-v1"}
USED = {"walk_to": [11, 12], "pick_up": [*range(8), 11, 12]}  # of an action's 13 numbers: arm and fingers; base
MOST = {"walk_to": [1.0, 0.5], "pick_up": [*[1.0] * 8, 0.5, 0.25]}  # size of each: at 1 a base turns 180 degrees/s
KEPT = {"walk_to": 5, "pick_up": 3}  # frames for which an action is kept
DISCOUNT, TRACE = {"walk_to": 0.97, "pick_up": 0.93}, 0.95  # per action; the latter of advantages
SAMPLES, FEWEST = {"walk_to": 512, "pick_up": 1024}, 16  # actions of all between two updates; of each at least
EPOCHS, PARTS = 8, 8  # passes over the samples of an update; steps of the optimiser in a pass
RATE, LAST_RATE, CLIP, STEEPEST = 4e-4, 1e-4, 0.2, 0.5
SCALE = 20.0  # of rewards, so that what a network has to tell is about 1: hints are small
HIDDEN, SPREAD = 128, 0.6  # width of layers; first standard deviation of actions, whose range is -1 to 1
EPISODES = 100  # of which success and return are averages
ROOM = 8  # episodes of a robot in one room, on a CPU


class Kept(gym.Wrapper):
    """Keeps each action for some frames; what is seen and rewarded is the last one."""

    def __init__(self, env: gym.Env, frames: int) -> None:
        super().__init__(env)
        self.frames = frames

    def step(self, action: Any) -> Any:
        for _ in range(1, self.frames):
            self.unwrapped.advance(action)  # type: ignore[attr-defined]
        return self.env.step(action)


def practice(task: str, split: str, count: int = 0) -> gym.Env:
    """The environment of a task: a batch of `count` robots, or one robot, with numpy's arrays."""
    torch.set_num_threads(1)  # quicker, for networks and environments as small as these
    more = {"obs_mode": "state", "render_backend": "none", "deterministic": False, "scene_every": ROOM}
    env = Kept(gym.make(IDS[task], split=split, num_envs=max(1, count), **more), KEPT[task])
    return env if count else NumpyEnv(env)


class Robots:
    """Robots that practise at the same time, as tensors: in one batch on a GPU, else each in a process."""

    def __init__(self, task: str, split: str, count: int, device: torch.device) -> None:
        self.task, self.count, self.device = task, count, device
        self.most = torch.tensor(MOST[task], device=device)
        self.batched = device.type == "cuda" or count == 1
        one = partial(practice, task, split)
        self.envs: Any = (
            ManiSkillVectorEnv(one(count))
            if self.batched
            else AsyncVectorEnv([one] * count, context="spawn", autoreset_mode=AutoresetMode.SAME_STEP)
        )
        self.size = self.envs.single_action_space.shape[0]

    def reset(self, seed: int) -> Tensor:
        """What is seen first, [N, F]."""
        return self.tensor(self.envs.reset(seed=seed)[0])

    def step(self, used: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor, Tensor]:
        """What is seen then, rewards, who succeeded, whose episode is over, and what was seen last before a reset."""
        action = torch.zeros(self.count, self.size, device=self.device)
        action[:, USED[self.task]] = used.clamp(-1.0, 1.0) * self.most
        obs, reward, done, cut, info = self.envs.step(action if self.batched else action.numpy())
        last = info.get("final_observation", obs)
        if "final_obs" in info:
            last = obs.copy()
            last[info["_final_obs"]] = np.stack(info["final_obs"][info["_final_obs"]])
        done, cut = (torch.as_tensor(part, device=self.device) for part in (done, cut))
        return self.tensor(obs), self.tensor(reward), done, done | cut, self.tensor(last)

    def tensor(self, numbers: Any) -> Tensor:
        """The `numbers` as float32 on the device."""
        return torch.as_tensor(numbers, dtype=torch.float32, device=self.device)


class Policy(nn.Module):
    """Means of actions, their spread, and the reward that is still to come, from what is seen."""

    def __init__(self, seen: int, used: int) -> None:
        super().__init__()
        self.action, self.worth = (
            nn.Sequential(
                *(nn.Linear(seen, HIDDEN), nn.Tanh(), nn.Linear(HIDDEN, HIDDEN), nn.Tanh(), nn.Linear(HIDDEN, said))
            )
            for said in (used, 1)
        )
        nn.init.orthogonal_(self.action[-1].weight, 0.01)  # so that the first actions are noise around none
        self.spread = nn.Parameter(torch.full((used,), SPREAD).log())
        for name, first in (("mean", torch.zeros(seen)), ("variance", torch.ones(seen)), ("count", torch.zeros(()))):
            self.register_buffer(name, first)

    def forward(self, obs: Tensor) -> tuple[torch.distributions.Normal, Tensor]:
        """The distribution of actions, [N, A], and the worth, [N], of what is seen, [N, F]."""
        obs = ((obs - self.mean) / (self.variance + 1e-6).sqrt()).clamp(-5.0, 5.0)
        return torch.distributions.Normal(self.action(obs), self.spread.exp()), self.worth(obs)[:, 0]

    def note(self, obs: Tensor) -> None:
        """Let mean and variance of all that was seen so far take in `obs`, [N, F]."""
        share, off = len(obs) / (self.count + len(obs)), obs.mean(0) - self.mean
        self.variance += share * (obs.var(0, unbiased=False) - self.variance + (1.0 - share) * off**2)
        self.mean += share * off
        self.count += len(obs)


def advantages(rewards: Tensor, values: Tensor, after: Tensor, over: Tensor, discount: float) -> Tensor:
    """How much better each action was than expected, [S, N]; `after`: the worth of what followed, 0 after success."""
    made, trace = torch.zeros_like(rewards), torch.zeros_like(rewards[0])
    for step in reversed(range(len(rewards))):
        surprise = rewards[step] + discount * after[step] - values[step]
        trace = surprise + discount * TRACE * trace * ~over[step]
        made[step] = trace
    return made


@torch.no_grad()
def collect(robots: Robots, policy: Policy, obs: Tensor, sums: Tensor, ends: deque) -> tuple[Tensor, list[Tensor]]:
    """What is seen at the end, and all that an update reads; `ends` get (success, return) of episodes that ended."""
    rows = []
    for _ in range(max(FEWEST, SAMPLES[robots.task] // robots.count)):
        chances, value = policy(obs)
        action = chances.sample()
        new, reward, done, over, last = robots.step(action)
        sums += reward
        ends.extend(zip(done[over].tolist(), sums[over].tolist(), strict=True))
        sums[over] = 0.0
        rows.append(
            (obs, action, chances.log_prob(action).sum(1), value, SCALE * reward, policy(last)[1] * ~done, over)
        )
        obs = new
    seen, action, chance, value, reward, after, over = (torch.stack(part) for part in zip(*rows, strict=True))
    gained = advantages(reward, value, after, over, DISCOUNT[robots.task])
    return obs, [part.flatten(0, 1) for part in (seen, action, chance, gained, gained + value)]


def learn(policy: Policy, optimiser: torch.optim.Optimizer, samples: Sequence[Tensor]) -> None:
    """Go over the samples of an update EPOCHS times."""
    for _ in range(EPOCHS):
        for some in torch.randperm(len(samples[0]), device=samples[0].device).chunk(PARTS):
            obs, action, before, gained, wanted = (part[some] for part in samples)
            chances, values = policy(obs)
            ratio = (chances.log_prob(action).sum(1) - before).exp()
            gained = (gained - gained.mean()) / (gained.std() + 1e-8)
            better = torch.min(ratio * gained, ratio.clamp(1.0 - CLIP, 1.0 + CLIP) * gained).mean()
            optimiser.zero_grad()
            ((values - wanted).pow(2).mean() - better).backward()
            nn.utils.clip_grad_norm_(policy.parameters(), STEEPEST)
            optimiser.step()
    policy.note(samples[0])


def train(robots: Robots, minutes: float, seed: int, out: Path) -> Policy:
    """A policy that has learned for `minutes`; its curve and itself are written into the folder `out`."""
    obs, start, actions = robots.reset(seed), time.monotonic(), 0
    policy = Policy(obs.shape[1], len(USED[robots.task])).to(robots.device)
    optimiser = torch.optim.Adam(policy.parameters(), RATE, eps=1e-5)
    sums, ends = torch.zeros(robots.count, device=robots.device), deque[Any](maxlen=EPISODES)
    curve = out / f"{robots.task}.csv"
    curve.write_text("minutes,frames,success,return,frames_per_second\n")
    while (spent := (time.monotonic() - start) / 60.0) < minutes or not actions:
        optimiser.param_groups[0]["lr"] = RATE + (LAST_RATE - RATE) * spent / max(minutes, spent)
        obs, samples = collect(robots, policy, obs, sums, ends)
        learn(policy, optimiser, samples)
        actions += len(samples[0])
        spent, frames = (time.monotonic() - start) / 60.0, actions * KEPT[robots.task]
        success, gained = np.mean(ends, axis=0) if ends else (0.0, 0.0)
        row = f"{spent:.2f},{frames},{success:.3f},{gained:.4f},{frames / spent / 60.0:.0f}"
        curve.write_text(f"{curve.read_text()}{row}\n")
        print(f"minutes, frames, success, return, frames/s: {row}", flush=True)
        save_file(policy.state_dict(), out / f"{robots.task}.safetensors")
    return policy


def main(words: Sequence[str] | None = None) -> None:
    """Learn, write the curve and the policy, and score it in rooms that it has never seen."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--task", default="walk_to", choices=list(IDS))
    parser.add_argument("--minutes", type=float, default=15.0, help="of learning")
    parser.add_argument("--robots", type=int, help="that practise at once; default: 512 on a GPU, 2 processes on a CPU")
    parser.add_argument("--episodes", type=int, default=50, help="of all robots, to score the policy with")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("learned"), help="folder for curve and policy")
    asked = parser.parse_args(words)
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # of the processes
    torch.set_num_threads(1)
    torch.manual_seed(asked.seed)
    asked.out.mkdir(parents=True, exist_ok=True)
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    count = asked.robots or (512 if device.type == "cuda" else 2)
    robots = Robots(asked.task, "train", count, device)
    policy = train(robots, asked.minutes, asked.seed, asked.out)
    robots.envs.close()
    robots, ends, played = Robots(asked.task, "test", count, device), list[bool](), torch.zeros(count, device=device)
    obs, each = robots.reset(seed=0), -(-asked.episodes // count)  # or those that end soon would count more often
    while (played < each).any():
        with torch.no_grad():
            obs, _, done, over, _ = robots.step(policy(obs)[0].mean)
        ends += done[over & (played < each)].tolist()
        played += over
    robots.envs.close()
    print(f"success in rooms of test, without noise: {np.mean(ends):.1%} of {len(ends)} episodes")


if __name__ == "__main__":
    main()
