"""Futures of a running episode, one for each thing that could be done about the hazard, in one batch.

Copies of the episode are advanced without a simulator, as `hazard_ms.sketch.recording.ahead` does; in each, one thing
is done at its frame. Each copy is exactly the episode in which that is done. Limit: flames draw by their places in the
roster, so that a fire elsewhere may spread a little otherwise once a seat is out.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.hazards.base import pushes
from hazard_ms.hazards.fire.fire_state import FireState
from hazard_ms.simulation.world import World
from hazard_ms.sketch.futures import seats
from hazard_ms.sketch.futures.surroundings import free_boards
from hazard_ms.sketch.recording import Running, rollout_of
from hazard_ms.sketch.timeline import STRIDE
from hazard_ms.spec.checks import one_of
from hazard_ms.tasks.episode.episode import Episode

OUT, SHUT, OPEN, BLOCK = "out", "shut", "open", "block"
KINDS = (OUT, SHUT, OPEN, BLOCK)
LEVEL_ROUNDING = 1e-3  # by which levels may differ that are equal [m, or the hazard's unit] [ours]


class Intervention(NamedTuple):
    """Something done at a frame: a seat of fire put out, a door shut or opened, a flood board set into an opening."""

    kind: str  # one of KINDS
    number: int  # of the seat (its lattice), or of the opening along O
    frame: int  # at which it is done


class Foreseen(NamedTuple):
    """The outcome if nobody acts, and after it that of each of N sets of interventions: N + 1 rows."""

    first: int  # the frame of the present
    damaged_at: NDArray[np.int64]  # first frame in which each thing is damaged; -1: never, [N + 1, B]
    burning: NDArray[np.int64]  # flames and burning things that are put out, [N + 1]
    frames: NDArray[np.int64]  # of the samples of levels, [S]; none where nothing pushes things
    levels: NDArray[np.float32]  # highest of the hazards that push at each thing in each sample, [S, N + 1, B]

    def whole_until(self) -> NDArray[np.float64]:
        """The last frame at which each thing is whole; inf if it is never damaged, [N + 1, B]."""
        return np.where(self.damaged_at < 0, np.inf, self.damaged_at - 1.0)

    def stays_until(self, gone_at: NDArray[np.float64]) -> NDArray[np.float64]:
        """The last frame before each thing is carried off that is so at `gone_at`, [B], if nobody acts: [N + 1, B].

        It is, once the hazard is as high there as it then is: inf where it never is.
        """
        if not len(self.frames):
            return np.broadcast_to(gone_at, self.damaged_at.shape).copy()
        then = np.minimum(np.searchsorted(self.frames, gone_at), len(self.frames) - 1)
        needed = self.levels[then, 0, np.arange(len(gone_at))]  # [B]
        enough = self.levels >= needed - LEVEL_ROUNDING
        first = np.where(enough.any(0), self.frames[enough.argmax(0)], np.inf)
        return np.where(np.isfinite(gone_at), np.maximum(first, np.where(first < gone_at, gone_at, 0.0)), np.inf)


def foresee(env: Running, sets: Sequence[Sequence[Intervention]], frames: int | None = None) -> Foreseen:
    """Foresee the outcome of sets of interventions in the one running episode of `env`, which is left as it is.

    Each of N `sets` of interventions is done in a copy of its own. `frames`: how far to look, by default until the
    task's limit. What should be done in the past, or later than that, is not done. Raises ValueError for an unknown
    kind of intervention.
    """
    due: dict[int, list[tuple[int, Intervention]]] = {}
    for row, interventions in enumerate(sets, 1):
        for intervention in interventions:
            one_of(intervention.kind, KINDS, "kind")
            due.setdefault(intervention.frame, []).append((row, intervention))
    first = int(env.world.frame[0])
    course = rollout_of(env, len(sets) + 1)
    burning = np.zeros(len(sets) + 1, np.int64)
    last = env.task.max_frames if frames is None else first + frames
    pushing = [k for k, hazard in enumerate(env.task.hazards) if pushes([hazard])]
    sampled: list[int] = []
    levels = []
    for frame in range(first, last + 1):
        if frame > first:
            course.advance(frame - first)
        if pushing and (frame - first) % STRIDE == 0:
            sampled.append(frame)
            levels.append(course.episode.levels(course.world.position)[:, pushing].amax(1).cpu().numpy())
        for row, intervention in due.get(frame, ()):
            burning[row] += _intervene(course.episode, row, intervention)
    damaged = course.episode.damage.frame.cpu().numpy().astype(np.int64)
    samples = np.stack(levels) if levels else np.zeros((0, *damaged.shape), np.float32)
    return Foreseen(first, damaged, burning, np.array(sampled, np.int64), samples)


def fire_of(episode: Episode) -> FireState | None:
    """The state of the fire of an episode; None where there is none."""
    return next((state for state in episode.states.values() if isinstance(state, FireState)), None)


def _set_board(world: World, row: int, number: int) -> None:
    """Let a flood board that lies about stand in the opening `number` of the copy `row`, if there is one."""
    free = free_boards(world, row)
    if world.equipment is not None and free:
        world.equipment.state.stands_in[row, free[0]] = number


def _intervene(episode: Episode, row: int, what: Intervention) -> int:
    """Do something in the copy `row`; returns the number of flames and things that this puts out."""
    world = episode.world
    if what.kind == BLOCK:
        _set_board(world, row, what.number)
        return 0
    if what.kind != OUT:
        rows = torch.tensor([row], device=world.device)
        world.openings.set_open(rows, what.number, 1.0 if what.kind == OPEN else 0.0)
        return 0
    fire = fire_of(episode)
    if fire is None:
        return 0
    burning = int((seats.flames(fire, world.frame) == what.number)[row].sum())
    burning += int((seats.alight(fire, world) == what.number)[row].sum())
    seats.put_out(fire, world, row, what.number)
    return burning
