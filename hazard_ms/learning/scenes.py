"""Scenes to learn in, made by several processes."""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import torch
from tqdm import tqdm

from hazard_ms.machine.cores import cores
from hazard_ms.machine.processes import end_with_parent, without_keys
from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.sketch.scenes import more_scenes

FEWEST = 8  # scenes that are worth the start of a process, which takes some seconds [ours]


def generated(env_id: str, physics: str, numbers: Sequence[int], workers: int = 0) -> list[SketchScene]:
    """The scenes with these `numbers`, which belong to no split: see `hazard_ms.sketch.scenes.more_scenes`.

    `workers`: number of processes at most; 0: one for each processor.

    Raises ValueError for unknown names, and for numbers of scenes that belong to a split.
    """
    make, most = partial(_scene, env_id, physics), min(workers or cores(), len(numbers) // FEWEST)
    if most <= 1:
        return list(_watched(map(make, numbers), len(numbers)))
    spawned = multiprocessing.get_context("spawn")  # forks of a process that runs torch can stand still
    with without_keys(), ProcessPoolExecutor(most, spawned, initializer=_begin) as pool:
        return list(_watched(pool.map(make, numbers), len(numbers)))


def _begin() -> None:
    """Begin a process of those that make scenes: one for each core, so each with one thread."""
    end_with_parent()
    torch.set_num_threads(1)


def _scene(env_id: str, physics: str, number: int) -> SketchScene:
    return more_scenes(env_id, physics, number, 1)[0]


def _watched(made: Iterator[SketchScene], count: int) -> Iterator[SketchScene]:
    return iter(tqdm(made, "scenes", count, unit="scene"))
