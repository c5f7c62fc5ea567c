"""The exact search: time-dependent orienteering with soft deadlines, by labels of partial plans.

A label is a partial plan: what is rescued, where one stands, the frame and the value. Of labels that rescued the same
and stand at the same node, those that are later without being worth more are dropped; so are those whose optimistic
rest (bound.py) does not beat the best plan so far, which a narrow beam finds first. Labels are extended in layers, by
the number of rescues. Targets are met as early as possible. Where that may not be best, because they can outrun a walk,
no plan counts as exact.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from hazard_ms.sketch.planning.bound import Completion
from hazard_ms.sketch.planning.problem import Plan, PlannedRescue, Problem
from hazard_ms.sketch.planning.travel import Spot

FIRST_BEAM = 30  # labels of a layer in the search for a first plan [ours]
MOST_LABELS = 200_000  # kept by the exact search; no scene of ours came near [ours]
BEAM = 20_000  # labels of a layer beyond that [ours]
ROUNDING = 1e-9  # values that differ by less are equal


class Label(NamedTuple):
    """A partial plan: its last rescue, and the label that it extends."""

    frame: float
    value: float
    bound: float  # value that no extension exceeds
    rescued: int  # bits of the targets
    spot: Spot
    last: PlannedRescue | None
    parent: Label | None


def solve(problem: Problem, most_labels: int = MOST_LABELS, beam: int = BEAM) -> Plan:
    """The plan of the highest value and, among those, the one that is done first.

    Beyond `most_labels` only the best `beam` labels of each layer are kept; the plan then says how much may be missing.
    Raises ValueError unless both are positive.
    """
    for name, number in (("most_labels", most_labels), ("beam", beam)):
        if number < 1:
            raise ValueError(f"{name} must be at least 1, got {number}")
    search = _Search(problem)
    search.run(0, FIRST_BEAM)
    search.run(most_labels, beam)
    return search.plan()


Found = dict[tuple[int, int], list[Label]]  # by the bits of what is rescued and the node where it ends


class _Search:
    def __init__(self, problem: Problem) -> None:
        self._problem, self._rest = problem, Completion(problem)
        bound = self._rest.best(problem.frame, 0)[0]
        self._best = self._empty = Label(problem.frame, 0.0, bound, 0, problem.travel.start, None, None)

    def run(self, most_labels: int, beam: int) -> None:
        """Extend labels layer by layer; once there are more than `most_labels`, a layer keeps `beam`."""
        self._labels, self._cut = 0, -1.0  # the highest bound of what was left out; -1: nothing was
        layer = list(self._first())
        if not self._problem.travel.early_is_best:
            self._cut = max((label.bound for label in layer), default=0.0)
        while layer:
            self._labels += len(layer)
            if self._labels > most_labels and len(layer) > beam:
                layer.sort(key=lambda label: (-label.bound, -label.value, label.frame, label.rescued, label.spot))
                self._cut = max(self._cut, layer[beam].bound)
                del layer[beam:]
            found: Found = {}
            for label in layer:
                if label.bound > self._best.value - ROUNDING:
                    self._extend(label, found)
            layer = [label for labels in found.values() for label in labels]

    def _first(self) -> Iterator[Label]:
        """The empty plan, or the plans of one rescue that put away what is in the hand."""
        if self._problem.holding is None:
            yield self._empty
            return
        found: Found = {}
        self._put_away(self._empty, self._problem.holding, self._empty.frame, 0.0, self._empty.spot, found)
        for labels in found.values():
            yield from labels

    def _extend(self, label: Label, found: Found) -> None:
        """Add all labels with one more rescue that may lead to the best plan."""
        problem = self._problem
        left = [target for target in range(problem.travel.targets) if not label.rescued >> target & 1]
        meetings = problem.travel.meetings(label.spot, label.frame, left)
        for target, (met, spot) in zip(left, meetings, strict=True):
            if met + problem.pick[target] <= problem.limit:
                self._put_away(label, target, met, problem.pick[target], spot, found)

    def _put_away(self, parent: Label, target: int, met: float, pick: float, spot: Spot, found: Found) -> None:
        """Add the labels that end with `target`, put away wherever that is worth it."""
        rescued = parent.rescued | 1 << target
        for safe, after, cart in self._problem.stows(target, spot, met + pick):
            if safe > self._problem.limit:
                continue
            added = self._problem.worth(target, safe)
            value = parent.value + added
            others = found.setdefault((rescued, after[0]), [])
            if any(other.frame <= safe and other.value >= value - ROUNDING for other in others):
                continue
            more, earliest = self._rest.best(safe, rescued, self._best.value - value - ROUNDING)
            if value + more <= self._best.value + ROUNDING and earliest >= self._best.frame:
                continue
            label = Label(
                safe, value, value + more, rescued, after, PlannedRescue(target, met, safe, added, cart), parent
            )
            others[:] = [other for other in others if other.frame < safe or other.value > value + ROUNDING]
            others.append(label)
            if value > self._best.value + ROUNDING or (value > self._best.value - ROUNDING and safe < self._best.frame):
                self._best = label

    def plan(self) -> Plan:
        """What was found."""
        rescues = []
        label: Label | None = self._best
        while label is not None and label.last is not None:
            rescues.append(label.last)
            label = label.parent
        best = self._best
        gap = max(0.0, self._cut - best.value)
        return Plan(tuple(reversed(rescues)), best.value, best.frame, self._cut < 0, gap, self._labels)
