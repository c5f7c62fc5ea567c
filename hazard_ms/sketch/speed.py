"""Measures how many decisions a second the sketch makes, for `hazard-ms sketch speed`."""

from __future__ import annotations

import platform
import time
from collections.abc import Sequence

import numpy as np
import torch

from hazard_ms.sketch.environments.batch import SketchBatch
from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.sketch.skill_times import SkillTimes
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.choices import ACTIONS
from hazard_ms.skills.options.options import END, FIRST

COUNTS = (1, 16, 256)  # rescues at once
WANTED = {1: 1_000, 256: 20_000}  # decisions a second that are required of one idle core
MANY = 64  # rescues at once in a vector environment, as in training
DECISIONS = 1_000  # of a measurement with few rescues [ours]
FEWEST_STEPS = 50  # of one with many [ours]
PARTS = 5  # of a measurement, of which the fastest counts: other work on the machine slows the others [ours]


def report(scenes: Sequence[SketchScene], times: SkillTimes, ranges: Sequence[tuple[float, float]]) -> str:
    """A table of decisions a second of processor time in `scenes`, at random, one thread.

    `ranges`: ends of each hazard's usual level, in its unit.
    """
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        found = {count: decisions_a_second(scenes, times, count) for count in COUNTS}
        seen = {name: environment_decisions_a_second(scenes, times, ranges, name) for name in ACTIONS}
    finally:
        torch.set_num_threads(threads)
    lines = [f"{len(scenes)} scenes, random options, one thread, best of {PARTS} parts, {platform.machine()}"]
    for count, rate in found.items():
        wanted = f"   required: {WANTED[count]:,}" if count in WANTED else ""
        lines.append(f"  {count:4d} rescues at once {rate:10,.0f} decisions/s{wanted}")
    for name, rate in seen.items():
        lines.append(f"  {MANY:4d} in a vector environment, actions {name:8} {rate:8,.0f} decisions/s")
    return "\n".join(lines)


def environment_decisions_a_second(
    scenes: Sequence[SketchScene], times: SkillTimes, ranges: Sequence[tuple[float, float]], actions: str
) -> float:
    """Decisions a second of processor time of the vector environment, with what learners see, `actions` at random.

    `ranges`: ends of each hazard's usual level, in its unit. Raises ValueError for unknown actions.
    """
    envs, chance = SketchBatch(scenes, ranges, times, MANY, stop=False, actions=actions), np.random.default_rng(0)
    envs.reset(seed=0)
    steps, rates = max(FEWEST_STEPS, DECISIONS // MANY) // PARTS, []
    for _ in range(PARTS):
        start = time.process_time()
        for _ in range(steps):
            mask = envs.action_masks()
            envs.step((chance.random(mask.shape) * mask).argmax(axis=1))
        rates.append(MANY * steps / (time.process_time() - start))
    return max(rates)


def decisions_a_second(scenes: Sequence[SketchScene], times: SkillTimes, count: int) -> float:
    """Decisions of `count` rescues at once in a second of processor time; episodes that end are begun anew."""
    sketch, chance = Sketch(scenes, times, count), np.random.default_rng(0)
    seeds = np.arange(count)
    sketch.reset(seeds % len(scenes), seeds)
    steps = max(FEWEST_STEPS, DECISIONS // count) // PARTS
    rates = []
    for _ in range(PARTS):
        start = time.process_time()
        for _ in range(steps):
            liking = chance.random(sketch.mask.shape) * sketch.mask
            liking[:, FIRST[END]] *= 0.0
            _, over = sketch.step(liking.argmax(axis=1))
            rows = np.flatnonzero(over)
            if len(rows):
                seeds[rows] += count
                sketch.reset(seeds[rows] % len(scenes), seeds[rows], rows)
        rates.append(count * steps / (time.process_time() - start))
    return max(rates)
