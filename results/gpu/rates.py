"""Measures how many frames a second one batch of environments plays, and how that grows with the batch."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import gymnasium as gym
import torch
from torch import Tensor

from hazard_ms.cli.costs.tables import table
from results.gpu.apart import StoppedError

STATE, PICTURES = "state", "rgb+depth+segmentation"
SIDE = 128  # of a square picture [pixels]
WARM_UP, FRAMES = 10, 50  # frames before those that count, and those that count [ours]
GIB = 2**30  # [bytes]
HEADINGS = ("environments", "frames/s", "ms a step", "start [s]", "GPU memory [GiB]")


@dataclass(frozen=True)
class Rate:
    """Time and memory that a batch of `num_envs` environments takes.

    step: wall time of one step of all of them [s]; start: of making and resetting them [s]; memory: in use on the GPU
    after the last frame, by all processes [bytes], None without a GPU.
    """

    num_envs: int
    step: float
    start: float
    memory: int | None

    @property
    def frames_per_second(self) -> float:
        """Frames per second of all environments together."""
        return self.num_envs / self.step


def rate(env_id: str, num_envs: int, obs_mode: str, simulator: str, frames: int = FRAMES, seed: int = 0) -> Rate:
    """The rate of a batch under random motion of the base, simulated and drawn on `simulator`: "gpu" or "cpu".

    Each environment has a scene of its own. Raises what gym.make raises, and what torch and SAPIEN raise where the
    memory is exhausted.
    """
    begun = time.perf_counter()
    env = batch(env_id, num_envs, obs_mode, simulator)
    try:
        env.reset()  # as built: a seed would build other scenes
        actions = motions(env, WARM_UP + frames, seed)
        settle()
        start = time.perf_counter() - begun
        return Rate(num_envs, pace([partial(env.step, action) for action in actions]), start, memory())
    finally:
        env.close()


def pace(steps: Sequence[Callable[[], object]]) -> float:
    """The mean wall time of the `steps` after the first WARM_UP, when the GPU, if there is one, has done them [s]."""
    for step in steps[:WARM_UP]:
        step()
    settle()
    begun = time.perf_counter()
    for step in steps[WARM_UP:]:
        step()
    settle()
    return (time.perf_counter() - begun) / (len(steps) - WARM_UP)


def batch(env_id: str, num_envs: int, obs_mode: str, simulator: str) -> gym.Env:
    """Environments in one batch on `simulator`; where they draw, pictures have SIDE pixels."""
    keywords: dict[str, Any] = {"obs_mode": obs_mode, "sim_backend": simulator, "num_envs": num_envs}
    if obs_mode == STATE:
        return gym.make(env_id, render_backend="none", **keywords)
    size = {"width": SIDE, "height": SIDE}
    return gym.make(env_id, render_backend=simulator, sensor_configs=size, **keywords)


def motions(env: gym.Env, frames: int, seed: int) -> Tensor:
    """Random motion of the bases, [frames, E, D] [-], on the device of the environments; the same on all devices."""
    base: Any = env.unwrapped
    actions = torch.zeros(frames, base.num_envs, *base.single_action_space.shape)
    actions[..., -2:] = 2 * torch.rand(frames, base.num_envs, 2, generator=torch.Generator().manual_seed(seed)) - 1
    return actions.to(base.device)


def settle() -> None:
    """Wait until the GPU, if there is one, has done all that it was given."""
    if torch.cuda.is_available():
        torch.cuda.synchronize()


def memory() -> int | None:
    """Memory in use on the GPU by all processes, that of PhysX and the renderer included [bytes]; None without one."""
    if not torch.cuda.is_available():
        return None
    free, total = torch.cuda.mem_get_info()
    return total - free


def growth(sizes: Iterable[int], measure: Callable[[int], Rate]) -> tuple[list[Rate], StoppedError | None]:
    """The rates that `measure` gives for numbers of environments, up to the first that it cannot measure, and why."""
    made: list[Rate] = []
    for size in sizes:
        try:
            made.append(measure(size))
        except StoppedError as error:
            return made, StoppedError(f"a batch of {size:,}: {error}", error.limit)
    return made, None


def rates_table(rates: Iterable[Rate]) -> str:
    """A row for each number of environments."""
    rows = []
    for r in rates:
        used = "none" if r.memory is None else f"{r.memory / GIB:.1f}"
        rows.append([f"{r.num_envs:,}", f"{r.frames_per_second:,.0f}", f"{1e3 * r.step:.1f}", f"{r.start:.0f}", used])
    return table(HEADINGS, rows, 0)
