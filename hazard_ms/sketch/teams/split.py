"""Plans of teams whose future is known: who fetches what, and in which order, for the most value in sum.

For each robot the best order of every set of targets is found, by labels as in
`hazard_ms.sketch.planning.orienteering` but without its cuts; then the sets are given out, which is exact: no other
division is worth more. In these plans robots do not wait for one another, and none takes what another one put down.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.planning.problem import PlannedRescue, Problem
from hazard_ms.sketch.planning.travel import Spot

MOST_TARGETS = 16  # all sets of these are looked at [ours: streets have 15]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Split:
    """The best division of the targets. It is `exact` unless targets can outrun a walk."""

    orders: tuple[tuple[PlannedRescue, ...], ...]  # of each robot
    value: float  # of all together
    exact: bool


class _Label(NamedTuple):
    """A partial plan of one robot."""

    frame: float
    value: float
    spot: Spot
    last: PlannedRescue | None
    parent: _Label | None


def split(problems: Sequence[Problem]) -> Split:
    """The division of the targets that is worth most; `problems`: the same targets, as each robot has them before it.

    Raises ValueError for no robots, for other numbers of targets than 0 to MOST_TARGETS, the same for all, and for
    robots with something in the hand.
    """
    counts = {problem.travel.targets for problem in problems}
    if len(counts) != 1 or max(counts) > MOST_TARGETS:
        told = ", ".join(map(str, sorted(counts))) or "no robots"
        raise ValueError(f"all robots must have the same number of targets, at most {MOST_TARGETS}, got {told}")
    if any(problem.holding is not None for problem in problems):
        raise ValueError("problems must begin with empty hands, got one that holds a target")
    found: dict[int, dict[int, _Label]] = {}  # by the identity of problems: robots that start alike share theirs
    for problem in problems:
        if id(problem) not in found:
            found[id(problem)] = _best(problem)
    size = 1 << max(counts)
    worth = [_worth(found[id(problem)], size) for problem in problems]
    together = [worth[0]]  # what the first of them make, and so on
    for own in worth[1:-1]:
        together.append(_joined(together[-1], own))
    left, shares = size - 1, list[int]()
    for number in range(len(problems) - 1, 0, -1):
        parts = _subsets(left)
        shares.append(int(parts[np.argmax(worth[number][parts] + together[number - 1][left ^ parts])]))
        left ^= shares[-1]
    shares = [left, *reversed(shares)]
    orders = [_order(found[id(problem)], share) for problem, share in zip(problems, shares, strict=True)]
    value = sum(float(made[share]) for made, share in zip(worth, shares, strict=True))
    return Split(tuple(orders), value, all(problem.travel.early_is_best for problem in problems))


def _best(problem: Problem) -> dict[int, _Label]:
    """The plan of the highest value for each set of targets, as bits, that can be rescued in time."""
    first = _Label(problem.frame, 0.0, problem.travel.start, None, None)
    best, layer = {0: first}, {(0, first.spot[0]): [first]}
    while layer:
        found: dict[tuple[int, int], list[_Label]] = {}
        for (rescued, _), labels in layer.items():
            for label in labels:
                _extend(problem, label, rescued, found)
        layer = found
        for (rescued, _), labels in layer.items():
            best[rescued] = max([*labels, best.get(rescued, labels[0])], key=lambda one: (one.value, -one.frame))
    return best


def _extend(problem: Problem, label: _Label, rescued: int, found: dict[tuple[int, int], list[_Label]]) -> None:
    """Add the plans with one more rescue to those that were `found`, unless one of these is as soon and worth as much.

    `rescued`: bits of what the plan rescues.
    """
    left = [target for target in range(problem.travel.targets) if not rescued >> target & 1]
    meetings = problem.travel.meetings(label.spot, label.frame, left)
    for target, (met, spot) in zip(left, meetings, strict=True):
        if met + problem.pick[target] > problem.limit:
            continue
        for safe, after, cart in problem.stows(target, spot, met + problem.pick[target]):
            if safe > problem.limit:
                continue
            added = problem.worth(target, safe)
            value, others = label.value + added, found.setdefault((rescued | 1 << target, after[0]), [])
            if any(other.frame <= safe and other.value >= value for other in others):
                continue
            others[:] = [other for other in others if other.frame < safe or other.value > value]
            others.append(_Label(safe, value, after, PlannedRescue(target, met, safe, added, cart), label))


def _worth(best: dict[int, _Label], size: int) -> Floats:
    """The most value that one robot can rescue of each set of targets, [`size`], or of a part of the set."""
    made = np.zeros(size)
    for rescued, label in best.items():
        made[rescued] = label.value
    bit = 1
    while bit < size:
        halves = made.reshape(-1, 2, bit)
        halves[:, 1] = np.maximum(halves[:, 1], halves[:, 0])
        bit *= 2
    return made


def _subsets(whole: int) -> NDArray[np.int64]:
    """All sets of bits that are part of the set `whole`."""
    made = np.zeros(1, np.int64)
    for bit in range(whole.bit_length()):
        if whole >> bit & 1:
            made = np.concatenate([made, made | 1 << bit])
    return made


def _joined(one: Floats, other: Floats) -> Floats:
    """The most value of each set of targets if two divide it, of which `one` and `other` [S] tell what each makes."""
    made = one.copy()
    for own in range(1, len(other)):
        rest = _subsets((len(other) - 1) ^ own)
        made[rest | own] = np.maximum(made[rest | own], one[rest] + other[own])
    return made


def _order(best: dict[int, _Label], own: int) -> tuple[PlannedRescue, ...]:
    """The rescues of the best plan for the targets `own`, bits, or a part of them."""
    parts = [label for rescued, label in best.items() if rescued & ~own == 0]
    label: _Label | None = max(parts, key=lambda one: (one.value, -one.frame))
    made = []
    while label is not None and label.last is not None:
        made.append(label.last)
        label = label.parent
    return tuple(reversed(made))
