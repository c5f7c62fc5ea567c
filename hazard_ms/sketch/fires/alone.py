"""Plays what each fire of a scene would do if it alone burned, without a robot in copies of the episode.

A fire is all seats that begin close to each other on the same side of walls, so that one discharge is for all of them.
The sketch takes what several fires do together as what the first of them does: a thing is damaged when the first of
those that still burn has damaged it. Limits: heat of several fires does not add up, and a thing that one fire has lit
burns on with it alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from hazard_ms.hazards.fire.fire_state import BURNING, FireState
from hazard_ms.simulation import building
from hazard_ms.sketch.futures import seats
from hazard_ms.sketch.futures.interventions import fire_of
from hazard_ms.sketch.futures.surroundings import hidden
from hazard_ms.sketch.recording import begun
from hazard_ms.sketch.timeline import STRIDE
from hazard_ms.spec import SceneSpec, Task

TOGETHER = 2.0  # distance between first flames of one fire [m]: within it `extinguish` puts out all that burns
SOURCE = 900  # frame until which flames appear whose middle is the place of a fire [ours]
SHOWN = 12  # of these flames, evenly spread over them, by any of which a fire is seen [ours]


@dataclass(frozen=True)
class Fires:
    """K fires of a scene with B things over S samples."""

    place: NDArray[np.float64]  # middle of the first flames [m], [K, 2]
    shown: NDArray[np.float64]  # places of some of the first flames [m], [K, SHOWN, 2]
    hit_at: NDArray[np.int64]  # frame in which each fire alone damages each thing, [K, B]; -1: never
    level: NDArray[np.float16]  # of the fire at each thing if that fire alone burns [C], [S, K, B]
    flames: NDArray[np.int64]  # flames and things of each fire that burn at each sample, [S, K]


def fires_alone(task: Task, physics: str, specs: Sequence[SceneSpec], seeds: Sequence[int]) -> list[Fires]:
    """The fires with which the episodes of `seeds` in the scenes `specs` begin, each alone, in one batch.

    Raises ValueError for an unknown preset, and unless there are as many seeds as scenes.
    """
    groups = [_groups(task, physics, spec, seed) for spec, seed in zip(specs, seeds, strict=True)]
    rows = [(k, own) for k, some in enumerate(groups) for own in some]
    world = building.make_world(tuple(specs[k] for k, _ in rows), torch.device("cpu"))
    course = begun(task, physics, world, [seeds[k] for k, _ in rows])
    state = fire_of(course.episode)
    assert state is not None
    for row, (k, own) in enumerate(rows):
        for other in (seat for group in groups[k] if group is not own for seat in group):
            seats.put_out(state, world, row, other)
    hazard = [each is state for each in course.episode.states.values()].index(True)
    levels, burning = [], []
    for frame in range(task.max_frames + 1):
        if frame:
            course.advance(frame)
        if frame % STRIDE == 0:
            levels.append(course.episode.levels(world.position)[:, hazard].cpu().numpy().astype(np.float16))
            lit = (seats.flames(state, world.frame) >= 0).sum(1) + ((state.status == BURNING) & world.exists).sum(1)
            burning.append(lit.cpu().numpy())
    hit, level, flames = course.episode.damage.frame.cpu().numpy(), np.stack(levels), np.stack(burning)
    made = []
    for k, spec in enumerate(specs):
        own_rows, things = [row for row, (scene, _) in enumerate(rows) if scene == k], len(spec.things)
        first = [_first_flames(state, row) for row in own_rows]
        made.append(
            Fires(
                place=np.array([each.mean(axis=0) for each in first]).reshape(-1, 2),
                shown=np.array([_spread(each) for each in first]).reshape(-1, SHOWN, 2),
                hit_at=hit[own_rows, :things].astype(np.int64),
                level=level[:, own_rows, :things],
                flames=flames[:, own_rows].astype(np.int64),
            )
        )
    return made


def _spread(flames: NDArray[np.float64]) -> NDArray[np.float64]:
    """SHOWN of the places `flames` [m], [N, 2], evenly spread over them, [SHOWN, 2]."""
    return flames[np.linspace(0, len(flames) - 1, SHOWN).astype(int)]


def _groups(task: Task, physics: str, spec: SceneSpec, seed: int) -> list[list[int]]:
    """The seats of each fire with which an episode begins. Raises ValueError for an unknown preset."""
    course = begun(task, physics, building.make_world((spec,), torch.device("cpu")), (seed,))
    state = fire_of(course.episode)
    assert state is not None  # only tasks with a fire have seats
    seat = seats.flames(state, course.world.frame)[0].cpu().numpy()
    place = state.flame_place[0].cpu().numpy()[seat >= 0].astype(np.float64)
    near = np.hypot(*np.moveaxis((place[:, None] - place)[..., :2], -1, 0)) <= TOGETHER
    near &= ~np.array([hidden(course.world, place, aim) for aim in place])
    count, label = connected_components(near)
    return [sorted(set(seat[seat >= 0][label == group].tolist())) for group in range(count)]


def _first_flames(state: FireState, row: int) -> NDArray[np.float64]:
    """Places of the flames of an episode, alone in `row`, that appear until SOURCE [m], [N, 2], in their order."""
    births = state.flame_birth[row].cpu().numpy()
    places = state.flame_place[row, :, :2].cpu().numpy().astype(np.float64)
    there = (births >= 0) & (state.flame_cell[row].cpu().numpy() >= 0)
    first = there & (births <= SOURCE)
    return places[first if first.any() else there]
