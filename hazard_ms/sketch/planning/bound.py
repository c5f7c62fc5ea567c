"""Optimistic bounds: no plan rescues more than the best fractional filling of the time that is left.

Each target takes at least its cheapest entry: the shortest walk to it from wherever a rescue can end, plus picking
up and putting away. It counts its value, or the damaged share if even that entry comes too late. Time is filled
in the order of value per frame, the last target in part.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hazard_ms.sketch.planning.problem import Problem

SLACK = 1e-6  # for rounding in comparisons of frames [frames]


class Completion:
    """The optimistic rest of a partial plan."""

    def __init__(self, problem: Problem) -> None:
        self._limit = problem.limit
        travel = problem.travel
        exits = (travel.least_exits() + problem.drop).min(axis=1) if travel.carts else np.array(problem.drop)
        entries = (travel.least_entries() + problem.pick + exits).tolist()
        offers = []  # value, frames, bit of the target, and the frames after and by which it is on offer
        for target, (frames, value) in enumerate(zip(entries, problem.values, strict=True)):
            late = problem.limit - frames + SLACK
            whole = min(problem.damaged_at[target] - frames + SLACK, late)
            offers.append((value, frames, 1 << target, -np.inf, whole))
            offers.append((value * problem.share(target), frames, 1 << target, whole, late))
        self._offers = sorted(
            (offer for offer in offers if offer[0] > 0 and offer[4] > offer[3] and offer[1] < np.inf),
            key=lambda offer: (-offer[0] / offer[1] if offer[1] else -np.inf, offer),
        )

    def best(self, frame: float, rescued: int, wanted: float = np.inf) -> tuple[float, float]:
        """A bound on the value that can be added after `frame`, and the earliest frame by which `wanted` of it is.

        `rescued` has the bits of the targets that no longer count. The frame is inf where `wanted` is out of reach.
        """
        total, now, earliest = 0.0, frame, frame if wanted <= 0 else np.inf
        for value, frames, bit, after, by in self._offers:
            if rescued & bit or not after < frame <= by:
                continue
            share = 1.0 if now + frames <= self._limit else (self._limit - now) / frames
            if total < wanted <= total + share * value:
                earliest = now + frames * (wanted - total) / value
            total += share * value
            now += share * frames
            if share < 1.0:
                break
        return total, earliest


def upper_bound(problem: Problem) -> float:
    """A value that no plan exceeds, without any search."""
    rest = Completion(problem)
    if problem.holding is None:
        return rest.best(problem.frame, 0)[0]
    target = problem.holding
    stows = [stow for stow in problem.stows(target, problem.travel.start, problem.frame) if stow.safe <= problem.limit]
    bits = 1 << target
    return max((problem.worth(target, stow.safe) + rest.best(stow.safe, bits)[0] for stow in stows), default=0.0)


def never_damaged(problem: Problem) -> Problem:
    """The same problem without damage: what it allows holds whatever an agent does to the hazard."""
    return replace(problem, damaged_at=[np.inf] * problem.travel.targets)
