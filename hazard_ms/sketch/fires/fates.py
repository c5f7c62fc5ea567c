"""Fates of targets in rescues in which fires are put out: what is damaged when, how hot it is, and what is averted."""

from __future__ import annotations

import numpy as np

from hazard_ms.sketch.rescues.scene import Floats, Ints, Stack
from hazard_ms.sketch.rescues.state import Rescues
from hazard_ms.sketch.timeline import STRIDE
from hazard_ms.spec.catalogue import DAMAGED_SHARE


def damaged_at(stack: Stack, state: Rescues, rows: Ints) -> Ints:
    """The frame in which each target of `rows` [R] is damaged if nobody takes it away or acts any more, [R, T].

    -1: never. What has damaged it before a fire was put out stays.
    """
    scene = state.scene[rows]
    if not stack.measures:
        return np.asarray(stack.damaged_at[scene], np.int64)
    hit, out = stack.hit_at[scene], state.out_at[rows][:, :, None]
    some = np.where((hit >= 0) & ((out < 0) | (hit <= out)), hit, np.iinfo(np.int64).max)
    first = some.min(axis=1, initial=np.iinfo(np.int64).max)
    return np.where(first == np.iinfo(np.int64).max, -1, first)


def levels_at(stack: Stack, state: Rescues, rows: Ints, target: Ints, frame: Ints) -> Floats:
    """Levels of the hazards at one `target` [R] of each of `rows` [R] at `frame` [R], in their units, [R, H]."""
    scene, last = state.scene[rows], stack.level.shape[1] - 1
    sample = np.minimum(frame // STRIDE, last)
    made = np.array(stack.level[scene, sample, target], np.float64)
    if stack.measures:
        alone = stack.fire_level[scene, np.minimum(frame // STRIDE, stack.fire_level.shape[1] - 1), :, target]
        burns = (state.out_at[rows] < 0) & stack.fire_there[scene]
        cold = stack.level[scene, 0, target].min(axis=-1)
        hottest = np.where(burns, alone, -np.inf).max(axis=1, initial=-np.inf)
        put_out = (state.out_at[rows] >= 0).any(axis=1)
        made[:, 0] = np.where(put_out, np.minimum(made[:, 0], np.maximum(hottest, cold)), made[:, 0])
    return made


def averted(stack: Stack, state: Rescues) -> Floats:
    """The share averted so far of what would be lost if nobody acted, if nobody acts any more, [N].

    It is 0 where nothing would be lost. At the end of an episode it is the score of docs/benchmark.md 4.3.
    """
    rows, targets = np.arange(len(state.frame)), np.arange(state.value.shape[1])
    alone = (stack.hit_at[state.scene] >= 0).any(axis=1)
    away = (state.rescued_at >= 0) | (targets == state.held[:, None])
    lost = np.where(away, state.spoiled, damaged_at(stack, state, rows) >= 0)
    before, now = ((1.0 - DAMAGED_SHARE) * (state.value * part).sum(axis=1) for part in (alone, lost))
    return np.where(before > 0.0, (before - now) / np.maximum(before, 1e-9), 0.0)
