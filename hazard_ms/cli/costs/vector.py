"""Measures how many frames a second environments in processes play, for `hazard-ms bench --vector`.

Sets of environments of several sizes play by turns in one run, each for a moment at a time, and the fastest turns
count: what else runs on the machine takes from all of them alike. Processor time for a frame, of all processes of a set
and of the one that asks them, says what they cost each other.
"""

from __future__ import annotations

import time
from contextlib import ExitStack
from functools import partial
from typing import Any

import gymnasium as gym
import numpy as np

from hazard_ms.evaluation.options import EnvOptions
from hazard_ms.evaluation.report import machine_line
from hazard_ms.learning.vector import make
from hazard_ms.learning.vector.playing import single
from hazard_ms.machine.activity import processor_seconds
from hazard_ms.machine.cores import cores
from hazard_ms.spec.checks import whole

TURN = 20  # frames of a turn [ours]
MOST = 10**6  # frames to average over [ours]
KEYWORDS: dict[str, Any] = {"obs_mode": "state", "render_backend": "none"}


class Turns:
    """The turns of one vector environment."""

    def __init__(self, envs: Any, processes: int, seed: int) -> None:
        """Begin episodes of `envs`, and play a turn that does not count."""
        self.num_envs, self.processes, self._envs = envs.num_envs, processes, envs
        self._chance = np.random.default_rng(seed)
        self.spans: list[float] = []  # wall time of each turn [s]
        self.spent = 0.0  # processor time of all turns [s]
        envs.reset(seed=seed)
        self.play()
        self.spans, self.spent = [], 0.0

    def play(self) -> None:
        """Play a turn under random motion of the base."""
        actions = np.zeros((TURN, *self._envs.action_space.shape), np.float32)
        actions[..., -2:] = self._chance.uniform(-1, 1, actions[..., -2:].shape)
        spent, start = self._spent(), time.perf_counter()
        for action in actions:
            self._envs.step(action)
        self.spans.append(time.perf_counter() - start)
        self.spent += self._spent() - spent

    def _spent(self) -> float:
        return time.process_time() + sum(map(processor_seconds, self._envs.pids))

    @property
    def rate(self) -> float:
        """Frames per second of all environments together in the fastest turn."""
        return self.num_envs * TURN / min(self.spans)

    @property
    def cost(self) -> float:
        """Processor time per frame [s]."""
        return self.spent / (self.num_envs * TURN * len(self.spans))


def measure(env_id: str, frames: int, seed: int, sizes: list[tuple[int, int]]) -> list[Turns]:
    """Let vector environments play by turns, `frames` each; `sizes`: environments and processes of each of them."""
    with ExitStack() as stack:
        made = []
        for num_envs, processes in sizes:
            envs = make(env_id, num_envs, processes=processes, sim_backend="cpu", **KEYWORDS)
            stack.callback(envs.close)
            made.append(Turns(envs, processes, seed))
        for _ in range(-(-frames // TURN)):
            for turns in made:
                turns.play()
        return made


def alone(env_id: str, frames: int, seed: int) -> tuple[float, float]:
    """Frames per second in the fastest turn of one environment in this process, and processor time per frame [s]."""
    import torch

    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    envs = gym.vector.SyncVectorEnv([partial(single, env_id, KEYWORDS)])
    envs.pids = ()  # type: ignore[attr-defined]
    turns = Turns(envs, 0, seed)
    for _ in range(-(-frames // TURN)):
        turns.play()
    envs.close()
    torch.set_num_threads(threads)
    return turns.rate, turns.cost


def report(env_id: str, frames: int, seed: int) -> str:
    """The table that `hazard-ms bench --vector` prints. Raises ValueError for unknown names and too few frames."""
    EnvOptions(env_id).check()
    whole(frames, TURN, MOST, "frames")
    most = cores()
    made = measure(env_id, frames, seed, [(1, 1), (most, most), (4 * most, most)])
    lines = [machine_line(), "", "environments processes   frames/s      times   processor ms/frame"]
    for turns in made:
        times = turns.rate / made[0].rate
        lines.append(
            f"{turns.num_envs:12d} {turns.processes:9d} {turns.rate:10.0f} {times:10.2f} {1e3 * turns.cost:20.2f}"
        )
    rate, cost = alone(env_id, frames, seed)
    lines.append(f"{1:12d} {'none':>9s} {rate:10.0f} {rate / made[0].rate:10.2f} {1e3 * cost:20.2f}")
    return "\n".join(lines)
