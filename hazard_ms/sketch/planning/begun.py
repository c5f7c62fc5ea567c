"""The problem that is left once a certain measure is done first: what it is worth to begin with that one.

Limits: those of `hazard_ms.sketch.planning.beginning`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hazard_ms.sketch.planning.measures import Measures
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel


def begun(problem: Problem, measures: Measures, number: int) -> tuple[Problem, Measures] | None:
    """The rest of a problem and of its measures after the measure `number`, whose tool is fetched before it.

    None where it comes too late, or its tool would be used up. `problem` has the targets' own values and a
    StaticTravel. A measure that was done spares nothing again. Raises ValueError for another travel.
    """
    if not isinstance(problem.travel, StaticTravel):
        raise ValueError(
            f"travel must be a StaticTravel in a problem with measures, got {type(problem.travel).__name__}"
        )
    if measures.in_hand == number:
        return problem, measures
    needs = measures.measures[number].needs
    if needs is not None and measures.in_hand != needs:
        fetched = begun(problem, measures, needs)
        return None if fetched is None else begun(*fetched, number)
    done = measures.measures[number]
    emptied = measures.put_down if measures.in_hand not in (None, needs) else 0.0
    frame = float(problem.frame + emptied + measures.to[-1, number] + done.frames)
    charge = 0.0 if needs is None else measures.measures[needs].charge
    if not frame <= problem.limit or done.uses > charge:
        return None
    left = list(measures.measures)
    if done.charge == 0.0:
        left[number] = replace(done, spared_until=[0.0] * problem.travel.targets, stays_until=None)
    if needs is not None:
        left[needs] = replace(left[needs], charge=max(charge - done.uses, np.finfo(float).tiny))
    after = replace(
        problem,
        travel=problem.travel.starting(measures.onward[number]),
        frame=frame,
        damaged_at=_spared(problem.damaged_at, done.spared_until, frame),
        gone_at=None if problem.gone_at is None else _spared(problem.gone_at, done.stays_until or (), frame),
        pick=[problem.limit + 1.0 if t in done.closes else pick for t, pick in enumerate(problem.pick)],
        holding=None,
    )
    to = np.vstack([measures.to[:-1], measures.between[number]])
    return after, replace(measures, measures=left, to=to, in_hand=number if done.charge > 0.0 else needs)


def _spared(until: Sequence[float], frames: Sequence[float], done: float) -> list[float]:
    """The frames `until`, [M], after a measure that is done at the frame `done` and gives `frames`, [M] or none."""
    given = frames or until
    return [old if old < done else max(old, new) for old, new in zip(until, given, strict=True)]
