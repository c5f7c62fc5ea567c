"""Plays the hazards of a batch on a GPU without a simulator, by torch and Warp alone: no PhysX is needed."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Sequence
from typing import Any

import torch

from results.gpu.comparison import CHECKED, Course, differences_table, records
from results.gpu.rates import FRAMES, WARM_UP, Rate, memory, pace, settle
from results.gpu.resting import Batch
from results.gpu.waits import FRAMES as COUNTED
from results.gpu.waits import counted

COMPARED = 64  # environments of the batches that are compared [ours]
DEVICES = {"gpu": "cuda", "cpu": "cpu"}  # as torch calls them


def laws(env_id: str, physics: str, sizes: Sequence[int], simulator: str, seed: int = 0) -> dict[str, Any]:
    """Measure and compare the hazards of a task: all as JSON can hold it.

    rates: the fields of a Rate for each number of environments in `sizes`, up to the first that exhausts the memory,
    which is too_many, None if none does;
    differences: by title, the table of the differences of COMPARED environments on `simulator` from others; waits: by
    place, how often in a frame the host waits for the GPU [-], as torch warns of it.
    """
    here = course(env_id, COMPARED, simulator, physics, seed=seed)
    others = {f"{simulator} and cpu": "cpu", f"{simulator} twice": simulator}
    differences = {
        title: differences_table(here, course(env_id, COMPARED, other, physics, seed=seed))
        for title, other in others.items()
    }
    places = waits(env_id, COMPARED, simulator, physics, seed)
    rates, too_many = [], None
    for size in sizes:
        try:
            rates.append(dataclasses.asdict(rate(env_id, size, simulator, physics, seed=seed)))
        except torch.OutOfMemoryError:
            too_many = size
            break
    return {"rates": rates, "too_many": too_many, "differences": differences, "waits": places}


def rate(env_id: str, num_envs: int, simulator: str, physics: str, frames: int = FRAMES, seed: int = 0) -> Rate:
    """The rate at which a batch (see `Batch`) goes on. Raises what torch raises where the memory is exhausted."""
    begun = time.perf_counter()
    batch = Batch(env_id, num_envs, DEVICES[simulator], physics, seed)
    settle()
    start = time.perf_counter() - begun
    return Rate(num_envs, pace([batch.step] * (WARM_UP + frames)), start, memory())


def course(
    env_id: str, num_envs: int, simulator: str, physics: str, checked: Sequence[int] = CHECKED, seed: int = 0
) -> Course:
    """Record the hazards of a batch after as many frames as `checked` has.

    Arrays have their own shapes, [...], in the units that the names of quantities have.
    """
    batch = Batch(env_id, num_envs, DEVICES[simulator], physics, seed)
    made: Course = {}
    for frame in range(max(checked) + 1):
        if frame in checked:
            made.update({f"{frame}/{name}": numbers for name, numbers in _told(batch).items()})
        batch.step()
    return made


def _told(batch: Batch) -> Course:
    """All that hazards and damage keep, and the last forces and torques, [...] each."""
    pushed = {"forces [N]": batch.handles.force, "torques [N m]": batch.handles.torque}
    return {**records(batch.episode), **{name: numbers.cpu().numpy().copy() for name, numbers in pushed.items()}}


def waits(env_id: str, num_envs: int, simulator: str, physics: str, seed: int = 0) -> dict[str, float]:
    """Waits of the host for the GPU in a frame of a batch [-], by place, as torch warns of them."""
    batch = Batch(env_id, num_envs, DEVICES[simulator], physics, seed)
    for _ in range(WARM_UP):
        batch.step()
    with counted() as places:
        for _ in range(COUNTED):
            batch.step()
    return {place: count / COUNTED for place, count in places.most_common()}
