"""The best beginning of a plan that has measures about the hazard before rescues.

`best_course` chooses measures (measures.py), and their order, by forward selection: it appends the measure that gains
most, while one gains anything; it does so from where the agent is, and from where the first rescue of the plan without
measures ends. The rescues after them are planned by `hazard_ms.sketch.planning.orienteering`. The aim is `averted`
(averting.py).

Limits: of several measures, each target has the time that the best of them gives it, although together they may give it
more; a measure takes as long, and spares as much, whenever it is done; tools are fetched once; where rescues may take
longer than planned (`Problem.spread`), measures take what is planned.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.planning.averting import BESIDE, averting, kept
from hazard_ms.sketch.planning.bound import upper_bound
from hazard_ms.sketch.planning.measures import Measures
from hazard_ms.sketch.planning.orienteering import ROUNDING, solve
from hazard_ms.sketch.planning.problem import Plan, PlannedRescue, Problem
from hazard_ms.sketch.planning.travel import StaticTravel

MOST_MEASURES = 4  # before the rescues, fetched tools not counted [ours]
MOST_LABELS, BEAM = 2_000, 60  # of the search for the rescues that follow a beginning [ours]


class Step(NamedTuple):
    """A measure of a course: its number, and the frames at which the agent is there and at which it is done."""

    measure: int
    begins: float
    done: float


class Course(NamedTuple):
    """The best beginning, and the rescues after it."""

    before: PlannedRescue | None  # the rescue that comes before the measures; None: the measures are first
    steps: tuple[Step, ...]  # the measures in their order, fetches included; none: rescues alone are best
    plan: Plan  # of the rescues after them; its values count by the aim `averted`
    value: float  # averted by all of it, and the share of Value beside it, in units of the targets' values
    plain: float  # the same of the best plan without measures


def best_course(
    problem: Problem,
    measures: Measures,
    most: int = MOST_MEASURES,
    most_labels: int = MOST_LABELS,
    beam: int = BEAM,
    beside: float = BESIDE,
    margin: float = 0.0,
) -> Course:
    """The course that averts most: up to `most` measures, then rescues.

    `problem` has the targets' own values; its travel must be a StaticTravel, as that of rooms. What is in the hand is
    put away first. `most_labels` and `beam` are those of `solve`, `beside` that of `averting`; rescues alone must be
    better by `margin` than what begins with measures. Raises ValueError for another travel, and for measures of
    another number of targets, or of nodes.
    """
    search = _Search(problem, measures, most_labels, beam, beside)
    return search.best(most, margin)


class _Beginning(NamedTuple):
    """A rescue perhaps, then measures: where and when it ends, and what is left to rescue."""

    frame: float
    before: PlannedRescue | None
    steps: tuple[Step, ...]
    node: int  # of the problem, at which it begins
    whole: NDArray[np.float64]  # last frame at which each target is whole, [M]
    there: NDArray[np.float64] | None  # last frame at which each is where it was, as `Problem.gone_at`, [M]
    hand: int | None  # number of the measure that fetched the tool in the hand
    charge: float  # frames that it still lasts


class _Search:
    def __init__(self, problem: Problem, measures: Measures, most_labels: int, beam: int, beside: float) -> None:
        travel = problem.travel
        if not isinstance(travel, StaticTravel):
            raise ValueError(f"travel must be a StaticTravel in a problem with measures, got {type(travel).__name__}")
        nodes, shape = travel.targets + travel.carts + 1, np.shape(measures.to)
        if shape[0] != nodes:
            raise ValueError(f"to must have shape ({nodes}, K) for this problem, got {shape}")
        for measure in measures.measures:
            for name in ("spared_until", "stays_until"):
                frames = getattr(measure, name)
                if frames is not None and len(frames) != travel.targets:
                    raise ValueError(f"{name} of {measure.name} must have {travel.targets} frames, got {len(frames)}")
        self._problem, self._travel, self._measures = problem, travel, measures
        self._effort, self._beside = (most_labels, beam), beside

    def best(self, most: int, margin: float) -> Course:
        """The best course that forward selection finds; rescues alone count less by `margin`."""
        ready = replace(self._problem, frame=self._problem.frame + self._delay(self._measures.in_hand))
        plan = solve(averting(ready, self._beside), *self._effort)
        self._plain = plan.value + kept(ready)
        alone = Course(None, (), plan, self._plain, self._plain)
        least = alone._replace(value=self._plain - margin)
        found = [least, *(self._selected(root, least, most) for root in self._roots(plan))]
        best = max(found, key=lambda course: course.value)
        return best if best.steps else alone

    def _selected(self, root: _Beginning, found: Course, most: int) -> Course:
        """The best course found by appending measures to `root`; `found` where none exceeds it."""
        for _ in range(most):
            best = None
            for longer in self._extensions(root):
                made = self._completed(longer, found.value)
                if made is not None:
                    best, found = longer, made
            if best is None:
                break
            root = best
        return found

    def _roots(self, plan: Plan) -> Iterator[_Beginning]:
        """The beginnings without measures: where the agent is, and where the first rescue of `plan` ends."""
        problem, measures, hand = self._problem, self._measures, self._measures.in_hand
        whole, there = np.array(problem.damaged_at), None if problem.gone_at is None else np.array(problem.gone_at)
        charge = 0.0 if hand is None else measures.measures[hand].charge
        if problem.holding is None:
            yield _Beginning(problem.frame, None, (), self._travel.start[0], whole, there, hand, charge)
        if plan.rescues and hand is None:
            first = plan.rescues[0]
            node = self._travel.targets + first.cart if first.cart >= 0 else first.target
            yield _Beginning(first.safe, first, (), node, whole, there, None, 0.0)

    def _extensions(self, now: _Beginning) -> Iterator[_Beginning]:
        for number, measure in enumerate(self._measures.measures):
            if measure.charge == 0.0:  # fetching a tool is no end in itself
                longer = self._with_tool(now, number)
                if longer is not None:
                    yield longer

    def _with_tool(self, now: _Beginning, number: int) -> _Beginning | None:
        """The beginning with the measure `number` after it, and before that with its tool; None if it cannot be."""
        measure, hand = self._measures.measures[number], now.hand
        if measure.needs is not None and hand != measure.needs:
            fetched = self._appended(self._emptied(now), measure.needs)
            return None if fetched is None else self._appended(fetched, number)
        return self._appended(now if measure.needs is not None else self._emptied(now), number)

    def _emptied(self, now: _Beginning) -> _Beginning:
        """The beginning after which no tool is in the hand."""
        return now._replace(frame=now.frame + self._delay(now.hand), hand=None)

    def _delay(self, hand: int | None) -> float:
        """Frames until the hand is empty."""
        return 0.0 if hand is None else self._measures.put_down

    def _appended(self, now: _Beginning, number: int) -> _Beginning | None:
        """The beginning with the measure `number` after it; None where it comes too late, or the tool is used up."""
        measure = self._measures.measures[number]
        gone = self._measures.in_hand == number or any(step.measure == number for step in now.steps)
        if gone or (measure.needs is not None and measure.uses > now.charge):
            return None
        begins = now.frame + float(self._ways(now)[number])
        done = begins + measure.frames
        if not done <= self._problem.limit:
            return None
        there = now.there
        if there is not None and measure.stays_until is not None:
            there = _spared(there, measure.stays_until, done)
        fetches = measure.charge > 0.0
        return now._replace(
            frame=done,
            steps=(*now.steps, Step(number, begins, done)),
            whole=_spared(now.whole, measure.spared_until, done),
            there=there,
            hand=number if fetches else now.hand,
            charge=measure.charge if fetches else now.charge - measure.uses,
        )

    def _ways(self, now: _Beginning) -> NDArray[np.float64]:
        """Frames of the ways to each measure after a beginning, [K]."""
        if not now.steps:
            return self._measures.to[now.node]
        changed = self._measures.changed(tuple(step.measure for step in now.steps))
        return self._measures.between[now.steps[-1].measure] if changed is None else changed.between

    def _completed(self, beginning: _Beginning, least: float) -> Course | None:
        """The course with the best rescues after a beginning; None unless its value exceeds `least`."""
        left, sure = self._rest(beginning), 0.0
        if beginning.before is not None:
            done = beginning.before.target
            sure = beginning.before.value + (kept(self._problem) - kept(_without(self._problem, done)))
        sure += kept(left)
        aimed = self._faded(averting(left, self._beside))
        if sure + upper_bound(aimed) <= least + ROUNDING:
            return None
        # not earlier: it takes longer to tell the ways past shut doors than to see that a course is not worth it
        changed = self._measures.changed(tuple(step.measure for step in beginning.steps))
        if changed is not None:
            aimed = replace(aimed, travel=self._travel.starting(changed.onward, changed.table))
            if sure + upper_bound(aimed) <= least + ROUNDING:
                return None
        plan = solve(aimed, *self._effort)
        value = sure + plan.value
        return Course(beginning.before, beginning.steps, plan, value, self._plain) if value > least + ROUNDING else None

    def _rest(self, beginning: _Beginning) -> Problem:
        """The problem that is left after a beginning, with the targets' own values."""
        ready = self._emptied(beginning)
        travel = self._travel.starting(self._measures.onward[beginning.steps[-1].measure])
        pick = list(self._problem.pick)
        for step in beginning.steps:
            for target in self._measures.measures[step.measure].closes:
                pick[target] = self._problem.limit + 1.0  # never
        left = replace(
            self._problem,
            travel=travel,
            frame=ready.frame,
            damaged_at=beginning.whole.tolist(),
            gone_at=None if beginning.there is None else beginning.there.tolist(),
            pick=pick,
            holding=None,
        )
        return left if beginning.before is None else _without(left, beginning.before.target)

    def _faded(self, left: Problem) -> Problem:
        """The same with values, [M], that count less by the frames that have passed, as for `Problem.fading`."""
        passed = 1.0 - self._problem.fading * (left.frame - self._problem.frame)
        if self._problem.fading == 0.0 or passed <= 0.0:
            return left
        span = max(left.limit - left.frame, 1.0)
        return replace(
            left,
            values=[value * passed for value in left.values],
            fading=min(self._problem.fading / passed, 1.0 / span),
        )


def _spared(until: NDArray[np.float64], frames: Sequence[float], done: float) -> NDArray[np.float64]:
    """The frames `until`, [M], after a measure that is done at the frame `done` and gives these `frames`, [M]."""
    return np.where(until < done, until, np.maximum(until, frames))


def _without(problem: Problem, target: int) -> Problem:
    """The same problem in which a target counts nothing."""
    values = [0.0 if other == target else value for other, value in enumerate(problem.values)]
    return replace(problem, values=values)
