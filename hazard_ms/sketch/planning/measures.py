"""Measures: what an agent does about a hazard itself, beside the rescues of a problem.

A measure is a door shut, an extinguisher fetched, a fire put out. It takes frames, at a place that is frames of ways
away, and afterwards targets stay whole for longer. `hazard_ms.sketch.planning.beginning` chooses among measures.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel, refuse_unless_frames


@dataclass(frozen=True, eq=False)
class Measure:
    """Something done about the hazard, and what it is good for. Raises ValueError for numbers that are no frames.

    `spared_until` is the last frame at which each of M targets is whole if the measure is done by its frame and nobody
    rescues the target; inf: it never is damaged. Targets that were damaged before the measure is done stay damaged. A
    measure that fetches a tool spares nothing by itself: its `spared_until` has zeros.
    """

    name: str  # for notes
    frames: float  # that it takes once the agent is there
    spared_until: Sequence[float]  # [M]
    needs: int | None = None  # number of the measure that fetches the tool that must be in the hand; None: empty hand
    uses: float = 0.0  # frames of its charge that it takes from that tool
    charge: float = 0.0  # frames that the tool lasts that it fetches, and has in the hand afterwards; 0: no tool
    stays_until: Sequence[float] | None = None  # the same as `spared_until` of being carried off, [M]; None: no change
    closes: tuple[int, ...] = ()  # targets that nobody gets to any more once it is done: those behind a shut door

    def __post_init__(self) -> None:
        object.__setattr__(self, "spared_until", tuple(np.array(self.spared_until, np.float64).tolist()))
        if self.stays_until is not None:
            object.__setattr__(self, "stays_until", tuple(np.array(self.stays_until, np.float64).tolist()))
            refuse_unless_frames(np.array(self.stays_until), "stays_until")
        for name in ("frames", "spared_until", "uses", "charge"):
            refuse_unless_frames(np.array(getattr(self, name), np.float64), name)


class Changed(NamedTuple):
    """The frames of ways of K measures and N - 1 targets and carts once some measures are done; inf: no way."""

    between: NDArray[np.float64]  # from where the last of them ends to each measure, [K]
    onward: NDArray[np.float64]  # from there to each target and cart, [N - 1]
    table: NDArray[np.float64]  # from the target or cart of the row to that of the column, [N - 1, N - 1]


@dataclass(frozen=True, eq=False)
class Measures:
    """K measures and the frames of ways to and from them, beside a problem of N - 1 targets and carts, and the start.

    `to` has ways from the targets, the carts and the start, in this order, to each measure, [N, K]; `between` those
    from the measure of the row to that of the column, [K, K]; `onward` those from each measure to the targets and
    carts, [K, N - 1]; inf: no way. `changed` gives the ways once measures are done, by their numbers in their order,
    where these change them as shut doors do, which makes no way shorter; None where they do not. Raises ValueError for
    other shapes, and for tools that no measure fetches.
    """

    measures: Sequence[Measure]
    to: NDArray[np.float64]  # [N, K]
    between: NDArray[np.float64]  # [K, K]
    onward: NDArray[np.float64]  # [K, N - 1]
    in_hand: int | None = None  # number of the measure that has fetched the tool in the hand, with the charge left
    put_down: float = 0.0  # frames in which a tool is put down
    changed: Callable[[tuple[int, ...]], Changed | None] = lambda done: None

    def __post_init__(self) -> None:
        count = len(self.measures)
        object.__setattr__(self, "measures", tuple(self.measures))
        for name in ("to", "between", "onward"):
            object.__setattr__(self, name, np.array(getattr(self, name), np.float64))
            refuse_unless_frames(getattr(self, name), name)
        nodes = np.shape(self.to)[0]
        for name, shape in {"to": (nodes, count), "between": (count, count), "onward": (count, nodes - 1)}.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name} must have shape {shape}, got {getattr(self, name).shape}")
        fetches = {k for k, measure in enumerate(self.measures) if measure.charge > 0.0}
        for tool in (self.in_hand, *(measure.needs for measure in self.measures)):
            if tool is not None and tool not in fetches:
                raise ValueError(
                    f"a tool must be the number of a measure that fetches one, of {sorted(fetches)}, got {tool}"
                )


def with_unseen(problem: Problem, frames: NDArray[np.float64], unseen: Sequence[tuple[float, float]]) -> Problem:
    """The same problem with targets that nobody gets to: their values and the frames of their loss, `unseen`.

    `frames`: of the ways between the G targets of the problem and the start, which comes last, [G + 1, G + 1].
    """
    goals, more = len(problem.values), len(unseen)
    table = np.full((goals + more + 1,) * 2, np.inf)
    kept = [*range(goals), goals + more]
    table[np.ix_(kept, kept)] = frames
    return replace(
        problem,
        travel=StaticTravel(table),
        values=[*problem.values, *(value for value, _ in unseen)],
        damaged_at=[*problem.damaged_at, *(at for _, at in unseen)],
        gone_at=None if problem.gone_at is None else [*problem.gone_at, *[np.inf] * more],
        pick=[*problem.pick, *[1.0] * more],
        drop=[*problem.drop, *[1.0] * more],
    )
