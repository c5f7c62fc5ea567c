"""One choice of an agent, judged by the best courses before and after it."""

from __future__ import annotations

import math
from collections.abc import Iterable

from hazard_ms.agents.action_values import Notion, Reach, State, mean
from hazard_ms.agents.judge import Judge
from hazard_ms.evaluation.regret.identities import Meant
from hazard_ms.evaluation.regret.measures import MeasureWorth
from hazard_ms.skills.decision import STOP


class Judged:
    """One choice between the state in which the agent saw the world, and that in which it had chosen."""

    def __init__(self, mind: Judge, seen: State, now: State, meant: Meant, total: float) -> None:
        self._mind, self.seen, self._now, self._meant, self._total = mind, seen, now, meant, total
        self._limits = mind.limits(seen)

    @property
    def waited(self) -> int:
        """Frames that the choice took."""
        return self._now.frame - self.seen.frame

    def only(self, targets: Iterable[int]) -> Notion:
        """The truth about some targets, and nothing of the others."""
        return Notion({index: self._mind.truth.values[index] for index in targets})

    def regret(self, notion: Notion) -> float:
        """The share of all value by which the choice reaches less than the best plan when the agent was asked."""
        best = self._mind.best(self.seen, self._limits, notion)
        later = self._mind.best(self._now, self._limits, notion) if self.waited else best
        choice = self._choice(self._now, later, notion)
        return max(0.0, mean(best) - mean(choice)) / self._total

    def reached(self, worth: MeasureWorth, best: float) -> float:
        """The value of the best course that begins with the choice and has measures; `best`: that of rescues alone."""
        action, found = self._meant.action, -math.inf
        if action.verb == STOP:
            return found
        if worth.is_measure(action) and (begun := worth.begun(self._now, action)) is not None:
            found = best + begun
        after = worth.after(self._now, action, self._meant.place)
        if after is not None:
            plain = mean(self._mind.best(after, self._limits))
            found = max(found, plain + worth.gain(after, plain))
        return found

    def instead(self) -> str:
        """The beginning of the best plan in words, at the pace at which the choice loses most."""
        best = self._mind.best(self.seen, self._limits)
        choice = self._choice(self._now, best)
        lost = [b - c for b, c in zip(best, choice, strict=True)]
        return self._mind.begins_with(self.seen, self._limits[lost.index(max(lost))])

    def at_once(self) -> float:
        """The same if the agent had chosen at once."""
        best = self._mind.best(self.seen, self._limits)
        return (mean(best) - mean(self._choice(self.seen, best))) / self._total

    def _choice(self, state: State, best: Reach, notion: Notion | None = None) -> Reach:
        """The value that the best course from `state` reaches that begins with the choice; `best`: any course."""
        return self._mind.choice(state, self._meant.action, self._limits, best, notion, self._meant.place)
