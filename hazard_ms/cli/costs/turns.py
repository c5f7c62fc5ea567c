"""Times frames of several environments in turn in one process, so that whatever else the machine does slows all alike.

Each has its turn in every round; what is kept is the median over rounds. The clock that counts is the processor time of
this process, which other processes hardly change; compare ratios all the same. One torch thread works, as in
`hazard_ms.validation.kernel_costs`.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.cli.costs.frames import Stopwatch

ACTIONS = ("zeros", "random")  # what an environment is given in each of its turns
WARM_UP = 20  # frames before the first turn: caches fill, kernels are compiled [ours]


@dataclass(frozen=True)
class Case:
    """An environment that is measured: its id, its robot, and its preset of physics, empty for ManiSkill's own."""

    env_id: str
    robot: str
    physics: str = ""

    def make(self, **keywords: Any) -> gym.Env:
        """The environment, made with these further keywords of gym.make."""
        if self.physics:
            keywords["physics"] = self.physics
        return gym.make(self.env_id, robot_uids=self.robot, **keywords)


@dataclass(frozen=True)
class Turn:
    """The time of one frame with each kind of ACTIONS [s]: medians over rounds."""

    cpu: Mapping[str, float]
    wall: Mapping[str, float]


@contextlib.contextmanager
def one_thread() -> Iterator[None]:
    """Let torch use one thread within the block."""
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)


def frames_in_turn(
    envs: Mapping[Any, gym.Env], frames: int, rounds: int, seed: int, kinds: tuple[str, ...] = ACTIONS
) -> dict[Any, Turn]:
    """Time of a frame of each of `envs`.

    Each steps `frames` frames with each of the `kinds` of action in each round. Episodes go on from round to round.
    """
    spans: dict[Any, dict[str, list[tuple[float, float]]]] = {name: {kind: [] for kind in kinds} for name in envs}
    for each in range(rounds):
        for name, env in envs.items():
            for kind in kinds:
                spans[name][kind].append(spent(env, actions_of(env, kind, frames, seed + each)))
    found = {}
    for name, rows in spans.items():
        medians = {kind: np.median(row, axis=0) / frames for kind, row in rows.items()}
        found[name] = Turn(
            {kind: float(both[0]) for kind, both in medians.items()},
            {kind: float(both[1]) for kind, both in medians.items()},
        )
    return found


def phases_in_turn(
    envs: Mapping[Any, gym.Env],
    watches: Mapping[Any, Stopwatch],
    frames: int,
    rounds: int,
    seed: int,
    kind: str = "random",
) -> dict[Any, dict[str, float]]:
    """Processor time of a frame with one kind of action by phase [s], as each environment's stopwatch has them.

    "frame" is the whole frame. Stopwatches must run on `time.process_time`.
    """
    rows: dict[Any, list[dict[str, float]]] = {name: [] for name in envs}
    for each in range(rounds):
        for name, env in envs.items():
            watches[name].seconds.clear()
            cpu, _ = spent(env, actions_of(env, kind, frames, seed + each))
            rows[name].append({"frame": cpu, **watches[name].seconds})
    return {
        name: {phase: float(np.median([row[phase] for row in made])) / frames for phase in made[0]}
        for name, made in rows.items()
    }


def actions_of(env: gym.Env, kind: str, frames: int, seed: int) -> NDArray[np.float32]:
    """Actions of one environment for as many frames, [frames, D] [-]: all zeros, or each drawn anew."""
    space: Any = env.unwrapped.single_action_space  # type: ignore[attr-defined]
    if kind == "zeros":
        return np.zeros((frames, *space.shape), np.float32)
    drawn = np.random.default_rng(seed).uniform(space.low, space.high, (frames, *space.shape))
    return np.asarray(drawn, dtype=np.float32)


def spent(env: gym.Env, actions: NDArray[np.float32]) -> tuple[float, float]:
    """Processor time and wall time that the frames of these `actions`, [frames, D] [-], take together [s]."""
    cpu, wall = time.process_time(), time.perf_counter()
    for action in actions:
        env.step(action)
    return time.process_time() - cpu, time.perf_counter() - wall
