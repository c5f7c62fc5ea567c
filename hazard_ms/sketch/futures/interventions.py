"""Futures of a running episode, one for each thing that could be done about the hazard, in one batch.

Copies of the episode are advanced without a simulator, as `hazard_ms.sketch.recording.ahead` does; in each, one thing
is done at its frame. Chance is counted, so that all else happens as it would have.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.episode.episode import Episode
from hazard_ms.hazards.fire.fire_state import FireState
from hazard_ms.sketch.futures import seats
from hazard_ms.sketch.recording import Running, course_of

OUT, SHUT, OPEN = "out", "shut", "open"


class Intervention(NamedTuple):
    """Something done at a frame: a seat of fire put out, a door shut or opened."""

    kind: str  # OUT, SHUT or OPEN
    number: int  # of the seat (its lattice), or of the opening along O
    frame: int  # at which it is done


class Foreseen(NamedTuple):
    """What follows if nobody acts, and after it what follows from each of N sets of interventions: N + 1 rows."""

    first: int  # the frame of the present
    damaged_at: NDArray[np.int64]  # first frame in which each thing is damaged; -1: never, [N + 1, B]
    burning: NDArray[np.int64]  # flames and burning things that are put out, [N + 1]

    def whole_until(self) -> NDArray[np.float64]:
        """The last frame at which each thing is whole; inf if it is never damaged, [N + 1, B]."""
        return np.where(self.damaged_at < 0, np.inf, self.damaged_at - 1.0)


def foresee(env: Running, sets: Sequence[Sequence[Intervention]], frames: int | None = None) -> Foreseen:
    """What follows from the present of the one running episode of `env`, which is left as it is.

    Each of N `sets` of interventions is done in a copy of its own. `frames`: how far to look, by default until the
    task's limit. What should be done in the past, or later than that, is not done. Raises ValueError for an unknown
    kind of intervention.
    """
    due: dict[int, list[tuple[int, Intervention]]] = {}
    for row, interventions in enumerate(sets, 1):
        for intervention in interventions:
            if intervention.kind not in (OUT, SHUT, OPEN):
                raise ValueError(f"kind must be {OUT}, {SHUT} or {OPEN}, got {intervention.kind!r}")
            due.setdefault(intervention.frame, []).append((row, intervention))
    first = int(env.world.frame[0])
    course = course_of(env, len(sets) + 1)
    burning = np.zeros(len(sets) + 1, np.int64)
    last = env.task.max_frames if frames is None else first + frames
    for frame in range(first, last + 1):
        if frame > first:
            course.advance(frame - first)
        for row, intervention in due.get(frame, ()):
            burning[row] += _intervene(course.episode, row, intervention)
    damaged = course.episode.damage.frame.cpu().numpy().astype(np.int64)
    return Foreseen(first, damaged, burning)


def fire_of(episode: Episode) -> FireState | None:
    """The state of the fire of an episode; None where there is none."""
    return next((state for state in episode.states.values() if isinstance(state, FireState)), None)


def _intervene(episode: Episode, row: int, what: Intervention) -> int:
    """Do something in the copy `row`; returns the number of flames and things that this puts out."""
    world = episode.world
    if what.kind != OUT:
        rows = torch.tensor([row], device=world.device)
        world.openings.set_open(rows, what.number, 1.0 if what.kind == OPEN else 0.0)
        return 0
    fire = fire_of(episode)
    if fire is None:
        return 0
    both = (seats.flames(fire, world.frame), seats.things(fire, world))
    burning = sum(int((part[row] == what.number).sum()) for part in both)
    seats.put_out(fire, world, row, what.number)
    return burning
